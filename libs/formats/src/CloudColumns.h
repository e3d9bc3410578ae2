// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Scan.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace dyslam
{
/** Type of a number in a cloud file. */
struct CloudNumber
{
  enum class Kind
  {
    natural,
    whole,
    real
  };
  Kind kind = Kind::real;
  std::size_t size = 4;  //!< [bytes]

  [[nodiscard]] bool valid() const
  {
    return size == 4 || size == 8 || (kind != Kind::real && (size == 1 || size == 2));
  }
};

/** The fields of a cloud that a scan has, by their usual names, whatever their types. */
class CloudColumns
{
 public:
  /** \param path of the file, for messages. */
  explicit CloudColumns(std::string path) : path_(std::move(path)) {}

  /** The file's next field; those are numbered from 0. */
  void declare(const std::string& name, CloudNumber type);
  [[nodiscard]] bool wants(std::size_t field) const { return roles_[field] != none; }
  void reserve(std::uint64_t points);
  /** The next point's value of a field. \param bytes little-endian */
  void addBytes(std::size_t field, const char* bytes);
  /** \throws UserError if it is not a number. */
  void addText(std::size_t field, std::string_view word);

  /** Times since 1970 (above an hour) are counted from the earliest, which becomes the stamp; in
   * single precision they are left out.
   * \throws UserError without x, y and z, and for points too far away for single precision. */
  [[nodiscard]] Scan scan() const;
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  enum Role : std::size_t
  {
    x,
    y,
    z,
    intensity,
    ring,
    time,
    none
  };
  struct Column
  {
    bool there = false;
    std::size_t rank = 0;  //!< of its name: the lower is taken
    std::size_t field = 0;
    CloudNumber type;
    bool exact = false;  //!< more digits than single precision has
    std::vector<double> values;
  };
  void requireNearOrigin() const;
  void fillTimes(Scan& scan) const;

  std::string path_;
  std::vector<Role> roles_;
  std::array<Column, none> columns_;
};

/** \param bytes little-endian */
[[nodiscard]] double cloudNumber(const char* bytes, CloudNumber type);
/** \param path of the file, for messages. \throws UserError if it is not a number. */
[[nodiscard]] double cloudNumber(std::string_view word, const std::string& path);
/** The words of a line, parted by blanks. */
[[nodiscard]] std::vector<std::string_view> cloudWords(std::string_view line);
}  // namespace dyslam
