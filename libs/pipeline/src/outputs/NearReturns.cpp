// SPDX-License-Identifier: BSD-3-Clause
#include "NearReturns.h"

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
constexpr float cell_size = 0.5F;  // [m]

/** Labelled points of a cell, or of several. */
struct Votes
{
  std::size_t stationary = 0;
  std::size_t moving = 0;
  std::map<Label, std::size_t> of_label;  //!< moving ones

  void add(Label label, std::size_t points)
  {
    if (isMovingLabel(label))
    {
      moving += points;
      of_label[label] += points;
    }
    else
    {
      stationary += points;
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
  /** That of most points, 0 for static. */
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

/** The returns outside the cloud that are nearer than `nearest2`, by cell. */
std::vector<NearCell> nearCells(const std::vector<Eigen::Vector3f>& points,
                                const std::vector<bool>& in_cloud,
                                float nearest2)
{
  std::vector<NearCell> cells;
  std::unordered_map<std::uint64_t, std::size_t> index;
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    if (!in_cloud[i] && isReturn(points[i]) && points[i].squaredNorm() < nearest2)
    {
      const VoxelCell cell = voxelCell(points[i], 1 / cell_size);
      const auto [entry, added] = index.emplace(voxelKey(cell), cells.size());
      if (added)
      {
        cells.push_back({cell, {}});
      }
      cells[entry->second].points.push_back(static_cast<std::uint32_t>(i));
    }
  }
  return cells;
}
}  // namespace

void labelNearReturns(const Frame& frame, std::vector<Label>& labels)
{
  const std::vector<Eigen::Vector3f>& points = frame.scan.points;
  std::vector<bool> in_cloud(points.size(), false);
  float nearest2 = std::numeric_limits<float>::max();
  for (const std::uint32_t i : frame.cloud.source)
  {
    in_cloud[i] = true;
    nearest2 = std::min(nearest2, points[i].squaredNorm());
  }
  if (frame.cloud.source.empty())
  {
    return;
  }
  std::vector<NearCell> open = nearCells(points, in_cloud, nearest2);
  if (open.empty())
  {
    return;
  }
  VotesByCell votes;
  const float reach = std::sqrt(nearest2) + 4 * cell_size;  // beyond the cells next to near ones
  for (const std::uint32_t i : frame.cloud.source)
  {
    if (points[i].squaredNorm() < reach * reach)
    {
      votes[voxelKey(voxelCell(points[i], 1 / cell_size))].add(labels[i], 1);
    }
  }
  for (bool changed = true; changed;)
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
        labels[i] = label;
      }
    }
    changed = !decided.empty();
    open = std::move(left);
  }
}
}  // namespace dyslam
