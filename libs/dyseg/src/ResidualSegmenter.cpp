// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/dyseg/ResidualSegmenter.h>

#include <algorithm>
#include <cmath>

#include "MovingCells.h"

namespace dyslam
{
namespace
{
constexpr double pi = 3.14159265358979323846;
constexpr double lowest_elevation = -0.6;
constexpr double highest_elevation = 0.6;
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
  v.degrees("elevation_bin_deg", elevation_bin, 0.05, 5, "row height of the range images");
  v.real("margin", margin, 0.01, 10, "m a point must lie before what was seen");
  v.real("margin_per_range", margin_per_range, 0, 1, "m of margin more per m of range");
  v.real("max_range", max_range, 1, 1000, "m, points beyond are static");
  v.real("ground_clearance", ground_clearance, 0, 2,
         "m above the lowest point nearby that is ground");
  v.real("cell_size", cell_size, 0.05, 5, "m, cells that join votes to objects");
  v.integer("min_points", min_points, 1, 1000, "points of the smallest moving object");
  v.real("min_share", min_share, 0, 1, "share of an object's points that must have voted moving");
}

ResidualSegmenter::ResidualSegmenter(const ResidualSegmenterOptions& options, ThreadPool& pool)
    : options_(options),
      pool_(pool),
      rows_(static_cast<int>((highest_elevation - lowest_elevation) / options.elevation_bin)),
      columns_(static_cast<int>(2 * pi / options.azimuth_bin))
{
  validate(options_, "residual");
}

namespace
{
Direction directionOf(const Eigen::Vector3f& p, int rows, int columns)
{
  Direction d;
  d.range = p.norm();
  const float azimuth = std::atan2(p.y(), p.x());
  const float elevation = std::asin(std::clamp(p.z() / std::max(d.range, 1e-6F), -1.0F, 1.0F));
  d.column = static_cast<int>((azimuth + static_cast<float>(pi)) / static_cast<float>(2 * pi) *
                              static_cast<float>(columns));
  d.column = std::clamp(d.column, 0, columns - 1);
  d.row = static_cast<int>(std::floor((elevation - static_cast<float>(lowest_elevation)) /
                                      static_cast<float>(highest_elevation - lowest_elevation) *
                                      static_cast<float>(rows)));
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
  int seen = 0;
  for (int row = d.row - 1; row <= d.row + 1; ++row)
  {
    for (int step = -1; step <= 1; ++step)
    {
      const int column = (d.column + step + columns_) % columns_;
      const float range = past.range[static_cast<std::size_t>(row * columns_ + column)];
      if (range == 0)
      {
        continue;
      }
      ++seen;
      if (std::abs(range - d.range) < margin)
      {
        return -1;
      }
      nearest = std::min(nearest, range);
    }
  }
  return seen >= 2 && d.range < nearest - margin ? 1 : 0;
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
  frame.moving_probability.assign(points.size(), 0.0F);
  const auto scans = comparedScans();
  if (!scans.empty())
  {
    std::vector<std::int8_t> votes(points.size(), 0);
    for (const PastScan* past : scans)
    {
      const Eigen::Isometry3f T_past_vehicle =
          (past->T_lidar_odom * frame.T_odom_vehicle).cast<float>();
      pool_.forChunks(points.size(), chunk_size,
                      [&](std::size_t begin, std::size_t end, std::size_t)
                      {
                        for (std::size_t i = begin; i < end; ++i)
                        {
                          if (points[i].norm() < static_cast<float>(options_.max_range))
                          {
                            votes[i] = static_cast<std::int8_t>(
                                votes[i] + vote(*past, T_past_vehicle * points[i]));
                          }
                        }
                      });
    }
    const auto moving = movingCells(points, votes, options_);
    for (std::size_t i = 0; i < points.size(); ++i)
    {
      frame.moving_probability[i] = moving[i] ? 0.9F : 0.1F;
    }
  }
  past_.push_front(project(frame));
  if (static_cast<int>(past_.size()) > options_.history)
  {
    past_.pop_back();
  }
}
}  // namespace dyslam
