// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/formats/ScanTable.h>
#include <dyslam/formats/TextFile.h>

#include <algorithm>
#include <charconv>
#include <string_view>
#include <vector>

namespace dyslam
{
std::set<std::size_t> unregisteredScans(const std::string& path)
{
  TextFile file = TextFile::table(path);
  const std::size_t columns = file.next() ? file.fields().size() : 0;
  const auto column = [&](const char* name)
  {
    const auto found = std::find(file.fields().begin(), file.fields().end(), name);
    if (found == file.fields().end())
    {
      throw UserError(path + ": has no column '" + name + "'; is it the scans.csv of a run?");
    }
    return static_cast<std::size_t>(found - file.fields().begin());
  };
  const std::size_t frame = column("frame");
  const std::size_t registered = column("registered");
  std::set<std::size_t> scans;
  while (file.next())
  {
    const std::vector<std::string_view>& fields = file.fields();
    if (fields.size() != columns)
    {
      file.fail("has " + std::to_string(fields.size()) + " fields, not " + std::to_string(columns) +
                " as the first line");
    }
    const std::string_view text = fields[frame];
    std::size_t scan = 0;
    const auto parsed = std::from_chars(text.data(), text.data() + text.size(), scan);
    if (parsed.ec != std::errc() || parsed.ptr != text.data() + text.size())
    {
      file.fail("'" + std::string(text) + "' is not the number of a scan");
    }
    if (fields[registered] == "0")
    {
      scans.insert(scan);
    }
  }
  return scans;
}
}  // namespace dyslam
