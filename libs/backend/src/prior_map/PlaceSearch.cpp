// SPDX-License-Identifier: BSD-3-Clause
#include "PlaceSearch.h"

#include <dyslam/base/Angle.h>
#include <dyslam/core/VoxelGrid.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <queue>
#include <tuple>
#include <utility>

namespace dyslam
{
namespace
{
constexpr double usual_cell_size = 1;         // [m]
constexpr std::size_t most_cells = 16000000;  // cells of a grid; larger maps get larger cells
constexpr float least_extent = 1;             // least vertical extent of structure in a cell [m]
constexpr std::size_t most_structure = 300;   // cells of the points that are compared
constexpr int headings = 180;                 // steps of two degrees
constexpr std::size_t most_places = 12;
constexpr double least_score = 0.75;          // least score of a place, relative to the best one
constexpr std::size_t most_divided = 500000;  // blocks that are divided before the search ends
constexpr double place_distance = 4;          // distance of different places [m]
constexpr int place_headings = 5;             // difference of heading of different places [steps]

struct Column
{
  float low = 0;
  float high = 0;
};

/** Centres of the cells whose points have some vertical extent, ordered by cell. */
std::vector<Eigen::Vector2f> uprightCells(const std::vector<Eigen::Vector3f>& points,
                                          double cell_size)
{
  const auto inverse = static_cast<float>(1 / cell_size);
  std::map<std::pair<std::int32_t, std::int32_t>, Column> columns;
  for (const Eigen::Vector3f& p : points)
  {
    if (p.allFinite())
    {
      const auto [column, is_new] =
          columns.emplace(std::make_pair(cellNumber(p.y() * inverse), cellNumber(p.x() * inverse)),
                          Column{p.z(), p.z()});
      if (!is_new)
      {
        column->second.low = std::min(column->second.low, p.z());
        column->second.high = std::max(column->second.high, p.z());
      }
    }
  }
  std::vector<Eigen::Vector2f> centres;
  for (const auto& [cell, column] : columns)
  {
    if (column.high - column.low > least_extent)
    {
      centres.emplace_back((static_cast<float>(cell.second) + 0.5F) / inverse,
                           (static_cast<float>(cell.first) + 0.5F) / inverse);
    }
  }
  return centres;
}

/** Horizontal extent. */
template <typename Point>
Eigen::AlignedBox2d extentOf(const std::vector<Point>& points)
{
  Eigen::AlignedBox2d extent;
  for (const Point& p : points)
  {
    if (p.allFinite())
    {
      extent.extend(p.template head<2>().template cast<double>());
    }
  }
  return extent;
}

double radiansOf(int heading)
{
  return 2 * M_PI * heading / headings;
}

int headingsBetween(int a, int b)
{
  const int difference = std::abs(a - b);
  return std::min(difference, headings - difference);
}
}  // namespace

bool PlaceSearch::Node::operator<(const Node& other) const
{
  return std::make_tuple(score, -level, -heading, -x, -y) <
         std::make_tuple(other.score, -other.level, -other.heading, -other.x, -other.y);
}

PlaceSearch::PlaceSearch(const std::vector<Eigen::Vector3f>& map)
{
  Eigen::AlignedBox2d extent = extentOf(map);
  if (extent.isEmpty())
  {
    return;
  }
  if (extent.volume() > most_cells * usual_cell_size * usual_cell_size)
  {
    // Stray points far from all others would coarsen the grid; they have no upright structure.
    const Eigen::AlignedBox2d structure = extentOf(uprightCells(map, usual_cell_size));
    extent = structure.isEmpty() ? extent : structure;
  }
  const Eigen::Vector2d size = extent.sizes();
  cell_size_ = std::max(usual_cell_size, std::sqrt(size.x() * size.y() / most_cells));
  const std::vector<Eigen::Vector2f> centres = uprightCells(map, cell_size_);
  origin_ = extent.min() - Eigen::Vector2d::Constant(cell_size_);
  width_ = static_cast<int>(size.x() / cell_size_) + 3;
  height_ = static_cast<int>(size.y() / cell_size_) + 3;
  Cells occupied;
  for (const Eigen::Vector2f& centre : centres)
  {
    occupied.emplace_back(((centre.cast<double>() - origin_) / cell_size_).cast<int>());
  }
  drawStructure(occupied);
}

void PlaceSearch::drawStructure(const Cells& occupied)
{
  const auto index = [this](int x, int y)
  {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(x);
  };
  std::vector<std::uint8_t>& finest = grids_[0];
  finest.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), 0);
  for (const Eigen::Vector2i& cell : occupied)
  {
    for (int y = std::max(0, cell.y() - 1); y <= std::min(height_ - 1, cell.y() + 1); ++y)
    {
      for (int x = std::max(0, cell.x() - 1); x <= std::min(width_ - 1, cell.x() + 1); ++x)
      {
        const bool is_centre = x == cell.x() && y == cell.y();
        finest[index(x, y)] =
            std::max(finest[index(x, y)], static_cast<std::uint8_t>(is_centre ? 2 : 1));
      }
    }
  }
  for (int level = 1; level < levels; ++level)
  {
    const int half = 1 << (level - 1);
    std::vector<std::uint8_t>& grid = grids_[static_cast<std::size_t>(level)];
    grid.resize(finest.size());
    for (int y = 0; y < height_; ++y)
    {
      for (int x = 0; x < width_; ++x)
      {
        grid[index(x, y)] =
            std::max({at(level - 1, x, y), at(level - 1, x + half, y), at(level - 1, x, y + half),
                      at(level - 1, x + half, y + half)});
      }
    }
  }
}

/** Positions before the first cell are bounded by the maximum of the whole block, which the first
 * cells have in part; none is lost, as a block there overlaps the grid by less than its size. */
std::uint8_t PlaceSearch::at(int level, int x, int y) const
{
  const int size = 1 << level;
  if (x >= width_ || y >= height_ || x <= -size || y <= -size)
  {
    return 0;
  }
  const auto column = static_cast<std::size_t>(std::max(x, 0));
  const auto row = static_cast<std::size_t>(std::max(y, 0));
  return grids_[static_cast<std::size_t>(level)][row * static_cast<std::size_t>(width_) + column];
}

int PlaceSearch::bound(const Cells& cells, int level, int x, int y) const
{
  int sum = 0;
  for (const Eigen::Vector2i& cell : cells)
  {
    sum += at(level, cell.x() + x, cell.y() + y);
  }
  return sum;
}

SimilarPlace PlaceSearch::placeOf(const Node& leaf, std::size_t cells) const
{
  SimilarPlace place;
  place.x = origin_.x() + cell_size_ * (leaf.x + 0.5);
  place.y = origin_.y() + cell_size_ * (leaf.y + 0.5);
  place.heading = radiansOf(leaf.heading);
  place.score = leaf.score / (2.0 * static_cast<double>(cells));
  return place;
}

PlaceSearch::Range PlaceSearch::rangeOf(const std::optional<SearchArea>& area) const
{
  Range range{{0, 0}, {width_, height_}};
  if (area)
  {
    const Eigen::Vector2d size(width_, height_);
    const auto inside = [&](const Eigen::Vector2d& corner) -> Eigen::Vector2i
    {
      const Eigen::Vector2d cell = ((corner - origin_) / cell_size_).array().floor();
      return cell.cwiseMax(Eigen::Vector2d::Zero()).cwiseMin(size).cast<int>();
    };
    const Eigen::Vector2d reach = Eigen::Vector2d::Constant(area->radius);
    range.begin = inside(area->centre - reach);
    range.end = inside(area->centre + reach + Eigen::Vector2d::Constant(cell_size_));
  }
  return range;
}

std::vector<PlaceSearch::Node> PlaceSearch::bestLeaves(const std::vector<Cells>& turned,
                                                       const Range& range) const
{
  std::priority_queue<Node> open;
  const auto add = [&](int level, int heading, int x, int y)
  {
    if (x < range.end.x() && y < range.end.y())
    {
      open.push(
          {bound(turned[static_cast<std::size_t>(heading)], level, x, y), level, heading, x, y});
    }
  };
  constexpr int coarsest = levels - 1;
  for (int heading = 0; heading < headings; ++heading)
  {
    for (int y = range.begin.y(); y < range.end.y(); y += 1 << coarsest)
    {
      for (int x = range.begin.x(); x < range.end.x(); x += 1 << coarsest)
      {
        add(coarsest, heading, x, y);
      }
    }
  }
  std::size_t divided = 0;
  std::vector<Node> found;
  while (!open.empty() && found.size() < most_places && divided < most_divided)
  {
    const Node node = open.top();
    open.pop();
    const double least = found.empty() ? 1 : least_score * found.front().score;
    if (node.score < least)
    {
      break;
    }
    if (node.level > 0)
    {
      ++divided;
      const int half = 1 << (node.level - 1);
      for (const auto& [dx, dy] : {std::pair(0, 0), {half, 0}, {0, half}, {half, half}})
      {
        add(node.level - 1, node.heading, node.x + dx, node.y + dy);
      }
      continue;
    }
    const bool is_new = std::none_of(
        found.begin(), found.end(),
        [&](const Node& other)
        {
          return headingsBetween(other.heading, node.heading) < place_headings &&
                 cell_size_ * std::hypot(other.x - node.x, other.y - node.y) < place_distance;
        });
    if (is_new)
    {
      found.push_back(node);
    }
  }
  return found;
}

std::vector<SimilarPlace> PlaceSearch::find(const std::vector<Eigen::Vector3f>& points,
                                            const std::optional<SearchArea>& area) const
{
  const std::vector<Eigen::Vector2f> structure = uprightCells(points, cell_size_);
  if (structure.empty() || width_ == 0)
  {
    return {};
  }
  const std::size_t step = (structure.size() - 1) / most_structure + 1;
  std::vector<Cells> turned(headings);
  for (int heading = 0; heading < headings; ++heading)
  {
    const Eigen::Rotation2Df turn(static_cast<float>(radiansOf(heading)));
    for (std::size_t i = 0; i < structure.size(); i += step)
    {
      const Eigen::Vector2f p = turn * structure[i] / static_cast<float>(cell_size_);
      turned[static_cast<std::size_t>(heading)].emplace_back(static_cast<int>(std::lround(p.x())),
                                                             static_cast<int>(std::lround(p.y())));
    }
  }
  std::vector<SimilarPlace> places;
  for (const Node& leaf : bestLeaves(turned, rangeOf(area)))
  {
    places.push_back(placeOf(leaf, turned.front().size()));
  }
  return places;
}
}  // namespace dyslam
