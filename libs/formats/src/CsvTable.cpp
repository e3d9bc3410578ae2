// SPDX-License-Identifier: BSD-3-Clause
#include "CsvTable.h"

#include <dyslam/base/Error.h>

#include <algorithm>
#include <charconv>

namespace dyslam
{
CsvTable::CsvTable(const std::string& path)
    : path_(path), file_(TextFile::table(path)), columns_(file_.next() ? file_.fields().size() : 0)
{
}

std::optional<std::size_t> CsvTable::find(std::string_view name) const
{
  const auto end = file_.fields().begin() + static_cast<std::ptrdiff_t>(columns_);
  const auto found = std::find(file_.fields().begin(), end, name);
  return found == end ? std::nullopt : std::optional<std::size_t>(found - file_.fields().begin());
}

std::size_t CsvTable::column(const std::string& name) const
{
  const auto found = find(name);
  if (!found)
  {
    throw UserError(path_ + ": has no column '" + name + "'; is it the table of a run?");
  }
  return *found;
}

bool CsvTable::next()
{
  if (!file_.next())
  {
    return false;
  }
  file_.requireFields(columns_, "as the header");
  return true;
}

std::size_t CsvTable::count(std::size_t column) const
{
  const std::string_view text = file_.fields()[column];
  std::size_t value = 0;
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), value);
  if (parsed.ec != std::errc() || parsed.ptr != text.data() + text.size())
  {
    file_.fail("'" + std::string(text) + "' is not a whole number");
  }
  return value;
}
}  // namespace dyslam
