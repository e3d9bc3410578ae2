// SPDX-License-Identifier: BSD-3-Clause
#include "LocalMap.h"

#include <dyslam/base/StateArchive.h>
#include <dyslam/core/ScanPattern.h>

#include <algorithm>
#include <utility>

namespace dyslam
{
namespace
{
/** The map is cropped each time the vehicle has moved by this share of its radius. */
constexpr double crop_share = 0.1;
/** The smallest cells are no smaller than the rings are apart at this distance [m]; the largest
 * ones are as large as at more than twice of it. */
constexpr double single_ring_range = 17;
constexpr double several_rings_range = 37.5;
}  // namespace

LocalMap::LocalMap(const RefineOptions& options, ThreadPool& pool)
    : options_(options),
      pool_(pool),
      surfaces_(options.cell_size, options.levels, options.max_points_per_cell, pool)
{
}

void LocalMap::setResolution(const Scan& scan)
{
  ring_spacing_ = measureScanPattern(scan).spacing();
  cell_size_ = std::max(options_.cell_size, single_ring_range * ring_spacing_);
  levels_ = options_.levels > 0 ? options_.levels : 1;
  if (options_.levels == 0)
  {
    for (double size = cell_size_;
         levels_ < SurfacePyramid::max_levels && size < several_rings_range * ring_spacing_;
         size *= 2)
    {
      ++levels_;
    }
  }
}

void LocalMap::restart(const Scan& scan, ScanSample points, const Pose& T_odom_vehicle)
{
  wait();
  setResolution(scan);
  surfaces_.restart(cell_size_, levels_);
  scans_ = 0;
  points_ = std::move(points);
  first_ = FirstScan(points_.scan, T_odom_vehicle);
  addPoints(T_odom_vehicle);
}

void LocalMap::add(ScanSample points, const Pose& T_sweep, const Pose& T_odom_vehicle)
{
  wait();
  first_.clear();
  points_ = std::move(points);
  const auto job = [this, T_sweep, T_odom_vehicle]
  {
    points_.scan.deskewed(T_sweep, pool_, points_.deskewed);
    addPoints(T_odom_vehicle);
  };
  if (pool_.size() > 1)
  {
    adding_ = std::async(std::launch::async, job);
  }
  else
  {
    job();
  }
}

void LocalMap::addPoints(const Pose& T_odom_vehicle)
{
  surfaces_.add(points_.deskewed, points_.scan.weight, T_odom_vehicle);
  ++scans_;
  if ((T_odom_vehicle.translation() - cropped_at_).norm() > crop_share * options_.map_radius)
  {
    surfaces_.crop(T_odom_vehicle.translation(), options_.map_radius);
    cropped_at_ = T_odom_vehicle.translation();
  }
}

void LocalMap::deskewFirst(const Pose& T_sweep, double dt)
{
  wait();
  first_.setSweepDuration(dt);
  first_.fill(surfaces_, T_sweep, pool_);
}

ScanSample LocalMap::takeMemory()
{
  wait();
  return std::move(points_);
}

const SurfacePyramid& LocalMap::surfaces() const
{
  wait();
  return surfaces_;
}

SurfacePyramid LocalMap::emptySurfaces() const
{
  return {cell_size_, levels_, options_.max_points_per_cell, pool_};
}

int LocalMap::scans() const
{
  wait();
  return scans_;
}

void LocalMap::wait() const
{
  if (adding_.valid())
  {
    adding_.get();
  }
}

void LocalMap::exchangeState(StateArchive& archive)
{
  wait();
  archive(surfaces_, first_, cropped_at_, ring_spacing_, cell_size_, levels_, scans_);
}
}  // namespace dyslam
