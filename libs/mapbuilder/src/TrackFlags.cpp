// SPDX-License-Identifier: BSD-3-Clause
#include "TrackFlags.h"

#include <dyslam/base/Error.h>
#include <dyslam/formats/TextFile.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string_view>

namespace dyslam
{
TrackFiles::TrackFiles(const std::string& given) : boxes(given)
{
  namespace fs = std::filesystem;
  table = fs::path(given).replace_extension(".csv").string();
  if (table == given)
  {
    boxes = fs::path(given).replace_extension(".txt").string();
    if (!fs::exists(boxes))
    {
      throw UserError(given + ": " + fs::path(boxes).filename().string() +
                      ", which has the boxes in the frame of the lidar, is not beside it "
                      "(--tracks)");
    }
  }
  else if (!fs::exists(table))
  {
    table.clear();
  }
}

std::map<int, bool> dynamicTracks(const std::string& table, bool needed)
{
  TextFile file = TextFile::table(table);
  const bool has_header = file.next();
  const auto column = [&file](std::string_view name)
  {
    const auto& header = file.fields();
    const auto found = std::find(header.begin(), header.end(), name);
    return found == header.end() ? std::nullopt
                                 : std::optional<std::size_t>(found - header.begin());
  };
  const auto id = has_header ? column("id") : std::nullopt;
  const auto dynamic = has_header ? column("dynamic") : std::nullopt;
  if (!id || !dynamic)
  {
    if (needed)
    {
      throw UserError(table +
                      ": has no columns 'id' and 'dynamic'; give tracks.txt or tracks.csv "
                      "of a run (--tracks)");
    }
    return {};
  }
  const std::size_t columns = file.fields().size();
  std::map<int, bool> result;
  while (file.next())
  {
    file.requireFields(columns, "as the header");
    bool& moves = result[file.integer(*id)];
    moves = moves || file.integer(*dynamic) != 0;
  }
  return result;
}
}  // namespace dyslam
