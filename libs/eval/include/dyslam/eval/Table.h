// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace dyslam
{
/** One entry of a table: text, or a number with its printed number of decimals. */
struct TableCell
{
  TableCell() = default;
  TableCell(std::string word) : text(std::move(word)) {}
  TableCell(const char* word) : text(word) {}
  /** A missing or non-finite value is printed as "-". */
  TableCell(std::optional<double> number, int digits);
  /** A value followed by the one of the paper: "0.45 (paper 0.51)". */
  TableCell(std::optional<double> number, int digits, std::optional<double> paper);

  std::string text;             //!< printed text
  std::optional<double> value;  //!< value with full precision, for CSV
};

/** Rows under named columns, printed with aligned columns or as CSV. */
class Table
{
 public:
  explicit Table(std::vector<std::string> columns, std::string title = "");

  /** Adds a row. \throws std::invalid_argument unless there is one cell per column. */
  void addRow(std::vector<TableCell> cells);

  [[nodiscard]] std::size_t rows() const { return rows_.size(); }
  [[nodiscard]] std::size_t columns() const { return columns_.size(); }

  /** The table as text: first column left-aligned, the others right-aligned, with a final line
   * feed. Columns without any entry are omitted. */
  [[nodiscard]] std::string toText() const;
  /** The table as Markdown, without empty columns. */
  [[nodiscard]] std::string toMarkdown() const;
  /** The table as CSV (RFC 4180); numbers with 9 significant digits, missing ones empty. */
  [[nodiscard]] std::string toCsv() const;

 private:
  [[nodiscard]] std::vector<std::size_t> filledColumns() const;

  std::string title_;
  std::vector<std::string> columns_;
  std::vector<std::vector<TableCell>> rows_;
};
}  // namespace dyslam
