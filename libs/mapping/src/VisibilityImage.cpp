// SPDX-License-Identifier: BSD-3-Clause
#include "VisibilityImage.h"

#include <dyslam/base/StateArchive.h>
#include <dyslam/core/Deskew.h>
#include <dyslam/core/FastAngle.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace dyslam
{
namespace
{
constexpr auto pi = static_cast<float>(M_PI);
constexpr float row_height = 0.4F * pi / 180.0F;
constexpr float horizon = 0.5F * row_height;  // elevation where row 0 begins [rad]
constexpr float zenith_row = 225;             // row straight up; -225: straight down, or not finite
constexpr int widest_window = 4;      // largest half width of the window around a voxel [pixels]
constexpr int widest_gap = 6;         // largest distance to the rays above and below [rows]
constexpr int widest_side = 3;        // largest distance to the rays on both sides [columns]
constexpr float nearest = 0.5F;       // least range of a ray [m]
constexpr float closest_pass = 0.1F;  // largest distance of a ray from a voxel's centre [m]

constexpr std::size_t block = 128;  // rays processed together
}  // namespace

/** Rays to several points, as arrays for vector instructions. */
struct VisibilityImage::Rays
{
  std::size_t count = 0;
  std::array<float, block> x, y, z;  //!< from the sensor to the points [m]
  std::array<float, block> range;    //!< [m]
  std::array<int, block> row;        //!< rows above the horizon
  std::array<int, block> col;

  void set(std::size_t i, const Eigen::Vector3f& ray)
  {
    x[i] = ray.x();
    y[i] = ray.y();
    z[i] = ray.z();
  }
  void findColumns()
  {
    for (std::size_t i = 0; i < count; ++i)
    {
      const float c = (turnsOf(y[i], x[i]) + 0.5F) * cols;
      // This order of min and max maps NaN to 0.
      const int column = static_cast<int>(std::min(std::max(0.F, c), static_cast<float>(cols)));
      col[i] = column < cols ? column : 0;  // straight behind: both ends of the turn
    }
  }
  void findRows()
  {
    for (std::size_t i = 0; i < count; ++i)
    {
      const float elevation = 2 * pi * turnsOf(z[i], std::sqrt(x[i] * x[i] + y[i] * y[i]));
      const float r = std::floor((elevation - horizon) / row_height);
      row[i] = static_cast<int>(std::min(std::max(-zenith_row, r), zenith_row));
      range[i] = Eigen::Vector3f(x[i], y[i], z[i]).norm();
    }
  }
};

void VisibilityImage::setRows(const std::vector<Eigen::Vector3f>& points, const LidarRange& lidar)
{
  int highest = 0;
  bool any = false;
  Rays rays;
  for (std::size_t begin = lidar.begin; begin < lidar.end; begin += block)
  {
    rays.count = std::min(block, lidar.end - begin);
    for (std::size_t i = 0; i < rays.count; ++i)
    {
      rays.set(i, points[begin + i] - sensor_);
    }
    rays.findRows();
    for (std::size_t i = 0; i < rays.count; ++i)
    {
      if (std::isfinite(rays.range[i]) && rays.range[i] >= nearest)
      {
        lowest_ = any ? std::min(lowest_, rays.row[i]) : rays.row[i];
        highest = any ? std::max(highest, rays.row[i]) : rays.row[i];
        any = true;
      }
    }
  }
  lowest_ -= widest_window;
  rows_ = any ? highest + widest_window + 1 - lowest_ : 0;
  pixels_.assign(static_cast<std::size_t>(rows_) * stride, no_return);
}

VisibilityImage::VisibilityImage(const Cloud& cloud, const LidarRange& lidar)
    : sensor_(lidar.sensor())
{
  const Eigen::Vector3f sensor = lidar.sensor();
  setRows(cloud.points, lidar);
  const bool timed = cloud.phase.size() == cloud.size() && !cloud.points.empty();
  const SweepMotion sweep(cloud.T_sweep, 0);
  std::vector<Eigen::Vector3f> sum(timed ? cols : 0, Eigen::Vector3f::Zero());
  std::vector<int> count(timed ? cols : 0, 0);
  std::vector<Eigen::Vector3f> origin(block, sensor);
  Rays rays;
  for (std::size_t begin = lidar.begin; begin < lidar.end; begin += block)
  {
    rays.count = std::min(block, lidar.end - begin);
    for (std::size_t i = 0; i < rays.count; ++i)
    {
      if (timed)
      {
        origin[i] = sweep.toReference(sensor, cloud.phase[begin + i]);
      }
      rays.set(i, cloud.points[begin + i] - origin[i]);
    }
    rays.findColumns();
    rays.findRows();
    for (std::size_t i = 0; i < rays.count; ++i)
    {
      const float range = rays.range[i];
      if (!std::isfinite(range) || range < nearest)
      {
        continue;
      }
      const int col = rays.col[i];
      if (timed)
      {
        sum[static_cast<std::size_t>(col)] += origin[i];
        ++count[static_cast<std::size_t>(col)];
      }
      const int row = rays.row[i] - lowest_;
      if (row >= 0 && row < rows_)
      {
        constexpr float farthest = resolution * (no_return - 1);
        const auto rounded =
            static_cast<std::uint16_t>(std::min(range, farthest) / resolution + 0.5F);
        std::uint16_t& pixel = pixels_[indexOf(row, col)];
        pixel = std::min(pixel, rounded);
      }
    }
  }
  closeTurn();
  setColumnOrigins(sum, count);
}

/** Repeats the columns of each end of the turn beyond the other one. */
void VisibilityImage::closeTurn()
{
  static_assert(side_cols >= widest_window && side_cols >= widest_side);
  for (int row = 0; row < rows_; ++row)
  {
    std::copy_n(&pixels_[indexOf(row, 0)], side_cols, &pixels_[indexOf(row, cols)]);
    std::copy_n(&pixels_[indexOf(row, cols - side_cols)], side_cols,
                &pixels_[indexOf(row, -side_cols)]);
  }
}

void VisibilityImage::setColumnOrigins(const std::vector<Eigen::Vector3f>& sum,
                                       const std::vector<int>& count)
{
  column_sensor_.assign(sum.size(), sensor_);
  for (std::size_t col = 0; col < sum.size(); ++col)
  {
    if (count[col] > 0)
    {
      column_sensor_[col] = sum[col] / static_cast<float>(count[col]);
    }
  }
}

/** Makes points of the vehicle frame rays from the sensor, with their columns, rows and ranges. */
void VisibilityImage::fromSensor(Rays& rays) const
{
  std::array<float, block> px;
  std::array<float, block> py;
  std::array<float, block> pz;
  std::copy_n(rays.x.begin(), rays.count, px.begin());
  std::copy_n(rays.y.begin(), rays.count, py.begin());
  std::copy_n(rays.z.begin(), rays.count, pz.begin());
  for (std::size_t i = 0; i < rays.count; ++i)
  {
    rays.x[i] = px[i] - sensor_.x();
    rays.y[i] = py[i] - sensor_.y();
    rays.z[i] = pz[i] - sensor_.z();
  }
  if (!column_sensor_.empty())
  {
    rays.findColumns();
    for (std::size_t i = 0; i < rays.count; ++i)
    {
      const Eigen::Vector3f& origin = column_sensor_[static_cast<std::size_t>(rays.col[i])];
      rays.x[i] = px[i] - origin.x();
      rays.y[i] = py[i] - origin.y();
      rays.z[i] = pz[i] - origin.z();
    }
  }
  rays.findColumns();
  rays.findRows();
}

Evidence VisibilityImage::evidenceAt(int row, int col, float range, float size, float margin) const
{
  constexpr float pixel = 2 * pi / cols;
  if (!std::isfinite(range) || range < nearest)
  {
    return Evidence::none;
  }
  const int hit = static_cast<int>(closest_pass / (range * pixel));
  const int half =
      std::clamp(static_cast<int>(std::ceil(0.5F * size / range / pixel)), 1, widest_window);
  if (row < half || row >= rows_ - half)
  {
    return Evidence::none;
  }
  if (std::abs(rangeOf(pixels_[indexOf(row, col)]) - range) <= margin)
  {
    return Evidence::occupied;  // most voxels are; saves evaluating the other pixels
  }
  int passed = 0;
  bool close = false;
  bool stopped = false;
  for (int r = -half; r <= half; ++r)
  {
    const std::uint16_t* line = &pixels_[indexOf(row + r, col)];
    for (int c = -half; c <= half; ++c)
    {
      const float seen = rangeOf(line[c]);
      if (std::abs(seen - range) <= margin)
      {
        return Evidence::occupied;
      }
      stopped = stopped || seen < range;
      const bool passes = seen > range && line[c] != no_return;
      passed += passes ? 1 : 0;
      close = close || (passes && std::abs(r) <= hit && std::abs(c) <= hit);
    }
  }
  if (stopped)
  {
    return Evidence::occluded;
  }
  return passed > half ? (close ? Evidence::free : Evidence::passed_by) : Evidence::none;
}

/** evidenceAt(), or the evidence of the nearest rays around where too few pass near the voxel. */
Evidence VisibilityImage::evidenceAround(
    int row, int col, float range, float size, float margin) const
{
  const Evidence seen = evidenceAt(row, col, range, size, margin);
  if (seen == Evidence::none || seen == Evidence::passed_by)
  {
    return evidenceBetweenRows(row, col, range, margin);
  }
  if (seen == Evidence::free)
  {
    // On a surface seen at a grazing angle, sparse rays may end behind a voxel with no other ray
    // beside them in the window.
    const Evidence beside = evidenceInRow(row, col, range, margin);
    return beside == Evidence::occupied || beside == Evidence::occluded ? beside : seen;
  }
  return seen;
}

Evidence VisibilityImage::evidenceBetweenRows(int row, int col, float range, float margin) const
{
  if (!std::isfinite(range) || range < nearest)
  {
    return Evidence::none;
  }
  for (const int up : {-1, 1})
  {
    Evidence seen = Evidence::none;
    for (int gap = 0; gap <= widest_gap && seen == Evidence::none; ++gap)
    {
      seen = evidenceInRow(row + up * gap, col, range, margin);
    }
    if (seen != Evidence::free)
    {
      return seen;
    }
  }
  return Evidence::enclosed;
}

/** Evidence of the nearest rays to both sides in one row: free if both passed the voxel. On a
 * surface that is seen at a grazing angle, one of them would have ended before it. */
Evidence VisibilityImage::evidenceInRow(int row, int col, float range, float margin) const
{
  if (row < 0 || row >= rows_)
  {
    return Evidence::none;
  }
  const std::uint16_t* pixel = &pixels_[indexOf(row, col)];
  int passed = 0;
  for (const int side : {0, -1, 1})
  {
    std::uint16_t nearest_pixel = pixel[side];
    for (int gap = 2; gap <= widest_side && nearest_pixel == no_return; ++gap)
    {
      nearest_pixel = pixel[side * gap];
    }
    const float seen = rangeOf(nearest_pixel);
    if (std::abs(seen - range) <= margin)
    {
      return Evidence::occupied;
    }
    if (seen < range)
    {
      return Evidence::occluded;
    }
    passed += nearest_pixel != no_return && side != 0 ? 1 : 0;
  }
  return passed == 0 ? Evidence::none : passed == 2 ? Evidence::free : Evidence::passed_by;
}

/** Evidence of one voxel after the other. \param place gives each voxel's place in the vehicle
 * frame [m] \param evidence_at gives its evidence from row, column and range */
template <typename Place, typename EvidenceAt>
void VisibilityImage::forEach(std::size_t count,
                              const Place& place,
                              const EvidenceAt& evidence_at,
                              Evidence* evidence) const
{
  Rays rays;
  for (std::size_t begin = 0; begin < count; begin += block)
  {
    rays.count = std::min(block, count - begin);
    for (std::size_t i = 0; i < rays.count; ++i)
    {
      rays.set(i, place(begin + i));
    }
    fromSensor(rays);
    for (std::size_t i = 0; i < rays.count; ++i)
    {
      evidence[begin + i] = evidence_at(rays.row[i] - lowest_, rays.col[i], rays.range[i]);
    }
  }
}

void VisibilityImage::evaluate(const Eigen::Vector3f* voxels,
                               std::size_t count,
                               const Eigen::Isometry3f& T_vehicle_voxels,
                               float size,
                               float margin,
                               Evidence* evidence) const
{
  forEach(
      count, [&](std::size_t i) -> Eigen::Vector3f { return T_vehicle_voxels * voxels[i]; },
      [=](int row, int col, float range) { return evidenceAround(row, col, range, size, margin); },
      evidence);
}

void VisibilityImage::at(const Eigen::Vector3f* voxels,
                         std::size_t count,
                         float size,
                         float margin,
                         Evidence* evidence) const
{
  forEach(
      count, [=](std::size_t i) { return voxels[i]; },
      [=](int row, int col, float range) { return evidenceAt(row, col, range, size, margin); },
      evidence);
}

void VisibilityImage::exchangeState(StateArchive& archive)
{
  archive(sensor_, lowest_, rows_, column_sensor_, pixels_);
}
}  // namespace dyslam
