// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/VoxelGrid.h>
#include <dyslam/mapping/ThinnedPoints.h>

#include <cstdint>
#include <optional>
#include <stdexcept>

namespace dyslam
{
namespace
{
/** The first point of every cube of side `size` [m]; nothing if there are more than `most` cubes.
 */
std::optional<MapPoints> onePerCube(const StaticMap& map, double size, std::size_t most)
{
  const auto inverse = static_cast<float>(1 / size);
  VoxelHash cubes;
  MapPoints result;
  map.forEachPart(
      [&](const MapPoints& part)
      {
        for (std::size_t i = 0; i < part.size() && result.size() <= most; ++i)
        {
          const std::uint64_t cube = voxelKey(voxelCell(part.points[i], inverse));
          const auto next = static_cast<std::uint32_t>(result.size());
          if (cubes.findOrInsert(cube, next) == next)
          {
            result.add(part, i);
          }
        }
      });
  return result.size() <= most ? std::optional<MapPoints>(std::move(result)) : std::nullopt;
}
}  // namespace

MapPoints thinnedPoints(const StaticMap& map, std::size_t most)
{
  if (most == 0)
  {
    throw std::invalid_argument("thinnedPoints: most must be at least 1");
  }
  if (map.pointCount() <= most)
  {
    return map.points();
  }
  constexpr double growth = 1.25;
  for (double size = growth * map.voxelSize();; size *= growth)
  {
    if (auto points = onePerCube(map, size, most))
    {
      return std::move(*points);
    }
  }
}
}  // namespace dyslam
