// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Deskew.h>
#include <dyslam/dyseg/ResidualSegmenter.h>

#include <algorithm>
#include <cmath>

#include "MovingCells.h"

namespace dyslam
{
namespace
{
constexpr double pi = 3.14159265358979323846;
constexpr double lowest_slope = -0.6;
constexpr double highest_slope = 0.6;
constexpr std::size_t chunk_size = 4096;

struct Direction
{
  int row = 0;
  int column = 0;
  float range = 0;
};
}  // namespace

void ResidualSegmenterOptions::describe(OptionsVisitor& v)
{
  v.integer("history", history, 1, 100, "scans back to the oldest one compared");
  v.integer("compared", compared, 1, 20, "earlier scans that each point is compared with");
  v.degrees("azimuth_bin_deg", azimuth_bin, 0.05, 5, "column width of the range images");
  v.real("slope_bin", slope_bin, 0.001, 0.1, "row height of the range images, z per distance");
  v.real("margin", margin, 0.01, 10, "m a point must lie before what was seen");
  v.real("margin_per_range", margin_per_range, 0, 1, "m of margin more per m of range");
  v.real("max_range", max_range, 1, 1000, "m, points beyond are static");
  v.flag("open_sky", open_sky, "a ray without return above a point went on freely");
  v.real("ground_clearance", ground_clearance, 0, 2,
         "m above the lowest point nearby that is ground");
  v.real("cell_size", cell_size, 0.05, 5, "m, cells that join votes to objects");
  v.integer("min_points", min_points, 1, 1000, "points of the smallest moving object");
  v.real("min_share", min_share, 0, 1, "share of an object's points that must have voted moving");
}

namespace
{
const ResidualSegmenterOptions& validated(const ResidualSegmenterOptions& options)
{
  validate(options, "residual");
  return options;
}
}  // namespace

ResidualSegmenter::ResidualSegmenter(const ResidualSegmenterOptions& options, ThreadPool& pool)
    : options_(validated(options)),
      pool_(pool),
      rows_(static_cast<int>((highest_slope - lowest_slope) / options.slope_bin)),
      columns_(static_cast<int>(2 * pi / options.azimuth_bin))
{
}

namespace
{
/** Row and column by slope and azimuth; the row may lie outside the image. */
Direction directionOf(const Eigen::Vector3f& p, int rows, int columns)
{
  const SweepModel counter_clockwise{1, pi};
  const float horizontal = std::sqrt(p.x() * p.x() + p.y() * p.y());
  const float slope = p.z() / std::max(horizontal, 1e-6F);
  constexpr float span = static_cast<float>(highest_slope - lowest_slope);
  Direction d;
  d.range = p.norm();
  d.column = static_cast<int>(sweepFraction(p, counter_clockwise) * static_cast<float>(columns));
  d.column = std::clamp(d.column, 0, columns - 1);
  const float row = (slope - static_cast<float>(lowest_slope)) / span * static_cast<float>(rows);
  d.row = row < 0 ? -1 : static_cast<int>(std::min(row, static_cast<float>(rows)));
  return d;
}
}  // namespace

ResidualSegmenter::PastScan ResidualSegmenter::project(const Frame& frame) const
{
  PastScan past;
  past.T_lidar_odom = (frame.T_odom_vehicle * frame.scan.T_vehicle_lidar).inverse();
  past.range.assign(static_cast<std::size_t>(rows_) * static_cast<std::size_t>(columns_), 0.0F);
  const Eigen::Isometry3f T_lidar_vehicle = frame.scan.T_vehicle_lidar.inverse().cast<float>();
  for (const auto& point : frame.cloud.points)
  {
    const Direction d = directionOf(T_lidar_vehicle * point, rows_, columns_);
    if (d.row < 0 || d.row >= rows_)
    {
      continue;
    }
    float& seen = past.range[static_cast<std::size_t>(d.row * columns_ + d.column)];
    seen = seen == 0 ? d.range : std::min(seen, d.range);
    past.highest_row = std::max(past.highest_row, d.row);
  }
  return past;
}

int ResidualSegmenter::vote(const PastScan& past, const Eigen::Vector3f& point) const
{
  const Direction d = directionOf(point, rows_, columns_);
  if (d.row < 1 || d.row >= rows_ - 1)
  {
    return 0;
  }
  const float margin =
      static_cast<float>(options_.margin) + static_cast<float>(options_.margin_per_range) * d.range;
  float nearest = 1e9F;
  bool seen_in_row[3] = {false, false, false};
  for (int up = -1; up <= 1; ++up)
  {
    for (int side = -1; side <= 1; ++side)
    {
      const int column = (d.column + side + columns_) % columns_;
      const float range = past.range[static_cast<std::size_t>((d.row + up) * columns_ + column)];
      if (range == 0)
      {
        continue;
      }
      if (std::abs(range - d.range) < margin)
      {
        return -1;
      }
      seen_in_row[up + 1] = true;
      nearest = std::min(nearest, range);
    }
  }
  // Rays on one side only may have passed just over an edge that stood there all along.
  const bool open_above = options_.open_sky && d.row + 1 < past.highest_row;
  const bool enclosed = seen_in_row[0] && (seen_in_row[2] || open_above);
  return enclosed && d.range < nearest - margin ? 2 : 0;
}

std::vector<const ResidualSegmenter::PastScan*> ResidualSegmenter::comparedScans() const
{
  std::vector<const PastScan*> scans;
  const int available = static_cast<int>(past_.size());
  int last = 0;
  for (int i = 1; i <= options_.compared; ++i)
  {
    const int back = std::max(1, i * options_.history / options_.compared);
    if (back <= available && back != last)
    {
      scans.push_back(&past_[static_cast<std::size_t>(back - 1)]);
      last = back;
    }
  }
  return scans;
}

void ResidualSegmenter::segment(Frame& frame)
{
  const auto& points = frame.cloud.points;
  frame.moving_probability.assign(points.size(), 0.1F);
  const auto scans = comparedScans();
  if (!scans.empty())
  {
    MovingCells cells(points, options_);
    const auto& candidates = cells.candidates();
    std::vector<std::int8_t> votes(candidates.size(), 0);
    for (const PastScan* past : scans)
    {
      const Eigen::Isometry3f T_past_vehicle =
          (past->T_lidar_odom * frame.T_odom_vehicle).cast<float>();
      pool_.forChunks(candidates.size(), chunk_size,
                      [&](std::size_t begin, std::size_t end, std::size_t)
                      {
                        for (std::size_t i = begin; i < end; ++i)
                        {
                          const Eigen::Vector3f p = T_past_vehicle * points[candidates[i]];
                          votes[i] = static_cast<std::int8_t>(votes[i] + vote(*past, p));
                        }
                      });
    }
    for (const std::uint32_t i : cells.moving(votes))
    {
      frame.moving_probability[i] = 0.9F;
    }
  }
  past_.push_front(project(frame));
  if (static_cast<int>(past_.size()) > options_.history)
  {
    past_.pop_back();
  }
}
}  // namespace dyslam
