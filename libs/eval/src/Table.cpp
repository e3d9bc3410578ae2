// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Printable.h>
#include <dyslam/eval/Table.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace dyslam
{
namespace
{
std::string fixed(std::optional<double> number, int digits)
{
  return number && std::isfinite(*number) ? formatted("%.*f", digits, *number) : "-";
}

/** Number of characters of UTF-8 text: bytes that do not continue a character. */
std::size_t width(const std::string& text)
{
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(),
                    [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

/** Text of a cell of a table in Markdown. */
std::string markdownCell(const std::string& text)
{
  std::string cell;
  for (const char c : text)
  {
    cell += c == '|' ? "\\|" : std::string(1, c);
  }
  return cell;
}

std::string padded(const std::string& text, std::size_t to, bool left)
{
  const std::string fill(to - std::min(to, width(text)), ' ');
  return left ? text + fill : fill + text;
}
}  // namespace

TableCell::TableCell(std::optional<double> number, int digits) : text(fixed(number, digits))
{
  if (number && std::isfinite(*number))
  {
    value = number;
  }
}

TableCell::TableCell(std::optional<double> number, int digits, std::optional<double> paper)
    : TableCell(number, digits)
{
  if (paper)
  {
    text += " (paper " + fixed(paper, digits) + ")";
  }
}

Table::Table(std::vector<std::string> columns, std::string title)
    : title_(std::move(title)), columns_(std::move(columns))
{
}

void Table::addRow(std::vector<TableCell> cells)
{
  if (cells.size() != columns_.size())
  {
    throw std::invalid_argument("Table: a row needs one cell per column");
  }
  rows_.push_back(std::move(cells));
}

std::vector<std::size_t> Table::filledColumns() const
{
  std::vector<std::size_t> filled;
  for (std::size_t c = 0; c < columns_.size(); ++c)
  {
    const auto has_entry = [c](const std::vector<TableCell>& row)
    { return !row[c].text.empty() && row[c].text != "-"; };
    if (rows_.empty() || std::any_of(rows_.begin(), rows_.end(), has_entry))
    {
      filled.push_back(c);
    }
  }
  return filled;
}

std::string Table::toText() const
{
  const auto shown = filledColumns();
  std::vector<std::size_t> widths;
  for (const std::size_t c : shown)
  {
    std::size_t widest = width(columns_[c]);
    for (const auto& row : rows_)
    {
      widest = std::max(widest, width(row[c].text));
    }
    widths.push_back(widest);
  }
  std::string out = title_.empty() ? "" : title_ + "\n";
  const auto line = [&](const auto& text_of)
  {
    std::string text;
    for (std::size_t i = 0; i < shown.size(); ++i)
    {
      text += (i == 0 ? "" : "  ") + padded(text_of(shown[i]), widths[i], shown[i] == 0);
    }
    text.erase(text.find_last_not_of(' ') + 1);
    out += text + "\n";
  };
  line([&](std::size_t c) { return columns_[c]; });
  std::size_t total = 0;
  for (const std::size_t w : widths)
  {
    total += w + 2;
  }
  out += std::string(total < 2 ? 0 : total - 2, '-') + "\n";
  for (const auto& row : rows_)
  {
    line([&](std::size_t c) { return row[c].text; });
  }
  return out;
}

std::string Table::toMarkdown() const
{
  const auto shown = filledColumns();
  std::string out;
  const auto line = [&](const auto& text_of)
  {
    for (const std::size_t c : shown)
    {
      out += "| " + markdownCell(text_of(c)) + " ";
    }
    out += "|\n";
  };
  line([&](std::size_t c) { return columns_[c]; });
  for (std::size_t i = 0; i < shown.size(); ++i)
  {
    out += "|---";
  }
  out += "|\n";
  for (const auto& row : rows_)
  {
    line([&](std::size_t c) { return row[c].text; });
  }
  return out;
}

std::string Table::toCsv() const
{
  std::string out;
  const auto line = [&](const auto& text_of)
  {
    for (std::size_t c = 0; c < columns_.size(); ++c)
    {
      out += (c == 0 ? "" : ",") + csvField(text_of(c));
    }
    out += "\n";
  };
  line([&](std::size_t c) { return columns_[c]; });
  for (const auto& row : rows_)
  {
    line(
        [&](std::size_t c)
        {
          if (row[c].value)
          {
            return formatted("%.*g", 9, *row[c].value);
          }
          return row[c].text == "-" ? std::string() : row[c].text;
        });
  }
  return out;
}
}  // namespace dyslam
