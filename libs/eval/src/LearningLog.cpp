// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/ParseNumber.h>
#include <dyslam/base/Printable.h>
#include <dyslam/base/Words.h>
#include <dyslam/eval/LearningLog.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>
#include <utility>

namespace dyslam
{
namespace
{

/** Fields of a row without surrounding blanks; none for a blank line. */
std::vector<std::string> cellsOf(const std::string& line)
{
  std::vector<std::string> cells;
  if (trimmed(line).empty())
  {
    return cells;
  }
  std::istringstream in(line + ",");  // otherwise getline() skips an empty last field
  for (std::string cell; std::getline(in, cell, ',');)
  {
    cells.push_back(trimmed(cell));
  }
  return cells;
}

/** Whether a column has names, which may be numbers (sequence "08"). */
bool isOfNames(const std::string& column)
{
  return column == "recording" || column == "set" || column == "start";
}

/** A CSV file as words. */
struct Words
{
  std::vector<std::string> names;              // names of the columns
  std::vector<std::vector<std::string>> rows;  // each as long as `names`
};

Words readWords(const std::string& text, const std::string& name)
{
  Words words;
  std::istringstream in(text);
  std::string line;
  std::getline(in, line);
  words.names = cellsOf(line);
  if (words.names.empty() || words.names.front() != "step")
  {
    throw UserError(name + ": the first column must be `step`; give a log of dyslam-train");
  }
  if (words.names.size() == 1)
  {
    throw UserError(name + ": has no column beside `step`; give a log of dyslam-train");
  }
  while (std::getline(in, line))
  {
    auto cells = cellsOf(line);
    if (cells.empty())
    {
      continue;
    }
    if (cells.size() != words.names.size())
    {
      throw UserError(name + ": row " + std::to_string(words.rows.size() + 1) + " has " +
                      counted(cells.size(), "field") + ", the header " +
                      std::to_string(words.names.size()));
    }
    words.rows.push_back(std::move(cells));
  }
  if (words.rows.empty())
  {
    throw UserError(name + ": no rows; let the training run until its first report");
  }
  return words;
}

/** Whether no row has anything in a column, as a precision without a point called moving. */
bool isEmpty(const Words& words, std::size_t column)
{
  return std::all_of(words.rows.begin(), words.rows.end(),
                     [column](const std::vector<std::string>& row) { return row[column].empty(); });
}

/** Numbers of a column, NaN where a cell has none; nothing for a column of text or names. */
std::optional<std::vector<double>> numbersOf(const Words& words, std::size_t column)
{
  if (isOfNames(words.names[column]))
  {
    return std::nullopt;
  }
  std::vector<double> numbers;
  bool any = false;
  for (const std::vector<std::string>& row : words.rows)
  {
    const std::optional<double> number = parseNumber<double>(row[column]);
    numbers.push_back(number.value_or(std::nan("")));
    any = any || number.has_value();
  }
  return any ? std::optional(std::move(numbers)) : std::nullopt;
}
}  // namespace

LearningLog parseLearningLog(const std::string& text, const std::string& name)
{
  const Words words = readWords(text, name);
  const std::size_t rows = words.rows.size();
  LearningLog log;
  log.name = name;
  log.step = numbersOf(words, 0).value_or(std::vector<double>(rows, std::nan("")));
  log.series.resize(rows);
  for (std::size_t c = 1; c < words.names.size(); ++c)
  {
    if (isEmpty(words, c))
    {
      continue;
    }
    if (auto numbers = numbersOf(words, c))
    {
      log.columns.push_back({words.names[c], std::move(*numbers)});
      continue;
    }
    for (std::size_t r = 0; r < rows; ++r)
    {
      appendWord(log.series[r], words.rows[r][c]);
    }
  }
  return log;
}
}  // namespace dyslam
