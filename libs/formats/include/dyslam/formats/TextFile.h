// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Files.h>
#include <dyslam/base/ParseNumber.h>

#include <cstddef>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace dyslam
{
/** Lines of a text file as fields separated by spaces, tabs or commas; every error says
 * file:line. A byte order mark, as Windows' editors write it, is skipped. */
class TextFile
{
 public:
  /** \throws UserError if it cannot be read. */
  explicit TextFile(const std::string& path, std::string separators = " \t\r,");
  /** Reads a CSV table, whose fields may be empty; quoted fields may have commas.
   * \throws UserError if it cannot be read. */
  [[nodiscard]] static TextFile table(const std::string& path);

  /** Reads the next line that is neither empty nor a comment (`#`); false at the end. */
  [[nodiscard]] bool next();
  /** Reads the next line that is no comment; an empty line has no fields. */
  [[nodiscard]] bool nextOrEmpty();
  [[nodiscard]] const std::vector<std::string_view>& fields() const { return fields_; }
  [[nodiscard]] const std::string& line() const { return line_; }

  /** Field as a finite number. \throws UserError. */
  [[nodiscard]] double number(std::size_t field) const;
  /** Field as a whole number. \throws UserError. */
  [[nodiscard]] int integer(std::size_t field) const;
  /** Integer part of a field that is a number. \throws UserError. */
  [[nodiscard]] int integerPart(std::size_t field) const;
  /** All fields from `first` on as numbers. */
  [[nodiscard]] std::vector<double> numbers(std::size_t first = 0) const;
  /** Checks the number of fields. \throws UserError "file:line: has n fields, not k (what)". */
  void requireFields(std::size_t count, const char* what) const;
  /** "file:line" of the current line. */
  [[nodiscard]] std::string position() const;
  /** Reports an error in the current line. \throws UserError "file:line: what". */
  [[noreturn]] void fail(const std::string& what) const;

 private:
  void splitAtSeparators();
  void splitAtCommas();

  std::string path_;
  std::string separators_;  //!< separators of fields; empty: a CSV table
  std::ifstream file_;
  std::string line_;
  std::vector<std::string_view> fields_;
  std::size_t line_number_ = 0;
};

/** Removes UTF-8's byte order mark from the begin of a file's text, or of its first line. */
void removeByteOrderMark(std::string& text);

/** Appends a number with `digits` significant digits in the C locale. */
void appendNumber(std::string& text, double value, int digits);
/** Appends a number with `decimals` behind the point. */
void appendFixed(std::string& text, double value, int decimals);

/** File name of six digits and an extension: "000042.label". */
[[nodiscard]] std::string numberedName(std::size_t number, const std::string& extension);
/** Path of a numbered file in a folder. */
[[nodiscard]] std::string numberedPath(const std::string& folder,
                                       std::size_t number,
                                       const std::string& extension);
/** Number in the name of a numbered file, of any number of digits; nothing for other names. */
[[nodiscard]] std::optional<int> numberOfName(const std::string& name,
                                              const std::string& extension);
}  // namespace dyslam
