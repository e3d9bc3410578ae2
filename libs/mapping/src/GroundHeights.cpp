// SPDX-License-Identifier: BSD-3-Clause
#include "GroundHeights.h"

#include <dyslam/base/StateArchive.h>
#include <dyslam/core/GroundSquare.h>
#include <dyslam/core/VoxelGrid.h>

#include <algorithm>
#include <cmath>

#include "GroundPlanes.h"
#include "JoinedGround.h"

namespace dyslam
{
namespace
{
constexpr float fine_reach = 0.5F;         // largest height over the large square's ground [m]
constexpr std::uint32_t fewest_scans = 3;  // scans with returns in a small square that has a ground

/** Upper limit of the ground's height in a square, see GroundAround [m]. \param ground one per
 * square */
float highestGround(const NumberedSquares& squares,
                    std::size_t square,
                    const std::vector<float>& ground)
{
  const VoxelCell& middle = squares[square];
  GroundAround around;
  for (int dx = -1; dx <= 1; ++dx)
  {
    for (int dy = -1; dy <= 1; ++dy)
    {
      const std::uint32_t found = squares.find(voxelKey({middle.x + dx, middle.y + dy, 0}));
      if (found != VoxelHash::none && !std::isnan(ground[found]))
      {
        around.add(ground[found]);
      }
    }
  }
  return around.highest();
}
}  // namespace

LowestReturns::LowestReturns(const std::vector<Eigen::Vector3f>& points,
                             const Eigen::Isometry3f& T_odom_vehicle)
{
  NumberedSquares squares;
  std::vector<GroundSquare> lowest;
  std::vector<std::uint32_t> square_of_point;
  square_of_point.reserve(points.size());
  std::vector<Eigen::Vector3f> in_odom;
  in_odom.reserve(points.size());
  for (const Eigen::Vector3f& point : points)
  {
    const Eigen::Vector3f p = T_odom_vehicle * point;
    in_odom.push_back(p);
    const std::uint32_t square = squares.add(groundSquareOf(p, ground_square));
    square_of_point.push_back(square);
    lowest.resize(squares.size());
    lowest[square].add(p.z());
  }
  for (std::size_t s = 0; s < squares.size(); ++s)
  {
    heights_.emplace_back(squares.keyOf(s), lowest[s].thirdLowest());
  }
  NumberedSquares fine_squares;
  for (std::size_t i = 0; i < in_odom.size(); ++i)
  {
    const Eigen::Vector3f& p = in_odom[i];
    if (!(p.z() < heights_[square_of_point[i]].second + fine_reach))
    {
      continue;
    }
    const std::uint32_t square = fine_squares.add(groundSquareOf(p, fine_ground_square));
    if (square == fine_.size())
    {
      fine_.emplace_back(fine_squares.keyOf(square), p.z());
    }
    fine_[square].second = std::min(fine_[square].second, p.z());
  }
}

void LowestReturns::exchangeState(StateArchive& archive)
{
  archive(heights_, fine_);
}

std::vector<float> heightsOverGround(const std::vector<const LowestReturns*>& scans,
                                     const std::vector<Eigen::Vector3f>& points,
                                     const GroundPlanes& planes)
{
  NumberedSquares squares;
  std::vector<std::uint32_t> square_of_point;
  square_of_point.reserve(points.size());
  for (const Eigen::Vector3f& p : points)
  {
    square_of_point.push_back(squares.add(groundSquareOf(p, ground_square)));
  }
  const std::size_t of_points = squares.size();
  for (std::size_t s = 0; s < of_points; ++s)
  {
    const VoxelCell middle = squares[s];
    for (int dx = -1; dx <= 1; ++dx)
    {
      for (int dy = -1; dy <= 1; ++dy)
      {
        squares.add({middle.x + dx, middle.y + dy, 0});
      }
    }
  }
  std::vector<const SquareHeights*> heights_of_scans;
  for (const LowestReturns* scan : scans)
  {
    heights_of_scans.push_back(&scan->heights());
  }
  const std::vector<float> ground = joinGround(heights_of_scans, squares, 1);
  std::vector<float> highest;
  highest.reserve(of_points);
  for (std::size_t s = 0; s < of_points; ++s)
  {
    highest.push_back(highestGround(squares, s, ground));
  }
  std::vector<float> heights;
  heights.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    const std::uint32_t s = square_of_point[i];
    const float z = points[i].z();
    const float limit = std::min(highest[s], planes.highestAt(points[i]));
    heights.push_back(z - std::min(std::isnan(ground[s]) ? z : ground[s], limit));
  }
  return heights;
}

std::vector<float> fineHeightsOverGround(const std::vector<const LowestReturns*>& scans,
                                         const std::vector<Eigen::Vector3f>& points,
                                         const std::vector<float>& heights)
{
  NumberedSquares squares;
  std::vector<std::uint32_t> square_of_point;
  square_of_point.reserve(points.size());
  for (const Eigen::Vector3f& p : points)
  {
    square_of_point.push_back(squares.add(groundSquareOf(p, fine_ground_square)));
  }
  std::vector<const SquareHeights*> heights_of_scans;
  for (const LowestReturns* scan : scans)
  {
    heights_of_scans.push_back(&scan->fineHeights());
  }
  const std::vector<float> ground = joinGround(heights_of_scans, squares, fewest_scans);
  std::vector<float> result;
  result.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    const float fine = ground[square_of_point[i]];
    result.push_back(std::isnan(fine) ? heights[i] : std::min(heights[i], points[i].z() - fine));
  }
  return result;
}
}  // namespace dyslam
