// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/formats/TextFile.h>

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace dyslam
{
/** A CSV table with the names of its columns in the first line. */
class CsvTable
{
 public:
  /** \throws UserError if it cannot be read. */
  explicit CsvTable(const std::string& path);

  /** Index of a column, to be called before next(); nothing if there is none. */
  [[nodiscard]] std::optional<std::size_t> find(std::string_view name) const;
  /** The same. \throws UserError if there is none. */
  [[nodiscard]] std::size_t column(const std::string& name) const;
  /** Reads the next row. \throws UserError "file:line: what" for another number of fields than in
   * the first line. */
  [[nodiscard]] bool next();

  [[nodiscard]] std::string_view text(std::size_t column) const { return file_.fields()[column]; }
  /** \throws UserError "file:line: what", also in the following. */
  [[nodiscard]] double number(std::size_t column) const { return file_.number(column); }
  [[nodiscard]] int integer(std::size_t column) const { return file_.integer(column); }
  /** A field as a number of a scan or of points. */
  [[nodiscard]] std::size_t count(std::size_t column) const;

 private:
  std::string path_;
  TextFile file_;
  std::size_t columns_;
};
}  // namespace dyslam
