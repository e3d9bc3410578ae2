// SPDX-License-Identifier: BSD-3-Clause
#include "GroundPlanes.h"

#include <dyslam/base/StateArchive.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

#include "JoinedGround.h"

namespace dyslam
{
namespace
{
constexpr int block_squares = 4;  // side of a block of large squares
constexpr int plane_reach = 6;  // squares from the middle of a block on that its plane is fitted to
constexpr float above_plane = 0.15F;  // greatest height of the ground over the plane [m]
constexpr float farthest = 1e6F;      // coordinate beyond which no plane is fitted [m]

constexpr double no_height = std::numeric_limits<double>::infinity();

VoxelCell blockOf(const Eigen::Vector3f& p)
{
  return groundSquareOf(p, block_squares * ground_square);
}

/** Calls `use` with each square that the plane of a block is fitted to. */
template <typename Use>
void forEachSquareAround(const VoxelCell& block, const Use& use)
{
  constexpr int margin = plane_reach - block_squares / 2;
  for (int x = -margin; x < block_squares + margin; ++x)
  {
    for (int y = -margin; y < block_squares + margin; ++y)
    {
      use(VoxelCell{block.x * block_squares + x, block.y * block_squares + y, 0});
    }
  }
}

/** Ground of a square in the fit of a plane. */
struct FittedSquare
{
  Eigen::Vector3d row;  //!< x and y of its middle from the middle of the block [m]; 1
  double z;             //!< height [m]
};

/** A plane with a share of 0.15 of the squares below it: quantile regression by iteratively
 * reweighted least squares. \return slopes along x and y, and height at the middle of the block [m]
 */
Eigen::Vector3d fitLowPlane(const std::vector<FittedSquare>& squares)
{
  constexpr double share_below = 0.15;
  constexpr double tolerance = 0.1;  // distance up to which the loss is quadratic [m]
  constexpr double level = 4;        // weight of the prior that the plane is level [m^2]
  constexpr int iterations = 8;
  Eigen::Vector3d plane = Eigen::Vector3d::Zero();
  for (int i = 0; i < iterations; ++i)
  {
    Eigen::Matrix3d information = Eigen::Vector3d(level, level, 0).asDiagonal();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (const FittedSquare& square : squares)
    {
      const double above = square.z - plane.dot(square.row);
      const double side = above > 0 ? share_below : 1 - share_below;
      const double weight = i == 0 ? 1 : side * tolerance / std::max(std::abs(above), tolerance);
      const Eigen::Vector3d weighted = weight * square.row;
      information += weighted * square.row.transpose();
      right += weighted * square.z;
    }
    plane = information.ldlt().solve(right);
  }
  return plane;
}

/** Plane of a block in the odometry frame; none where too few squares are known. */
Eigen::Vector3d planeOf(const VoxelCell& block,
                        const NumberedSquares& squares,
                        const std::vector<float>& ground)
{
  constexpr std::size_t fewest = 6;  // squares with a height that a plane needs
  constexpr auto side = static_cast<double>(ground_square);
  const Eigen::Vector2d middle =
      side * block_squares * Eigen::Vector2d(block.x + 0.5, block.y + 0.5);
  std::vector<FittedSquare> fitted;
  forEachSquareAround(block,
                      [&](const VoxelCell& square)
                      {
                        const float z = ground[squares.find(voxelKey(square))];
                        if (!std::isnan(z))
                        {
                          const Eigen::Vector2d at =
                              side * Eigen::Vector2d(square.x + 0.5, square.y + 0.5) - middle;
                          fitted.push_back({{at.x(), at.y(), 1}, static_cast<double>(z)});
                        }
                      });
  if (fitted.size() < fewest)
  {
    return {0, 0, no_height};
  }
  const Eigen::Vector3d plane = fitLowPlane(fitted);
  return {plane.x(), plane.y(), plane.z() - plane.head<2>().dot(middle)};
}
}  // namespace

const Eigen::Vector3d* GroundPlanes::Planes::find(std::uint64_t block) const
{
  const std::uint32_t i = index.find(block);
  return i == VoxelHash::none ? nullptr : &planes[i];
}

void GroundPlanes::Planes::clear()
{
  index.clear();
  planes.clear();
}

void GroundPlanes::Planes::exchangeState(StateArchive& archive)
{
  archive(index, planes);
}

const Eigen::Vector3d* GroundPlanes::find(std::uint64_t block) const
{
  const Eigen::Vector3d* plane = planes_.recent().find(block);
  return plane == nullptr ? planes_.older().find(block) : plane;
}

void GroundPlanes::fit(const std::vector<const LowestReturns*>& scans,
                       const std::vector<Eigen::Vector3f>& points)
{
  NumberedSquares blocks;
  std::optional<std::uint64_t> last;  // most points are in the same block as the one before
  for (const Eigen::Vector3f& p : points)
  {
    if (!(p.head<2>().array().abs() < farthest).all())
    {
      continue;  // also if it is NaN
    }
    const VoxelCell block = blockOf(p);
    const std::uint64_t key = voxelKey(block);
    if (key == last)
    {
      continue;
    }
    last = key;
    if (find(key) == nullptr)
    {
      blocks.add(block);
    }
  }
  if (blocks.size() == 0)
  {
    return;
  }
  NumberedSquares squares;
  for (std::size_t b = 0; b < blocks.size(); ++b)
  {
    forEachSquareAround(blocks[b], [&](const VoxelCell& square) { squares.add(square); });
  }
  std::vector<const SquareHeights*> heights;
  for (const LowestReturns* scan : scans)
  {
    heights.push_back(&scan->heights());
  }
  const std::vector<float> ground = joinGround(heights, squares, 1);
  Planes& recent = planes_.recent();
  for (std::size_t b = 0; b < blocks.size(); ++b)
  {
    const auto next = static_cast<std::uint32_t>(recent.planes.size());
    recent.index.findOrInsert(blocks.keyOf(b), next);
    recent.planes.push_back(planeOf(blocks[b], squares, ground));
  }
}

float GroundPlanes::highestAt(const Eigen::Vector3f& p) const
{
  const Eigen::Vector3d* plane = find(voxelKey(blockOf(p)));
  return plane == nullptr ? std::numeric_limits<float>::infinity()
                          : static_cast<float>(plane->dot(Eigen::Vector3d(
                                static_cast<double>(p.x()), static_cast<double>(p.y()), 1))) +
                                above_plane;
}

void GroundPlanes::exchangeState(StateArchive& archive)
{
  archive(planes_);
}
}  // namespace dyslam
