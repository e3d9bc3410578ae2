// SPDX-License-Identifier: BSD-3-Clause
#include "ScanSample.h"

#include <dyslam/core/Deskew.h>
#include <dyslam/core/ScanParts.h>
#include <dyslam/core/VoxelGrid.h>

#include <algorithm>

#include "matchers/ScanToScan.h"

namespace dyslam
{
namespace
{
constexpr std::size_t sample_chunk = 8192;
}  // namespace

void RawPoints::clear()
{
  points.clear();
  phase.clear();
  weight.clear();
  lidar.clear();
}

void RawPoints::deskewed(const Pose& T_sweep,
                         ThreadPool& pool,
                         std::vector<Eigen::Vector3f>& result) const
{
  result.resize(points.size());
  if (phase.empty())
  {
    std::copy(points.begin(), points.end(), result.begin());
    return;
  }
  const SweepMotion motion(T_sweep, 0);
  pool.forChunks(points.size(), sample_chunk,
                 [&](std::size_t begin, std::size_t end, std::size_t)
                 {
                   for (std::size_t i = begin; i < end; ++i)
                   {
                     result[i] = motion.toReference(points[i], phase[i]);
                   }
                 });
}

void RawPoints::rescalePhase(double unit)
{
  const float scale = phaseScale(phase_unit, unit);
  if (scale == 1.0F)
  {
    return;
  }
  for (float& p : phase)
  {
    p *= scale;
  }
  phase_unit = unit;
}

void ScanSample::selectAlongRings(const Frame& frame, double spacing)
{
  const Cloud& cloud = frame.cloud;
  const std::size_t count = cloud.size();
  const auto spacing2 = static_cast<float>(spacing * spacing);
  // Points may come ring by ring or firing by firing.
  const bool ringed =
      frame.scan.ring.size() == frame.scan.size() && cloud.source.size() == count && count > 0;
  last_of_ring_.clear();
  source.clear();
  source.reserve(count);
  for (std::size_t i = 0; i < count; ++i)
  {
    const Eigen::Vector3f& p = cloud.points[i];
    const std::size_t ring = ringed ? frame.scan.ring[cloud.source[i]] : 0;
    if (ring >= last_of_ring_.size())
    {
      last_of_ring_.resize(ring + 1, Eigen::Vector3f::Constant(1e9F));
    }
    Eigen::Vector3f& last = last_of_ring_[ring];
    const float d2 = (p - last).squaredNorm();
    if (d2 >= spacing2 && d2 < 1e30F)
    {
      last = p;
      source.push_back(static_cast<std::uint32_t>(i));
    }
  }
}

void ScanSample::assignLidars(const Frame& frame)
{
  scan.lidar.clear();
  if (frame.scan.parts.empty())
  {
    return;
  }
  const std::vector<LidarRange> ranges = lidarRanges(frame.scan, frame.cloud);
  scan.lidar.reserve(source.size());
  std::size_t lidar = 0;
  for (const std::uint32_t i : source)
  {
    while (i >= ranges[lidar].end)
    {
      ++lidar;
    }
    scan.lidar.push_back(static_cast<std::uint8_t>(lidar));
  }
}

void ScanSample::ingest(const Frame& frame, double spacing, ThreadPool& pool)
{
  selectAlongRings(frame, spacing);
  assignLidars(frame);
  const Cloud& cloud = frame.cloud;
  const std::size_t count = cloud.size();
  const bool skewed = cloud.phase.size() == count;
  scan_index_.resize(cloud.source.size() == count ? source.size() : 0);
  for (std::size_t i = 0; i < scan_index_.size(); ++i)
  {
    scan_index_[i] = cloud.source[source[i]];
  }
  scan.points.resize(source.size());
  scan.phase.resize(skewed ? source.size() : 0);
  scan.phase_unit = cloud.phase_unit;
  deskewed.resize(source.size());
  const SweepMotion motion(cloud.T_sweep, 0);
  pool.forChunks(source.size(), sample_chunk,
                 [&](std::size_t begin, std::size_t end, std::size_t)
                 {
                   for (std::size_t i = begin; i < end; ++i)
                   {
                     const std::uint32_t from = source[i];
                     const Eigen::Vector3f& p = cloud.points[from];
                     deskewed[i] = p;
                     scan.points[i] = p;
                     if (skewed)
                     {
                       scan.phase[i] = cloud.phase[from];
                       scan.points[i] = motion.toReference(p, -cloud.phase[from]);
                     }
                   }
                 });
  updateWeights(frame);
}

void ScanSample::updateWeights(const Frame& frame)
{
  const std::vector<float> weights = pointWeights(frame);
  scan.weight.resize(weights.empty() ? 0 : source.size());
  const std::vector<std::uint32_t>& cloud_source = frame.cloud.source;
  std::size_t at = 0;
  for (std::size_t i = 0; i < scan.weight.size(); ++i)
  {
    at = std::max<std::size_t>(at, source[i]);
    // Points that were inserted into the cloud since ingest() have shifted the others.
    while (i < scan_index_.size() && cloud_source.at(at) != scan_index_[i])
    {
      ++at;
    }
    scan.weight[i] = weights[at];
  }
}

void ScanSample::draw(double size, std::size_t max_points)
{
  const VoxelSample voxels = voxelDownsample(deskewed, size);
  const std::size_t count = voxels.index.size();
  const std::size_t taken = std::min(count, max_points);
  sample.points.resize(taken);
  sample_deskewed.resize(taken);
  sample.phase.resize(scan.phase.empty() ? 0 : taken);
  sample.phase_unit = scan.phase_unit;
  sample.weight.resize(scan.weight.empty() ? 0 : taken);
  sample.lidar.resize(scan.lidar.empty() ? 0 : taken);
  for (std::size_t i = 0; i < taken; ++i)
  {
    const std::uint32_t from = voxels.index[i * count / taken];
    sample.points[i] = scan.points[from];
    sample_deskewed[i] = deskewed[from];
    if (!scan.phase.empty())
    {
      sample.phase[i] = scan.phase[from];
    }
    if (!scan.weight.empty())
    {
      sample.weight[i] = scan.weight[from];
    }
    if (!scan.lidar.empty())
    {
      sample.lidar[i] = scan.lidar[from];
    }
  }
}
}  // namespace dyslam
