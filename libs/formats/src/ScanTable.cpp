// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/core/Files.h>
#include <dyslam/formats/ScanTable.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <vector>

namespace dyslam
{
namespace
{
/** Fields of a line; those in quotes may have commas. */
std::vector<std::string> fieldsOf(const std::string& line)
{
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (const char c : line)
  {
    quoted = c == '"' ? !quoted : quoted;
    if (c == ',' && !quoted)
    {
      fields.emplace_back();
    }
    else if (c != '"' && c != '\r')
    {
      fields.back().push_back(c);
    }
  }
  return fields;
}
}  // namespace

std::set<std::size_t> unregisteredScans(const std::string& path)
{
  std::ifstream file = openBinary(path);
  std::string line;
  std::getline(file, line);
  const std::vector<std::string> header = fieldsOf(line);
  const auto column = [&](const char* name)
  {
    const auto found = std::find(header.begin(), header.end(), name);
    if (found == header.end())
    {
      throw UserError(path + ": has no column '" + name + "'; is it the scans.csv of a run?");
    }
    return static_cast<std::size_t>(found - header.begin());
  };
  const std::size_t frame = column("frame");
  const std::size_t registered = column("registered");
  std::set<std::size_t> scans;
  for (int number = 2; std::getline(file, line); ++number)
  {
    const auto fail = [&](const std::string& what)
    { throw UserError(path + ":" + std::to_string(number) + ": " + what); };
    const std::vector<std::string> fields = fieldsOf(line);
    if (fields.size() != header.size())
    {
      fail("has " + std::to_string(fields.size()) + " fields, not " +
           std::to_string(header.size()) + " as the first line");
    }
    const std::string& text = fields[frame];
    std::size_t scan = 0;
    const auto parsed = std::from_chars(text.data(), text.data() + text.size(), scan);
    if (parsed.ec != std::errc() || parsed.ptr != text.data() + text.size())
    {
      fail("'" + text + "' is not the number of a scan");
    }
    if (fields[registered] == "0")
    {
      scans.insert(scan);
    }
  }
  requireReadable(file, path);
  return scans;
}
}  // namespace dyslam
