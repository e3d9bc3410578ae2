// SPDX-License-Identifier: BSD-3-Clause
#include "GroundHeights.h"

#include <dyslam/base/Quantile.h>
#include <dyslam/base/StateArchive.h>
#include <dyslam/core/GroundSquare.h>
#include <dyslam/core/VoxelGrid.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

namespace dyslam
{
namespace
{
constexpr float ground_square = 2.0F;       // side of the large squares [m]
constexpr float fine_ground_square = 0.5F;  // side of the small squares [m]
constexpr float fine_reach = 0.5F;          // largest height over the large square's ground [m]
constexpr std::uint32_t fewest_scans = 3;  // scans with returns in a small square that has a ground
constexpr std::size_t ground_parts = 4;    // the ground is the lower quartile of the scans' heights
constexpr float unknown_ground = std::numeric_limits<float>::quiet_NaN();

using SquareHeights = std::vector<std::pair<std::uint64_t, float>>;  // voxelKey(), z [m]

/** \param side side of the squares [m] */
VoxelCell groundSquareOf(const Eigen::Vector3f& p, float side)
{
  return voxelCell(Eigen::Vector3f(p.x(), p.y(), 0), 1 / side);
}

/** Squares, numbered as they are added. */
class NumberedSquares
{
 public:
  /** \return number of the square, which may have been added before */
  std::uint32_t add(const VoxelCell& square)
  {
    const std::uint64_t key = voxelKey(square);
    if (key != last_key_)  // most points are in the same square as the one before
    {
      last_key_ = key;
      last_ = index_.findOrInsert(key, static_cast<std::uint32_t>(keys_.size()));
      if (last_ == keys_.size())
      {
        keys_.push_back(key);
        squares_.push_back(square);
      }
    }
    return last_;
  }
  [[nodiscard]] std::size_t size() const { return keys_.size(); }
  [[nodiscard]] std::uint64_t keyOf(std::size_t number) const { return keys_[number]; }
  [[nodiscard]] const VoxelCell& operator[](std::size_t number) const { return squares_[number]; }
  /** Number of the square, or VoxelHash::none. */
  [[nodiscard]] std::uint32_t find(std::uint64_t key) const { return index_.find(key); }

 private:
  VoxelHash index_;  // from keys to numbers
  std::vector<std::uint64_t> keys_;
  std::vector<VoxelCell> squares_;
  std::optional<std::uint64_t> last_key_;
  std::uint32_t last_ = 0;  // number of the square that was added last
};

/** Low quantile of the heights that the scans have in each square, one per square [m]; NaN where
 * fewer than `fewest` scans have a height. */
std::vector<float> joinedHeights(const std::vector<const SquareHeights*>& scans,
                                 const NumberedSquares& squares,
                                 std::uint32_t fewest)
{
  std::vector<std::pair<std::uint32_t, float>> found;  // number of the square, height
  std::vector<std::uint32_t> counts(squares.size());   // number of heights per square
  for (const SquareHeights* scan : scans)
  {
    for (const auto& [key, z] : *scan)
    {
      const std::uint32_t square = squares.find(key);
      if (square != VoxelHash::none)
      {
        found.emplace_back(square, z);
        ++counts[square];
      }
    }
  }
  std::vector<std::uint32_t> ends(counts.size());  // end of each square's heights in `heights`
  std::exclusive_scan(counts.begin(), counts.end(), ends.begin(), 0U);
  std::vector<float> heights(found.size());
  for (const auto& [square, z] : found)
  {
    heights[ends[square]++] = z;
  }
  std::vector<float> result;
  result.reserve(counts.size());
  for (std::size_t s = 0; s < counts.size(); ++s)
  {
    const auto end = heights.begin() + ends[s];
    result.push_back(counts[s] < fewest ? unknown_ground
                                        : lowQuantile(end - counts[s], end, ground_parts));
  }
  return result;
}

/** Upper limit of the ground's height in a square, see GroundAround [m]. \param heights ground
 * heights, one per square [m] */
float highestGround(const NumberedSquares& squares,
                    std::size_t square,
                    const std::vector<float>& heights)
{
  const VoxelCell& middle = squares[square];
  GroundAround around;
  for (int dx = -1; dx <= 1; ++dx)
  {
    for (int dy = -1; dy <= 1; ++dy)
    {
      const std::uint32_t found = squares.find(voxelKey({middle.x + dx, middle.y + dy, 0}));
      if (found != VoxelHash::none && !std::isnan(heights[found]))
      {
        around.add(heights[found]);
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
  for (const Eigen::Vector3f& point : points)
  {
    const Eigen::Vector3f p = T_odom_vehicle * point;
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
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    const Eigen::Vector3f p = T_odom_vehicle * points[i];
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
                                     const std::vector<Eigen::Vector3f>& points)
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
  const std::vector<float> ground = joinedHeights(heights_of_scans, squares, 1);
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
    heights.push_back(z - std::min(std::isnan(ground[s]) ? z : ground[s], highest[s]));
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
  const std::vector<float> ground = joinedHeights(heights_of_scans, squares, fewest_scans);
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
