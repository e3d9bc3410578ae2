// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/StateArchive.h>
#include <dyslam/core/Deskew.h>
#include <dyslam/core/ScanParts.h>
#include <dyslam/dyseg/ResidualSegmenter.h>

#include <algorithm>
#include <cmath>

#include "MovingCells.h"

namespace dyslam
{
namespace
{
/** The range image covers the slopes from -0.6 to 0.6 in a whole number of rows; row 0 is at -0.6.
 */
constexpr double origin_slope = 0.6;
/** Slope beyond which returns are ignored. */
constexpr float steepest_slope = 2;
constexpr std::size_t chunk_size = 4096;

struct Direction
{
  int row = 0;
  int column = 0;
  float range = 0;
  bool steep = false;
};
}  // namespace

void ResidualSegmenterOptions::describe(OptionsVisitor& v)
{
  v.integer("history", history, 1, 100, "age of the oldest scan that is compared [scans]");
  v.integer("compared", compared, 1, 20,
            "number of earlier scans that each point is compared with");
  v.degrees("azimuth_bin_deg", azimuth_bin, 0.05, 5, "column width of the range images [deg]");
  v.real("slope_bin", slope_bin, 0.001, 0.1,
         "row height of the range images, as height per horizontal distance [m/m]");
  v.real("margin", margin, 0.01, 10,
         "least distance by which a moving point is nearer than the earlier range, at range 0 [m]");
  v.real("margin_per_range", margin_per_range, 0, 1, "increase of margin with range [m/m]");
  v.real("max_range", max_range, 1, 1000, "range beyond which points are static [m]");
  v.flag("open_sky", open_sky, "a ray without return above a point counts as free");
  v.real("ground_clearance", ground_clearance, 0, 2,
         "height above the lowest nearby point up to which points are ground [m]");
  v.real("cell_size", cell_size, 0.05, 5,
         "side of the cells in which moving votes are clustered to objects [m]");
  v.integer("min_points", min_points, 1, 1000,
            "least number of points with a moving vote in a moving object");
  v.real("min_share", min_share, 0, 1,
         "least fraction of a moving object's points with a moving vote");
}

namespace
{
const ResidualSegmenterOptions& validated(const ResidualSegmenterOptions& options)
{
  validate(options, "residual");
  constexpr double most_cells = 1000;  // largest number of cells up to max_range: limits memory
  if (options.max_range > most_cells * options.cell_size)
  {
    throw UserError("[residual] cell_size is too small; use at least max_range / 1000");
  }
  return options;
}
}  // namespace

ResidualSegmenter::ResidualSegmenter(const ResidualSegmenterOptions& options, ThreadPool& pool)
    : options_(validated(options)),
      pool_(pool),
      row_height_(
          static_cast<float>(2 * origin_slope / std::floor(2 * origin_slope / options.slope_bin))),
      columns_(static_cast<int>(2 * M_PI / options.azimuth_bin))
{
}

namespace
{
/** Row and column of a point by slope and azimuth; a point that is not finite counts as steep. */
Direction directionOf(const Eigen::Vector3f& p, float row_height, int columns)
{
  const SweepModel counter_clockwise{1, M_PI};
  Direction d;
  if (!p.allFinite())
  {
    d.steep = true;
    return d;
  }
  const float horizontal = std::sqrt(p.x() * p.x() + p.y() * p.y());
  const float slope =
      std::clamp(p.z() / std::max(horizontal, 1e-6F), -steepest_slope, steepest_slope);
  d.range = p.norm();
  d.column = static_cast<int>(sweepFraction(p, counter_clockwise) * static_cast<float>(columns));
  d.column = std::clamp(d.column, 0, columns - 1);
  d.row = static_cast<int>(std::floor((slope + static_cast<float>(origin_slope)) / row_height));
  d.steep = !(std::fabs(slope) < steepest_slope);
  return d;
}
}  // namespace

ResidualSegmenter::PastScan ResidualSegmenter::project(const Frame& frame) const
{
  PastScan past;
  for (const LidarRange& lidar : lidarRanges(frame.scan, frame.cloud))
  {
    past.push_back(project(frame.cloud.points.data() + lidar.begin, lidar.end - lidar.begin,
                           frame.T_odom_vehicle, lidar.T_vehicle_lidar));
  }
  return past;
}

ResidualSegmenter::PastImage ResidualSegmenter::project(const Eigen::Vector3f* points,
                                                        std::size_t count,
                                                        const Pose& T_odom_vehicle,
                                                        Pose T_vehicle_lidar) const
{
  PastImage past;
  if (T_vehicle_lidar.linear()(2, 2) < 0)  // mounted upside down: turned, as the sky is above
  {
    T_vehicle_lidar = T_vehicle_lidar * poseFromYpr(0, 0, 0, 0, 0, M_PI);
  }
  past.T_image_odom = (T_odom_vehicle * T_vehicle_lidar).inverse();
  const Eigen::Isometry3f T_image_vehicle = T_vehicle_lidar.inverse().cast<float>();
  std::vector<Direction> directions;
  directions.reserve(count);
  int highest = 0;
  for (std::size_t i = 0; i < count; ++i)
  {
    const Direction d = directionOf(T_image_vehicle * points[i], row_height_, columns_);
    if (!d.steep)
    {
      past.lowest_row = directions.empty() ? d.row : std::min(past.lowest_row, d.row);
      highest = directions.empty() ? d.row : std::max(highest, d.row);
      directions.push_back(d);
    }
  }
  if (directions.empty())
  {
    return past;
  }
  past.lowest_row -= 1;
  past.rows = highest - past.lowest_row + 2;
  past.range.assign(static_cast<std::size_t>(past.rows) * static_cast<std::size_t>(columns_), 0.0F);
  for (const Direction& d : directions)
  {
    float& seen =
        past.range[static_cast<std::size_t>((d.row - past.lowest_row) * columns_ + d.column)];
    seen = seen == 0 ? d.range : std::min(seen, d.range);
  }
  return past;
}

int ResidualSegmenter::vote(const PastImage& past, const Eigen::Vector3f& point) const
{
  const Direction d = directionOf(point, row_height_, columns_);
  const int row = d.row - past.lowest_row;
  if (d.steep || row < 1 || row >= past.rows - 1)
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
      const float range = past.range[static_cast<std::size_t>((row + up) * columns_ + column)];
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
  // Rays on only one side may have passed just over the edge of a static object.
  const bool open_above = options_.open_sky && row + 1 < past.rows - 2;
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

void ResidualSegmenter::addVotes(const PastScan& past,
                                 const Frame& frame,
                                 const std::vector<std::uint32_t>& candidates,
                                 std::vector<std::int8_t>& votes)
{
  std::vector<Eigen::Isometry3f> T_past_vehicle;
  for (const PastImage& lidar : past)
  {
    T_past_vehicle.push_back((lidar.T_image_odom * frame.T_odom_vehicle).cast<float>());
  }
  pool_.forChunks(candidates.size(), chunk_size,
                  [&](std::size_t begin, std::size_t end, std::size_t)
                  {
                    for (std::size_t i = begin; i < end; ++i)
                    {
                      const Eigen::Vector3f& p = frame.cloud.points[candidates[i]];
                      int seen = 0;
                      for (std::size_t k = 0; k < past.size() && seen >= 0; ++k)
                      {
                        const int by_lidar = vote(past[k], T_past_vehicle[k] * p);
                        seen = by_lidar < 0 ? by_lidar : std::max(seen, by_lidar);
                      }
                      votes[i] = static_cast<std::int8_t>(votes[i] + seen);
                    }
                  });
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
      addVotes(*past, frame, candidates, votes);
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

void ResidualSegmenter::exchangeState(StateArchive& archive)
{
  archive(past_);
}
}  // namespace dyslam
