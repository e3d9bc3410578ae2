// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/StateArchive.h>
#include <dyslam/core/ScanParts.h>
#include <dyslam/odometry/OwnVehicle.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace dyslam
{
namespace
{
constexpr float cell_size = 0.1F;       // side of a cell [m]
constexpr double least_distance = 0.3;  // least distance between the scans used [m]
constexpr double least_angle = 10 * M_PI / 180;
constexpr std::size_t most_observations = 20;
constexpr std::size_t least_observations = 8;
constexpr std::uint8_t known_scans = 60;
constexpr double own_share = 0.25;  // least share of scans with returns in a cell of the vehicle
constexpr double own_share_around = 0.5;  // and in the cell or beside it
}  // namespace

OwnVehicle::OwnVehicle(double range)
    : range_(static_cast<float>(range)),
      // One more cell on each side than the range needs, so that all cells have neighbours.
      side_(2 * static_cast<std::size_t>(std::ceil(range_ / cell_size)) + 2)
{
}

std::size_t OwnVehicle::cellOf(const Eigen::Vector3f& point) const
{
  const float middle = 0.5F * static_cast<float>(side_);
  const auto index = [&](float v) { return static_cast<std::size_t>(v / cell_size + middle); };
  return (index(point.z()) * side_ + index(point.y())) * side_ + index(point.x());
}

bool OwnVehicle::mayBeAt(const Eigen::Vector3f& point, std::size_t lidar) const
{
  return point.squaredNorm() < range_ * range_ &&
         (lidar >= lidars_.size() || lidars_[lidar].may_be.empty() ||
          lidars_[lidar].may_be[cellOf(point)]);
}

void OwnVehicle::addMotion(const Pose& T_previous_current)
{
  T_observed_current_ = T_observed_current_ * T_previous_current;
}

void OwnVehicle::observe(const Scan& scan)
{
  const Eigen::AngleAxisd turn(T_observed_current_.linear());
  if (range_ <= 0 || (any_observed_ && T_observed_current_.translation().norm() < least_distance &&
                      std::abs(turn.angle()) < least_angle))
  {
    return;
  }
  T_observed_current_.setIdentity();
  any_observed_ = true;
  forEachPart(scan,
              [this](const Scan& part, const LidarRange& range)
              {
                lidars_.resize(std::max(lidars_.size(), range.lidar + 1));
                observe(part.points, lidars_[range.lidar]);
              });
}

void OwnVehicle::observe(const std::vector<Eigen::Vector3f>& points, Places& places) const
{
  std::vector<std::uint32_t> cells;
  for (const Eigen::Vector3f& p : points)
  {
    if (isReturn(p) && p.squaredNorm() < range_ * range_)
    {
      cells.push_back(static_cast<std::uint32_t>(cellOf(p)));
    }
  }
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  places.observations.push_back(std::move(cells));
  if (places.observations.size() > most_observations)
  {
    places.observations.pop_front();
  }
  decide(places);
}

std::vector<std::uint32_t> OwnVehicle::constantCells(const Places& places) const
{
  const auto countOf = [&](double share)
  {
    return static_cast<std::size_t>(
        std::ceil(share * static_cast<double>(places.observations.size())));
  };
  const std::size_t least = countOf(own_share);
  std::vector<std::uint8_t> returns(side_ * side_ * side_, 0);         // scans with returns
  std::vector<std::uint8_t> returns_around(side_ * side_ * side_, 0);  // in a cell or beside it
  std::vector<std::uint8_t> last_scan(side_ * side_ * side_, 0);
  std::vector<std::uint32_t> often;
  std::uint8_t scan = 0;
  for (const auto& cells : places.observations)
  {
    ++scan;
    for (const std::uint32_t cell : cells)
    {
      if (++returns[cell] == least)
      {
        often.push_back(cell);
      }
      for (const std::size_t c : cellsAround(cell))
      {
        returns_around[c] = static_cast<std::uint8_t>(returns_around[c] + (last_scan[c] != scan));
        last_scan[c] = scan;
      }
    }
  }
  const std::size_t least_around = countOf(own_share_around);
  std::vector<std::uint32_t> constant;
  std::copy_if(often.begin(), often.end(), std::back_inserter(constant),
               [&](std::uint32_t cell) { return returns_around[cell] >= least_around; });
  return constant;
}

std::array<std::size_t, 27> OwnVehicle::cellsAround(std::uint32_t cell) const
{
  std::array<std::size_t, 27> around{};
  for (std::size_t n = 0; n < around.size(); ++n)
  {
    const std::size_t first = cell - (side_ + 1) * side_ - 1;
    around[n] = first + (n / 9 * side_ + n / 3 % 3) * side_ + n % 3;
  }
  return around;
}

std::vector<std::uint32_t> OwnVehicle::connectedWithKnown(const std::vector<std::uint32_t>& cells,
                                                          const Places& places) const
{
  std::vector<std::uint32_t> connected;
  std::vector<bool> is_left(places.known.size(), false);
  for (const std::uint32_t cell : cells)
  {
    const auto around = cellsAround(cell);
    if (std::any_of(around.begin(), around.end(),
                    [&](std::size_t c) { return places.known[c] > 0; }))
    {
      connected.push_back(cell);
    }
    else
    {
      is_left[cell] = true;
    }
  }
  for (std::size_t i = 0; i < connected.size(); ++i)
  {
    for (const std::size_t c : cellsAround(connected[i]))
    {
      if (is_left[c])
      {
        is_left[c] = false;
        connected.push_back(static_cast<std::uint32_t>(c));
      }
    }
  }
  return connected;
}

void OwnVehicle::decide(Places& places) const
{
  ++places.observed;
  places.may_be.clear();
  if (places.observations.size() < least_observations)
  {
    return;
  }
  places.may_be.assign(side_ * side_ * side_, false);
  places.known.resize(places.may_be.size(), 0);
  std::vector<std::uint32_t> own = constantCells(places);
  if (places.observed > most_observations)
  {
    own = connectedWithKnown(own, places);
  }
  for (std::uint8_t& scans : places.known)
  {
    scans = static_cast<std::uint8_t>(scans - (scans > 0 ? 1 : 0));
  }
  for (const std::uint32_t cell : own)
  {
    places.known[cell] = known_scans;
    for (const std::size_t c : cellsAround(cell))
    {
      places.may_be[c] = true;
    }
  }
}

void OwnVehicle::exchangeState(StateArchive& archive)
{
  archive(T_observed_current_, any_observed_, lidars_);
}
}  // namespace dyslam
