// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Scan.h>
#include <dyslam/formats/FieldConventions.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace dyslam
{
/** Type of a number in the bytes of a cloud file or message. */
struct CloudNumber
{
  enum class Kind
  {
    unsigned_integer,
    signed_integer,
    floating
  };
  Kind kind = Kind::floating;
  std::size_t size = 4;  //!< [bytes]

  [[nodiscard]] bool isInteger() const { return kind != Kind::floating; }
  [[nodiscard]] bool valid() const
  {
    return size == 4 || size == 8 || (isInteger() && (size == 1 || size == 2));
  }
};

/** Whether the rows of an ordered cloud are taken as rings; more rows are a depth image's. */
[[nodiscard]] inline bool rowsAreRings(std::uint64_t rows, std::uint64_t columns)
{
  constexpr std::uint64_t most_rows = 256;
  return rows > 1 && rows <= most_rows && columns > rows;
}

/** Columns of a cloud that a Scan has, recognised by their usual names, of any type. */
class CloudColumns
{
 public:
  /** \param path of the file, for messages. */
  explicit CloudColumns(std::string path) : path_(std::move(path)) {}

  /** The file's next field; those are numbered from 0. */
  void declare(const std::string& name, CloudNumber type);
  [[nodiscard]] bool wants(std::size_t field) const { return roles_[field] != none; }
  /** States that the cloud is ordered: without a field of rings its rows are. */
  void setOrder(std::uint64_t rows, std::uint64_t columns)
  {
    row_length_ = rowsAreRings(rows, columns) ? static_cast<std::size_t>(columns) : 0;
  }
  void reserve(std::uint64_t points);
  /** The next point's value of a field. \param bytes little-endian */
  void addBytes(std::size_t field, const char* bytes);
  /** \throws UserError if it is not a number. */
  void addText(std::size_t field, std::string_view word);

  /** The points in metres. \param conventions of the recording that the file belongs to
   * \throws UserError without x, y and z, and for points too far away for single precision. */
  [[nodiscard]] Scan scan(FieldConventions& conventions) const;
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  enum Role : std::size_t
  {
    x,
    y,
    z,
    intensity,
    calibrated,  //!< intensity
    ring,
    time,
    none
  };
  struct Column
  {
    bool there = false;
    std::size_t rank = 0;  //!< rank of its name: the lowest is used
    std::size_t field = 0;
    std::string name;
    CloudNumber type;
    bool exact = false;  //!< type with more digits than single precision
    std::vector<double> values;
  };
  /** Takes the field declared last for a role, if it has one of the names, and a better one than
   * the field that has the role. */
  template <typename Names>
  void offer(Role role, const Names& names, const std::string& name, CloudNumber type);
  void requireNearOrigin(double length_unit) const;
  void fillIntensity(FieldConventions& conventions, Scan& scan) const;
  void fillTimes(FieldConventions& conventions, Scan& scan) const;
  void fillRings(FieldConventions& conventions, Scan& scan) const;

  std::string path_;
  std::size_t row_length_ = 0;  //!< of rows that are rings; 0: they are not [points]
  std::vector<Role> roles_;
  std::array<Column, none> columns_;
};

/** \param bytes little-endian \param type a valid one */
[[nodiscard]] double cloudNumber(const char* bytes, CloudNumber type);
/** \param path of the file, for messages. \throws UserError if it is not a number. */
[[nodiscard]] double cloudNumber(std::string_view word, const std::string& path);
/** Distance from the origin beyond which single precision is too coarse for coordinates, with steps
 * of 8 mm [m] */
constexpr double farthest_coordinate = 1e5;
/** \throws UserError about a coordinate beyond that [m]. \param place for messages \param advice
 * other than to subtract an origin, as the end of the message */
[[noreturn]] void failTooFar(double coordinate,
                             const std::string& place,
                             const std::string& advice = "");
/** Ring number from the number of a field: an integer in 0 to 65535; 0 if it is not finite. */
[[nodiscard]] std::uint16_t ringNumber(double value);
/** Words of a line, separated by blanks. */
[[nodiscard]] std::vector<std::string_view> cloudWords(std::string_view line);
}  // namespace dyslam
