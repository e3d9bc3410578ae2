// SPDX-License-Identifier: BSD-3-Clause
#include "NearReturns.h"

#include <dyslam/core/ScanParts.h>
#include <dyslam/core/VoxelGrid.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <unordered_map>
#include <utility>

namespace dyslam
{
namespace
{
constexpr float cell_size = 0.5F;  // side of a cell [m]

/** Number of labelled points of one or several cells. */
struct Votes
{
  std::size_t stationary = 0;
  std::size_t moving = 0;
  std::map<Label, std::size_t> of_label;  //!< number of moving points by label

  void add(Label label, std::size_t points)
  {
    if (!isMovingLabel(label))
    {
      stationary += points;
    }
    else
    {
      moving += points;
      of_label[label] += points;
    }
  }
  void add(const Votes& other)
  {
    stationary += other.stationary;
    moving += other.moving;
    for (const auto& [label, points] : other.of_label)
    {
      of_label[label] += points;
    }
  }
  [[nodiscard]] bool empty() const { return stationary + moving == 0; }
  /** Label of most points; 0: static. */
  [[nodiscard]] Label winner() const
  {
    if (moving <= stationary)
    {
      return 0;
    }
    return std::max_element(of_label.begin(), of_label.end(),
                            [](const auto& a, const auto& b) { return a.second < b.second; })
        ->first;
  }
};

struct NearCell
{
  VoxelCell cell;
  std::vector<std::uint32_t> points;
};

using VotesByCell = std::unordered_map<std::uint64_t, Votes>;

Votes votesAround(const VoxelCell& cell, const VotesByCell& votes)
{
  Votes sum;
  for (int dx = -1; dx <= 1; ++dx)
  {
    for (int dy = -1; dy <= 1; ++dy)
    {
      for (int dz = -1; dz <= 1; ++dz)
      {
        const auto found = votes.find(voxelKey({cell.x + dx, cell.y + dy, cell.z + dz}));
        if (found != votes.end())
        {
          sum.add(found->second);
        }
      }
    }
  }
  return sum;
}

/** Whether a point has a vote. Moving points without a reported object are less certain and have
 * none; nor have points of an object that only the second tracking reported. */
bool hasVote(const Frame& frame, std::size_t cloud_point, Label label)
{
  return !isMovingLabel(label) ||
         (frame.reported_before.empty() ? instanceOf(label) != 0
                                        : frame.reported_before[cloud_point]);
}

/** The points of one lidar in a frame. */
struct LidarPoints
{
  const std::vector<Eigen::Vector3f>& points;  //!< points of its scan, lidar's frame [m]
  std::size_t first = 0;                       //!< index of its first point in the scan
  std::size_t cloud_begin = 0;                 //!< index of its first point in the cloud
  std::size_t cloud_end = 0;
};

/** Votes of the lidar's points in the cloud that are nearer than `reach` [m]. */
VotesByCell votesOfCloud(const Frame& frame,
                         const LidarPoints& lidar,
                         const std::vector<Label>& labels,
                         float reach)
{
  VotesByCell votes;
  for (std::size_t i = lidar.cloud_begin; i < lidar.cloud_end; ++i)
  {
    const std::uint32_t source = frame.cloud.source[i];
    const Eigen::Vector3f& p = lidar.points[source - lidar.first];
    if (p.squaredNorm() < reach * reach && hasVote(frame, i, labels[source]))
    {
      votes[voxelKey(voxelCell(p, 1 / cell_size))].add(labels[source], 1);
    }
  }
  return votes;
}

/** The lidar's returns outside the cloud and nearer than all of its points there. */
std::vector<std::uint32_t> nearReturns(const Frame& frame, const LidarPoints& lidar, float& nearest)
{
  const std::vector<Eigen::Vector3f>& points = lidar.points;
  std::vector<bool> in_cloud(points.size(), false);
  float nearest2 = std::numeric_limits<float>::max();
  for (std::size_t k = lidar.cloud_begin; k < lidar.cloud_end; ++k)
  {
    const std::size_t i = frame.cloud.source[k] - lidar.first;
    in_cloud[i] = true;
    nearest2 = std::min(nearest2, points[i].squaredNorm());
  }
  std::vector<std::uint32_t> near;
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    if (!in_cloud[i] && isReturn(points[i]) && points[i].squaredNorm() < nearest2)
    {
      near.push_back(static_cast<std::uint32_t>(i));
    }
  }
  nearest = std::sqrt(nearest2);
  return near;
}

std::vector<NearCell> byCell(const std::vector<std::uint32_t>& returns,
                             const std::vector<Eigen::Vector3f>& points)
{
  std::vector<NearCell> cells;
  std::unordered_map<std::uint64_t, std::size_t> index;
  for (const std::uint32_t i : returns)
  {
    const VoxelCell cell = voxelCell(points[i], 1 / cell_size);
    const auto [entry, added] = index.emplace(voxelKey(cell), cells.size());
    if (added)
    {
      cells.push_back({cell, {}});
    }
    cells[entry->second].points.push_back(i);
  }
  return cells;
}

/** Labels the cells with votes in the cells around them. \param first index in the scan of the
 * lidar's first point \return the other cells */
std::vector<NearCell> labelNext(std::vector<NearCell> open,
                                std::size_t first,
                                VotesByCell& votes,
                                std::vector<Label>& labels)
{
  std::vector<NearCell> left;
  std::vector<std::pair<NearCell, Label>> decided;
  for (NearCell& cell : open)
  {
    const Votes around = votesAround(cell.cell, votes);
    if (around.empty())
    {
      left.push_back(std::move(cell));
    }
    else
    {
      decided.emplace_back(std::move(cell), around.winner());
    }
  }
  for (const auto& [cell, label] : decided)
  {
    votes[voxelKey(cell.cell)].add(label, cell.points.size());
    for (const std::uint32_t i : cell.points)
    {
      labels[first + i] = label;
    }
  }
  return left;
}

void labelNearReturnsOf(const LidarPoints& lidar, const Frame& frame, std::vector<Label>& labels)
{
  if (lidar.cloud_begin == lidar.cloud_end)
  {
    return;
  }
  float nearest = 0;
  const std::vector<std::uint32_t> near = nearReturns(frame, lidar, nearest);
  if (near.empty())
  {
    return;
  }
  // Up to the cells around those of near returns.
  VotesByCell votes = votesOfCloud(frame, lidar, labels, nearest + 4 * cell_size);
  std::vector<NearCell> open = byCell(near, lidar.points);
  for (std::size_t before = open.size() + 1; open.size() < before;)
  {
    before = open.size();
    open = labelNext(std::move(open), lidar.first, votes, labels);
  }
}
}  // namespace

void labelNearReturns(const Frame& frame, std::vector<Label>& labels)
{
  if (frame.cloud.source.empty())
  {
    return;
  }
  const std::vector<LidarRange> in_cloud = lidarRanges(frame.scan, frame.cloud);
  auto of_part = in_cloud.begin();
  forEachPart(
      frame.scan,
      [&](const Scan& part, const LidarRange& range)
      {
        labelNearReturnsOf({part.points, range.begin, of_part->begin, of_part->end}, frame, labels);
        ++of_part;
      });
}
}  // namespace dyslam
