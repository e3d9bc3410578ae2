// SPDX-License-Identifier: BSD-3-Clause
#include "TrackFlags.h"

#include <dyslam/base/Error.h>
#include <dyslam/formats/TrackTable.h>

#include <filesystem>

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
  const TrackTable tracks = readTrackTable(table, {TrackValue::id, TrackValue::dynamic});
  if (!tracks.missing.empty() && needed)
  {
    throw UserError(table +
                    ": has no columns 'id' and 'dynamic'; give tracks.txt or tracks.csv "
                    "of a run (--tracks)");
  }
  std::map<int, bool> result;
  for (const TrackTableRow& row : tracks.rows)
  {
    bool& moves = result[row.id];
    moves = moves || row.dynamic;
  }
  return result;
}
}  // namespace dyslam
