// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/mapbuilder/MapOutputs.h>
#include <dyslam/mapexport/MapFormat.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>

namespace dyslam
{
Trajectory MapOutputs::inFixedFrame(Trajectory trajectory) const
{
  if (T_fixed_map)
  {
    for (std::size_t i = 0; i < trajectory.size(); ++i)
    {
      trajectory[i].pose = *T_fixed_map * trajectory[i].pose;
    }
  }
  return trajectory;
}

std::string MapOutputs::beside(const std::string& ending) const
{
  for (const std::string& path : {maps.empty() ? "" : maps.front(), picture, comparison})
  {
    if (!path.empty())
    {
      return std::filesystem::path(path).replace_extension("").string() + ending;
    }
  }
  return {};
}

bool MapOutputs::needWholeMap() const
{
  const bool clouds_only =
      std::all_of(maps.begin(), maps.end(),
                  [](const auto& path) { return mapFormatOf(path).kind == MapKind::cloud; });
  const bool all_in_tiles = exports.tile_size > 0 && clouds_only;
  return !picture.empty() || !comparison.empty() || (!maps.empty() && !all_in_tiles);
}

bool MapOutputs::needScans() const
{
  return std::any_of(maps.begin(), maps.end(),
                     [this](const auto& path)
                     {
                       const MapFormat format = mapFormatOf(path);
                       return (format.kind == MapKind::cloud && exports.tile_size > 0) ||
                              (format.has_every_point && exports.full_resolution);
                     });
}
}  // namespace dyslam
