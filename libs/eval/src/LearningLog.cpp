// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Printable.h>
#include <dyslam/base/Words.h>
#include <dyslam/eval/LearningLog.h>

#include <cmath>
#include <cstdlib>
#include <sstream>
#include <utility>

namespace dyslam
{
namespace
{
constexpr const char* blanks = " \t\r";

/** Fields of a row without surrounding blanks; none for a blank line. */
std::vector<std::string> cellsOf(const std::string& line)
{
  std::vector<std::string> cells;
  if (line.find_first_not_of(blanks) == std::string::npos)
  {
    return cells;
  }
  std::istringstream in(line + ",");  // otherwise getline() skips an empty last field
  for (std::string cell; std::getline(in, cell, ',');)
  {
    const auto first = cell.find_first_not_of(blanks);
    const auto last = cell.find_last_not_of(blanks);
    cells.push_back(first == std::string::npos ? "" : cell.substr(first, last - first + 1));
  }
  return cells;
}

/** Whether a column has names, which may be numbers (sequence "08"). */
bool isOfNames(const std::string& column)
{
  return column == "recording" || column == "set" || column == "start";
}

bool numberOf(const std::string& cell, double& value)
{
  char* end = nullptr;
  value = std::strtod(cell.c_str(), &end);
  return !cell.empty() && *end == '\0';
}
}  // namespace

LearningLog parseLearningLog(const std::string& text, const std::string& name)
{
  std::istringstream in(text);
  std::string line;
  std::getline(in, line);
  const auto names = cellsOf(line);
  if (names.empty() || names.front() != "step")
  {
    throw UserError(name + ": the first column must be `step`; give a log of dyslam-train");
  }
  if (names.size() == 1)
  {
    throw UserError(name + ": has no column beside `step`; give a log of dyslam-train");
  }
  LearningLog log;
  log.name = name;
  std::vector<std::vector<std::string>> rows;
  while (std::getline(in, line))
  {
    const auto cells = cellsOf(line);
    if (cells.empty())
    {
      continue;
    }
    if (cells.size() != names.size())
    {
      throw UserError(name + ": row " + std::to_string(rows.size() + 1) + " has " +
                      counted(cells.size(), "field") + ", the header " +
                      std::to_string(names.size()));
    }
    rows.push_back(cells);
  }
  if (rows.empty())
  {
    throw UserError(name + ": no rows; let the training run until its first report");
  }
  log.series.resize(rows.size());
  for (std::size_t c = 0; c < names.size(); ++c)
  {
    LearningLog::Column column{names[c], std::vector<double>(rows.size(), std::nan(""))};
    bool numeric = false;
    for (std::size_t r = 0; r < rows.size(); ++r)
    {
      double value = 0;
      if (!isOfNames(names[c]) && numberOf(rows[r][c], value))
      {
        column.value[r] = value;
        numeric = true;
      }
    }
    if (c == 0)
    {
      log.step = column.value;
    }
    else if (numeric)
    {
      log.columns.push_back(std::move(column));
    }
    else
    {
      for (std::size_t r = 0; r < rows.size(); ++r)
      {
        appendWord(log.series[r], rows[r][c]);
      }
    }
  }
  return log;
}
}  // namespace dyslam
