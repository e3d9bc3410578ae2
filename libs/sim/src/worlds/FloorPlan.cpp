// SPDX-License-Identifier: BSD-3-Clause
#include "FloorPlan.h"

#include <algorithm>
#include <cmath>

namespace dyslam::sim
{
namespace
{
constexpr float kFar = 2.5F;  // largest clearance that is measured [m]
constexpr std::uint8_t kBlocked = 0, kFree = 1, kReserved = 2;
}  // namespace

FloorPlan::FloorPlan(const Rect& extent, double cell)
    : extent_(extent),
      cell_(cell),
      nx_(static_cast<int>(std::ceil(extent.size().x() / cell))),
      ny_(static_cast<int>(std::ceil(extent.size().y() / cell))),
      cells_(static_cast<std::size_t>(nx_) * static_cast<std::size_t>(ny_), kBlocked)
{
}

FloorPlan::CellRange FloorPlan::cellsOf(const Rect& r) const
{
  const Eigen::Vector2d low = (r.low - extent_.low) / cell_, high = (r.high - extent_.low) / cell_;
  const auto x = [&](double v) { return std::clamp(static_cast<int>(std::lround(v)), 0, nx_); };
  const auto y = [&](double v) { return std::clamp(static_cast<int>(std::lround(v)), 0, ny_); };
  return {x(low.x()), y(low.y()), x(high.x()), y(high.y())};
}

void FloorPlan::free(const Rect& room)
{
  const CellRange r = cellsOf(room);
  for (int y = r.y0; y < r.y1; ++y)
  {
    for (int x = r.x0; x < r.x1; ++x)
    {
      cells_[at(x, y)] = std::max(cells_[at(x, y)], kFree);
    }
  }
}

void FloorPlan::block(const Rect& footprint)
{
  const CellRange r = cellsOf(footprint);
  for (int y = r.y0; y < r.y1; ++y)
  {
    for (int x = r.x0; x < r.x1; ++x)
    {
      cells_[at(x, y)] = kBlocked;
    }
  }
}

void FloorPlan::reserve(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double half_width)
{
  const CellRange r = cellsOf(Rect{a.cwiseMin(b), a.cwiseMax(b)}.grown(half_width));
  const Eigen::Vector2d d = b - a;
  for (int y = r.y0; y < r.y1; ++y)
  {
    for (int x = r.x0; x < r.x1; ++x)
    {
      const Eigen::Vector2d p = extent_.low + cell_ * Eigen::Vector2d(x + 0.5, y + 0.5);
      const double t = std::clamp((p - a).dot(d) / std::max(1e-9, d.squaredNorm()), 0.0, 1.0);
      if (cells_[at(x, y)] == kFree && (a + t * d - p).norm() < half_width)
      {
        cells_[at(x, y)] = kReserved;
      }
    }
  }
}

bool FloorPlan::available(const Rect& footprint) const
{
  const CellRange r = cellsOf(footprint);
  if (r.x0 >= r.x1 || r.y0 >= r.y1)
  {
    return false;
  }
  for (int y = r.y0; y < r.y1; ++y)
  {
    for (int x = r.x0; x < r.x1; ++x)
    {
      if (cells_[at(x, y)] != kFree)
      {
        return false;
      }
    }
  }
  return true;
}

// Chamfer distance: a forward and a backward pass over the grid.
void FloorPlan::measureClearance()
{
  clearance_.assign(cells_.size(), kFar);
  const auto straight = static_cast<float>(cell_), diagonal = static_cast<float>(1.41421 * cell_);
  const auto visit = [&](int x, int y, int step)
  {
    float& here = clearance_[at(x, y)];
    if (cells_[at(x, y)] == kBlocked)
    {
      here = 0;
      return;
    }
    const auto from = [&](int dx, int dy, float length)
    {
      const int u = x - step * dx, v = y - step * dy;
      here = std::min(here,
                      (u < 0 || v < 0 || u >= nx_ || v >= ny_ ? 0 : clearance_[at(u, v)]) + length);
    };
    from(1, 0, straight);
    from(0, 1, straight);
    from(1, 1, diagonal);
    from(-1, 1, diagonal);
  };
  for (int y = 0; y < ny_; ++y)
  {
    for (int x = 0; x < nx_; ++x)
    {
      visit(x, y, 1);
    }
  }
  for (int y = ny_ - 1; y >= 0; --y)
  {
    for (int x = nx_ - 1; x >= 0; --x)
    {
      visit(x, y, -1);
    }
  }
}

double FloorPlan::clearanceOfCell(int x, int y) const
{
  return x < 0 || y < 0 || x >= nx_ || y >= ny_ ? 0.0 : static_cast<double>(clearance_[at(x, y)]);
}

double FloorPlan::clearance(const Eigen::Vector2d& p) const
{
  const Eigen::Vector2d c = (p - extent_.low) / cell_;
  return clearanceOfCell(static_cast<int>(std::floor(c.x())), static_cast<int>(std::floor(c.y())));
}

Eigen::Vector2d FloorPlan::away(const Eigen::Vector2d& p) const
{
  const double h = 1.5 * cell_;
  const Eigen::Vector2d x(h, 0), y(0, h);
  const Eigen::Vector2d gradient(clearance(p + x) - clearance(p - x),
                                 clearance(p + y) - clearance(p - y));
  const double norm = gradient.norm();
  return norm < 0.2 * h ? Eigen::Vector2d::Zero() : Eigen::Vector2d(gradient / norm);
}

bool FloorPlan::isClear(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double distance) const
{
  const int steps = std::max(1, static_cast<int>(std::ceil((b - a).norm() / cell_)));
  for (int i = 0; i <= steps; ++i)
  {
    if (clearance(a + (b - a) * i / steps) < distance)
    {
      return false;
    }
  }
  return true;
}
}  // namespace dyslam::sim
