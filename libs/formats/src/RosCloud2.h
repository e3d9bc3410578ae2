// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/formats/RosMessages.h>

#include "RosReader.h"

namespace dyslam
{
struct PointField
{
  std::string name;
  std::uint32_t offset = 0;
  std::uint8_t type = 0;  //!< 1 int8, 2 uint8, 3 int16, ... 7 float32, 8 float64

  [[nodiscard]] std::size_t size() const
  {
    constexpr std::array<std::size_t, 9> sizes{0, 1, 1, 2, 2, 4, 4, 4, 8};
    return type < sizes.size() ? sizes[type] : 0;
  }
  [[nodiscard]] bool isWhole() const { return type < 7; }
};

template <typename T>
[[nodiscard]] double numberAt(const char* at)
{
  T value;
  std::memcpy(&value, at, sizeof value);
  return static_cast<double>(value);
}

/** A sensor_msgs/PointCloud2, its points as views into the message. */
struct RosScanDecoder::Cloud2
{
  RosHeader header;
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  std::vector<PointField> fields;
  std::uint32_t point_step = 0;
  std::uint32_t row_step = 0;
  std::string_view data;
  std::string place;

  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(width) * height; }

  /** The field with the first of the names that one has; null if none has. */
  template <typename Names>
  [[nodiscard]] const PointField* findAny(const Names& names) const
  {
    for (const auto& name : names)
    {
      for (const PointField& field : fields)
      {
        if (field.name == name && field.size() > 0)
        {
          return &field;
        }
      }
    }
    return nullptr;
  }
  [[nodiscard]] const PointField* find(const std::string& name) const
  {
    return findAny(std::array<std::string, 1>{name});
  }

  [[nodiscard]] double value(const PointField& field, std::size_t point) const
  {
    const char* at =
        data.data() + point / width * row_step + point % width * point_step + field.offset;
    switch (field.type)
    {
      case 1:
        return numberAt<std::int8_t>(at);
      case 2:
        return numberAt<std::uint8_t>(at);
      case 3:
        return numberAt<std::int16_t>(at);
      case 4:
        return numberAt<std::uint16_t>(at);
      case 5:
        return numberAt<std::int32_t>(at);
      case 6:
        return numberAt<std::uint32_t>(at);
      case 7:
        return numberAt<float>(at);
      default:
        return numberAt<double>(at);
    }
  }

  /** Of every point. */
  [[nodiscard]] std::vector<double> values(const PointField& field) const
  {
    std::vector<double> all(size());
    for (std::size_t i = 0; i < all.size(); ++i)
    {
      all[i] = value(field, i);
    }
    return all;
  }

  static Cloud2 read(ByteReader reader, RosEncoding encoding);
  void check(const ByteReader& reader) const;
};

}  // namespace dyslam
