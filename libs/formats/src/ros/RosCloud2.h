// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/formats/RosMessages.h>

#include <algorithm>
#include <array>
#include <optional>

#include "RosReader.h"
#include "clouds/CloudColumns.h"
#include "clouds/FieldNames.h"

namespace dyslam
{
/** A sensor_msgs/PointField. */
struct PointField
{
  std::string name;
  std::uint32_t offset = 0;         //!< offset in a point [bytes]
  std::optional<CloudNumber> type;  //!< nothing: not one of sensor_msgs/PointField
};

/** The type that `PointField::datatype` stands for: 1 int8, 2 uint8, 3 int16, ... 7 float32,
 * 8 float64. */
[[nodiscard]] inline std::optional<CloudNumber> rosPointType(std::uint8_t datatype)
{
  using Kind = CloudNumber::Kind;
  constexpr std::array<CloudNumber, 8> types{{{Kind::signed_integer, 1},
                                              {Kind::unsigned_integer, 1},
                                              {Kind::signed_integer, 2},
                                              {Kind::unsigned_integer, 2},
                                              {Kind::signed_integer, 4},
                                              {Kind::unsigned_integer, 4},
                                              {Kind::floating, 4},
                                              {Kind::floating, 8}}};
  return datatype >= 1 && datatype <= types.size() ? std::optional(types[datatype - 1U])
                                                   : std::nullopt;
}

/** A sensor_msgs/PointCloud2; its points are views into the message. */
struct RosScanDecoder::Cloud2
{
  RosHeader header;
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  std::vector<PointField> fields;
  std::uint32_t point_step = 0;
  std::uint32_t row_step = 0;
  std::string_view data;
  bool is_big_endian = false;
  std::string place;

  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(width) * height; }

  /** Whether there is nothing between and behind the rows. */
  [[nodiscard]] bool hasNoGaps() const
  {
    return point_step > 0 && data.size() % point_step == 0 && data.size() / point_step == size();
  }

  /** Field with the first of the names that a field has, as it is or as plainFieldName(); null if
   * none has. */
  template <typename Names>
  [[nodiscard]] const PointField* findAny(const Names& names) const
  {
    for (const auto& name : names)
    {
      const PointField* alike = nullptr;
      for (const PointField& field : fields)
      {
        if (field.type && field.name == name)
        {
          return &field;
        }
        if (field.type && alike == nullptr && plainFieldName(field.name) == name)
        {
          alike = &field;
        }
      }
      if (alike != nullptr)
      {
        return alike;
      }
    }
    return nullptr;
  }
  [[nodiscard]] const PointField* find(const std::string& name) const
  {
    return findAny(std::array<std::string, 1>{name});
  }

  /** \pre the field has a type */
  [[nodiscard]] double value(const PointField& field, std::size_t point) const
  {
    const char* at =
        data.data() + point / width * row_step + point % width * point_step + field.offset;
    if (!is_big_endian)
    {
      return cloudNumber(at, *field.type);
    }
    std::array<char, 8> swapped{};
    std::reverse_copy(at, at + field.type->size, swapped.begin());
    return cloudNumber(swapped.data(), *field.type);
  }

  /** Values of a field, one per point. */
  [[nodiscard]] std::vector<double> values(const PointField& field) const
  {
    std::vector<double> all(size());
    for (std::size_t i = 0; i < all.size(); ++i)
    {
      all[i] = value(field, i);
    }
    return all;
  }

  /** \throws UserError if the median of a coordinate in double precision is too far away for
   * single precision. */
  void requireNearOrigin(const PointField& field) const;

  static Cloud2 read(ByteReader reader, RosEncoding encoding);
  void check(const ByteReader& reader) const;
  /** Takes points that are stated to be big-endian as little-endian, if more of their coordinates
   * are then plausible: RViz and PCL don't look at the statement, so that it may be wrong. */
  void checkByteOrder();
};

}  // namespace dyslam
