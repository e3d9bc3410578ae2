// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Pose.h>

#include <cstddef>
#include <initializer_list>
#include <map>
#include <string>
#include <vector>

namespace dyslam
{
/** The pose whose upper 3 rows of `columns` numbers each are given row by row: 4 for a
 * transformation, 3 for a rotation alone. \param what "file: the matrix of Tr", for the message
 * \throws UserError if the matrix is no rotation. */
[[nodiscard]] Pose poseFromRows(const std::vector<double>& values,
                                std::size_t columns,
                                const std::string& what);

/** The lines `key: numbers` or `key numbers` of one of KITTI's calibration files. */
class CalibEntries
{
 public:
  /** \throws UserError if the file cannot be read, or has text instead of numbers. */
  explicit CalibEntries(const std::string& path);

  [[nodiscard]] bool has(const std::string& key) const { return entries_.count(key) > 0; }
  /** The numbers of the first of these keys that the file has; null without.
   * \throws UserError unless there are `size` numbers. */
  [[nodiscard]] const std::vector<double>* find(std::initializer_list<const char*> keys,
                                                std::size_t size) const;
  /** As find(). \throws UserError also if the file has none of the keys. */
  [[nodiscard]] const std::vector<double>& numbers(std::initializer_list<const char*> keys,
                                                   std::size_t size) const;
  /** poseFromRows() of an entry. \throws UserError, as numbers() does, too. */
  [[nodiscard]] Pose pose(std::initializer_list<const char*> keys, std::size_t columns) const;

 private:
  std::string path_;
  std::map<std::string, std::vector<double>> entries_;
};
}  // namespace dyslam
