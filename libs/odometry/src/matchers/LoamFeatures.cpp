// SPDX-License-Identifier: BSD-3-Clause
#include "LoamFeatures.h"

#include <dyslam/core/Rings.h>
#include <dyslam/core/ScanParts.h>
#include <dyslam/core/VoxelGrid.h>

#include <algorithm>
#include <cmath>

#include "ScanToScan.h"

namespace dyslam
{
namespace
{
constexpr std::size_t half_window = 5;
constexpr std::size_t sectors = 6;

/** One point of a ring, in order of azimuth. */
struct RingPoint
{
  float azimuth;
  std::uint32_t index;  //!< index in the cloud
};

/** Points of the cloud in the lidar frame, whose origin is the start of the beams. */
std::vector<Eigen::Vector3f> fromLidar(const Frame& frame)
{
  const Eigen::Isometry3f T_lidar_vehicle = frame.scan.T_vehicle_lidar.inverse().cast<float>();
  std::vector<Eigen::Vector3f> seen;
  seen.reserve(frame.cloud.size());
  for (const Eigen::Vector3f& p : frame.cloud.points)
  {
    seen.push_back(T_lidar_vehicle * p);
  }
  return seen;
}

/** Rings of the points that the scan's own lidar measured. */
std::vector<std::uint16_t> estimateOwnRings(const Scan& scan)
{
  return scan.parts.empty() ? estimateRings(scan.points) : estimateRings(ownScan(scan).points);
}

/** Rings of the cloud's first points, those of the scan's own lidar, or empty. */
std::vector<std::uint16_t> cloudRings(const Frame& frame, const std::vector<Eigen::Vector3f>& seen)
{
  const Cloud& cloud = frame.cloud;
  const bool traced = cloud.source.size() == cloud.size() && frame.scan.size() > 0;
  if (!traced)
  {
    return estimateRings(seen);
  }
  const std::vector<std::uint16_t> estimated = frame.scan.ring.size() == frame.scan.size()
                                                   ? std::vector<std::uint16_t>()
                                                   : estimateOwnRings(frame.scan);
  const std::vector<std::uint16_t>& all = estimated.empty() ? frame.scan.ring : estimated;
  const std::size_t own = ownPoints(frame.scan, cloud);
  std::vector<std::uint16_t> rings;
  rings.reserve(own);
  for (std::size_t i = 0; i < own; ++i)
  {
    if (cloud.source[i] >= all.size())
    {
      return {};
    }
    rings.push_back(all[cloud.source[i]]);
  }
  return rings;
}

std::vector<std::vector<RingPoint>> sortedRings(const std::vector<Eigen::Vector3f>& seen,
                                                const std::vector<std::uint16_t>& rings)
{
  std::vector<std::vector<RingPoint>> sorted;
  for (std::size_t i = 0; i < rings.size(); ++i)
  {
    const Eigen::Vector3f& q = seen[i];
    if (!isReturn(q))
    {
      continue;  // the curvature is divided by the range
    }
    sorted.resize(std::max<std::size_t>(sorted.size(), rings[i] + 1U));
    sorted[rings[i]].push_back({std::atan2(q.y(), q.x()), static_cast<std::uint32_t>(i)});
  }
  for (auto& ring : sorted)
  {
    std::sort(ring.begin(), ring.end(),
              [](const RingPoint& a, const RingPoint& b)
              { return a.azimuth < b.azimuth || (a.azimuth == b.azimuth && a.index < b.index); });
  }
  return sorted;
}

/** Works on one ring at a time. */
class RingFeatures
{
 public:
  RingFeatures(const Frame& frame,
               const std::vector<Eigen::Vector3f>& seen,
               const std::vector<float>& weights,
               const LoamOptions& options)
      : points_(frame.cloud.points), seen_(seen), weights_(weights), options_(options)
  {
  }

  void extract(const std::vector<RingPoint>& ring, std::uint16_t number, LoamFeatures& features)
  {
    const std::size_t n = ring.size();
    if (n < sectors * (2 * half_window + 1))
    {
      return;
    }
    measure(ring);
    for (std::size_t s = 0; s < sectors; ++s)
    {
      const std::size_t begin = half_window + (n - 2 * half_window) * s / sectors;
      const std::size_t end = half_window + (n - 2 * half_window) * (s + 1) / sectors;
      order_.clear();
      for (std::size_t i = begin; i < end; ++i)
      {
        order_.push_back(static_cast<std::uint32_t>(i));
      }
      std::sort(order_.begin(), order_.end(),
                [&](std::uint32_t a, std::uint32_t b) {
                  return curvature_[a] < curvature_[b] || (curvature_[a] == curvature_[b] && a < b);
                });
      pickEdges(ring, number, features);
      pickPlanes(ring, number, features);
    }
  }

 private:
  [[nodiscard]] LoamPoint feature(const RingPoint& point, std::uint16_t number) const
  {
    return {points_[point.index], number, weights_.empty() ? 1.0F : weights_[point.index]};
  }

  /** Curvatures, and which points must not be used. */
  void measure(const std::vector<RingPoint>& ring)
  {
    const std::size_t n = ring.size();
    curvature_.assign(n, 0);
    blocked_.assign(n, 0);
    edge_.assign(n, 0);
    const auto at = [&](std::size_t i) -> const Eigen::Vector3f& { return seen_[ring[i].index]; };
    for (std::size_t i = 0; i < n; ++i)
    {
      if (i < half_window || i + half_window >= n)
      {
        blocked_[i] = 1;
        continue;
      }
      Eigen::Vector3f sum = -2.0F * static_cast<float>(half_window) * at(i);
      for (std::size_t k = 1; k <= half_window; ++k)
      {
        sum += at(i - k) + at(i + k);
      }
      curvature_[i] = sum.norm() / (2.0F * static_cast<float>(half_window) * at(i).norm());
    }
    for (std::size_t i = half_window; i + half_window + 1 < n; ++i)
    {
      const float here = at(i).norm();
      const float next = at(i + 1).norm();
      const float before = at(i - 1).norm();
      // The edge of an occluded surface depends on the viewpoint.
      if (here - next > 0.03F * here)
      {
        std::fill_n(blocked_.begin() + static_cast<std::ptrdiff_t>(i - half_window),
                    half_window + 1, std::uint8_t{1});
      }
      else if (next - here > 0.03F * next)
      {
        std::fill_n(blocked_.begin() + static_cast<std::ptrdiff_t>(i + 1), half_window,
                    std::uint8_t{1});
      }
      // Surfaces nearly parallel to the beam.
      if (std::fabs(before - here) > 0.02F * here && std::fabs(next - here) > 0.02F * here)
      {
        blocked_[i] = 1;
      }
    }
  }

  void block(std::size_t i)
  {
    for (std::size_t k = i - half_window; k <= i + half_window; ++k)
    {
      blocked_[k] = 1;
    }
  }

  void pickEdges(const std::vector<RingPoint>& ring, std::uint16_t number, LoamFeatures& features)
  {
    int picked = 0;
    for (auto it = order_.rbegin(); it != order_.rend() && picked < options_.target_edges; ++it)
    {
      const std::uint32_t i = *it;
      if (static_cast<double>(curvature_[i]) < options_.edge_curvature)
      {
        break;
      }
      if (blocked_[i] != 0)
      {
        continue;
      }
      ++picked;
      if (picked <= options_.edges)
      {
        features.edges.push_back(feature(ring[i], number));
      }
      features.target_edges.push_back(feature(ring[i], number));
      edge_[i] = 1;
      block(i);
    }
  }

  void pickPlanes(const std::vector<RingPoint>& ring, std::uint16_t number, LoamFeatures& features)
  {
    int picked = 0;
    for (const std::uint32_t i : order_)
    {
      if (static_cast<double>(curvature_[i]) > options_.plane_curvature)
      {
        break;
      }
      if (edge_[i] == 0)
      {
        features.target_planes.push_back(feature(ring[i], number));
      }
      if (blocked_[i] == 0 && picked < options_.planes)
      {
        features.planes.push_back(feature(ring[i], number));
        block(i);
        ++picked;
      }
    }
  }

  const std::vector<Eigen::Vector3f>& points_;  // vehicle frame
  const std::vector<Eigen::Vector3f>& seen_;    // lidar frame
  const std::vector<float>& weights_;
  const LoamOptions& options_;
  std::vector<float> curvature_;
  std::vector<std::uint8_t> blocked_;
  std::vector<std::uint8_t> edge_;
  std::vector<std::uint32_t> order_;
};
}  // namespace

namespace
{
void describeScans(LoamOptions& o, OptionsVisitor& v)
{
  v.real("edge_curvature", o.edge_curvature, 0, 10, "least curvature of an edge point [1]");
  v.real("plane_curvature", o.plane_curvature, 0, 10, "largest curvature of a plane point [1]");
  v.integer("edges", o.edges, 1, 1000,
            "edge points (sharpest) per sixth of a ring that are registered");
  v.integer("target_edges", o.target_edges, 1, 1000,
            "edge points (sharpest) per sixth of a ring in the reference scan");
  v.integer("planes", o.planes, 1, 1000,
            "plane points (flattest) per sixth of a ring that are registered");
  v.real("plane_size", o.plane_size, 0.05, 10,
         "side of the cubes with one plane point each in the reference scan [m]");
  v.real("max_distance", o.max_distance, 0.01, 100,
         "largest distance of correspondences between scans, at the first iterations [m]");
  v.real("end_distance", o.end_distance, 0.01, 100,
         "largest distance of correspondences between scans, at the last iterations [m]");
  v.real("loss_width", o.loss_width, 0.001, 10, "width of the robust loss of the residuals [m]");
  v.integer("max_iterations", o.max_iterations, 1, 500,
            "upper limit of the iterations of a registration");
}

void describePrecision(LoamOptions& o, OptionsVisitor& v)
{
  v.real("points_per_measurement", o.points_per_measurement, 1, 1e6,
         "number of correlated points that count as one measurement");
}
}  // namespace

void LoamOptions::describe(OptionsVisitor& v)
{
  describeScans(*this, v);
  v.real("map_distance", map_distance, 0.01, 100,
         "largest distance of correspondences between scan and map [m]");
  v.real("map_edge_size", map_edge_size, 0.05, 10, "spacing of the map's edge points [m]");
  v.real("map_plane_size", map_plane_size, 0.05, 10, "spacing of the map's plane points [m]");
  v.real("map_radius", map_radius, 5, 1000, "distance beyond which map points are dropped [m]");
  describePrecision(*this, v);
}

void LoamNoMappingOptions::describe(OptionsVisitor& v)
{
  describeScans(*this, v);
  describePrecision(*this, v);
}

LoamFeatures loamFeatures(const Frame& frame, const LoamOptions& options)
{
  LoamFeatures features;
  const std::vector<Eigen::Vector3f> seen = fromLidar(frame);
  const std::vector<std::uint16_t> rings = cloudRings(frame, seen);
  if (rings.empty())
  {
    return features;
  }
  const std::vector<float> weights = pointWeights(frame);
  const auto sorted = sortedRings(seen, rings);
  RingFeatures extractor(frame, seen, weights, options);
  for (std::size_t r = 0; r < sorted.size(); ++r)
  {
    extractor.extract(sorted[r], static_cast<std::uint16_t>(r), features);
  }
  std::vector<Eigen::Vector3f> flat;
  flat.reserve(features.target_planes.size());
  for (const LoamPoint& point : features.target_planes)
  {
    flat.push_back(point.p);
  }
  std::vector<LoamPoint> thinned;
  for (const std::uint32_t i : voxelDownsample(flat, options.plane_size).index)
  {
    thinned.push_back(features.target_planes[i]);
  }
  features.target_planes.swap(thinned);
  return features;
}
}  // namespace dyslam
