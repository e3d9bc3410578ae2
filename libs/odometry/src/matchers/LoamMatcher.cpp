// SPDX-License-Identifier: BSD-3-Clause
#include "LoamMatcher.h"

#include <dyslam/base/StateArchive.h>
#include <dyslam/core/Normals.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <cstdlib>

namespace dyslam
{
namespace
{
constexpr std::size_t fewest_features = 30;
constexpr int ring_reach = 2;

/** A line: a point and its direction. */
struct Line
{
  Eigen::Vector3d at;
  Eigen::Vector3d direction;
};

bool near(std::uint16_t a, std::uint16_t b)
{
  return std::abs(static_cast<int>(a) - static_cast<int>(b)) <= ring_reach;
}

void addRowToLine(const Line& line,
                  const Eigen::Vector3d& p,
                  const Pose& T,
                  double w,
                  double loss_width,
                  NormalEquations& sums)
{
  const Eigen::Vector3d d = T * p - line.at;
  const Eigen::Vector3d off = d - line.direction * line.direction.dot(d);
  const double r = off.norm();
  // On the line any normal is suitable, as the residual is 0.
  const Eigen::Vector3d n = r > 1e-6 ? Eigen::Vector3d(off / r) : line.direction.unitOrthogonal();
  sums.addRow(n, p, T.linear(), r, w * gemanMcClureWeight(r * r, loss_width));
  ++sums.inliers;
}

void addRowToPlane(const Eigen::Vector3d& at,
                   const Eigen::Vector3d& n,
                   const Eigen::Vector3d& p,
                   const Pose& T,
                   double w,
                   double loss_width,
                   NormalEquations& sums)
{
  const double r = n.dot(T * p - at);
  sums.addRow(n, p, T.linear(), r, w * gemanMcClureWeight(r * r, loss_width));
  ++sums.inliers;
}
}  // namespace

void LoamMatcher::Target::set(const std::vector<LoamPoint>& features)
{
  points.clear();
  rings.clear();
  for (const LoamPoint& feature : features)
  {
    points.push_back(feature.p);
    rings.push_back(feature.ring);
  }
  tree = KdTree(points);
}

void LoamMatcher::FeatureMap::add(const std::vector<LoamPoint>& features,
                                  const Pose& T,
                                  double size,
                                  double radius)
{
  const Eigen::Vector3f centre = T.translation().cast<float>();
  const auto radius2 = static_cast<float>(radius * radius);
  std::vector<Eigen::Vector3f> all;
  all.reserve(target.points.size() + features.size());
  for (const Eigen::Vector3f& p : target.points)
  {
    if ((p - centre).squaredNorm() <= radius2)
    {
      all.push_back(p);
    }
  }
  for (const LoamPoint& feature : features)
  {
    if (feature.weight >= 0.5F)
    {
      all.emplace_back((T * feature.p.cast<double>()).cast<float>());
    }
  }
  target.points = voxelDownsample(all, size).points;
  target.tree = KdTree(target.points);
}

std::string LoamMatcher::extract(const Frame& frame)
{
  features_ = loamFeatures(frame, options_);
  const std::size_t count = features_.edges.size() + features_.planes.size();
  if (count < fewest_features)
  {
    return "only " + std::to_string(count) + " edge and plane points found along the rings";
  }
  return {};
}

MotionEstimate LoamMatcher::alignFeatures(const RowMatcher& match,
                                          const Pose& T_guess,
                                          double start_gate,
                                          double end_gate)
{
  PoseGaussNewtonSettings settings;
  settings.max_iterations = options_.max_iterations;
  settings.start_gate = start_gate;
  settings.end_gate = end_gate;
  const std::size_t count = features_.edges.size() + features_.planes.size();
  return toMotionEstimate(poseGaussNewton(count, match, T_guess, settings, pool_),
                          options_.points_per_measurement);
}

void LoamMatcher::addEdgeRow(const LoamPoint& f,
                             const Pose& T,
                             double gate,
                             NormalEquations& sums,
                             std::vector<Neighbour>& found) const
{
  const Eigen::Vector3d p = f.p.cast<double>();
  edges_.tree.nearest((T * p).cast<float>(), 6, found, static_cast<float>(gate));
  for (std::size_t k = 1; k < found.size(); ++k)
  {
    const std::uint16_t ring = edges_.rings[found[0].index];
    const std::uint16_t other = edges_.rings[found[k].index];
    if (other == ring || !near(ring, other))
    {
      continue;
    }
    const Eigen::Vector3d a = edges_.points[found[0].index].cast<double>();
    const Eigen::Vector3d b = edges_.points[found[k].index].cast<double>();
    if ((b - a).norm() > 1e-3)
    {
      addRowToLine({a, (b - a).normalized()}, p, T, static_cast<double>(f.weight),
                   options_.loss_width, sums);
    }
    return;
  }
}

void LoamMatcher::addPlaneRow(const LoamPoint& f,
                              const Pose& T,
                              double gate,
                              NormalEquations& sums,
                              std::vector<Neighbour>& found) const
{
  const Eigen::Vector3d p = f.p.cast<double>();
  planes_.tree.nearest((T * p).cast<float>(), 10, found, static_cast<float>(gate));
  if (found.size() < 3)
  {
    return;
  }
  const std::uint16_t ring = planes_.rings[found[0].index];
  std::size_t same = 0;
  std::size_t other = 0;
  for (std::size_t k = 1; k < found.size() && (same == 0 || other == 0); ++k)
  {
    const std::uint16_t r = planes_.rings[found[k].index];
    std::size_t& slot = r == ring ? same : other;
    slot = slot == 0 && near(r, ring) ? k : slot;
  }
  if (same == 0 || other == 0)
  {
    return;
  }
  const Eigen::Vector3d a = planes_.points[found[0].index].cast<double>();
  const Eigen::Vector3d b = planes_.points[found[same].index].cast<double>();
  const Eigen::Vector3d c = planes_.points[found[other].index].cast<double>();
  const Eigen::Vector3d n = (b - a).cross(c - a);
  const double area = n.norm();
  if (area > 0.1 * (b - a).norm() * (c - a).norm())
  {
    addRowToPlane(a, n / area, p, T, static_cast<double>(f.weight), options_.loss_width, sums);
  }
}

MotionEstimate LoamMatcher::toScan(const Pose& T_guess)
{
  const std::size_t edge_count = features_.edges.size();
  const auto match =
      [&](std::size_t begin, std::size_t end, const Pose& T, double gate, NormalEquations& sums)
  {
    std::vector<Neighbour> found;
    for (std::size_t i = begin; i < end; ++i)
    {
      if (i < edge_count)
      {
        addEdgeRow(features_.edges[i], T, gate, sums, found);
      }
      else
      {
        addPlaneRow(features_.planes[i - edge_count], T, gate, sums, found);
      }
    }
  };
  return alignFeatures(match, T_guess, options_.max_distance, options_.end_distance);
}

MotionEstimate LoamMatcher::toMap(const Pose& T_guess)
{
  const std::size_t edge_count = features_.edges.size();
  const auto match =
      [&](std::size_t begin, std::size_t end, const Pose& T, double gate, NormalEquations& sums)
  {
    std::vector<Neighbour> found;
    std::vector<Eigen::Vector3f> patch;
    for (std::size_t i = begin; i < end; ++i)
    {
      const bool on_edge = i < edge_count;
      const LoamPoint& f = on_edge ? features_.edges[i] : features_.planes[i - edge_count];
      const Target& target = on_edge ? edge_map_.target : plane_map_.target;
      const Eigen::Vector3d p = f.p.cast<double>();
      const Eigen::Vector3f q = (T * p).cast<float>();
      target.tree.nearest(q, 5, found, static_cast<float>(gate));
      if (found.size() < 5)
      {
        continue;
      }
      patch.clear();
      for (const Neighbour& n : found)
      {
        patch.push_back(target.points[n.index]);
      }
      const LocalShape shape = fitLocalShape(patch, Eigen::Vector3f::Zero());
      const auto w = static_cast<double>(f.weight);
      if (on_edge && shape.spread.z() > 3 * shape.spread.y())
      {
        const Eigen::Vector3f along = patch.back() - patch.front();
        Eigen::Vector3f direction = Eigen::Vector3f::Zero();
        for (const Eigen::Vector3f& x : patch)
        {
          const Eigen::Vector3f d = x - shape.mean;
          direction += d.dot(along) < 0 ? Eigen::Vector3f(-d) : d;
        }
        if (direction.norm() > 1e-3F)
        {
          addRowToLine({shape.mean.cast<double>(), direction.normalized().cast<double>()}, p, T, w,
                       options_.loss_width, sums);
        }
      }
      else if (!on_edge && shape.valid() && shape.spread.x() < 0.05F &&
               shape.spread.y() > 3 * shape.spread.x())
      {
        addRowToPlane(shape.mean.cast<double>(), shape.normal.cast<double>(), p, T, w,
                      options_.loss_width, sums);
      }
    }
  };
  return alignFeatures(match, T_guess, options_.map_distance, options_.map_distance);
}

MotionEstimate LoamMatcher::align(const Pose& T_reference_current_guess)
{
  MotionEstimate estimate = toScan(T_reference_current_guess);
  if (!mapping_)
  {
    return estimate;
  }
  const Pose start =
      estimate.registered() ? estimate.T_previous_current : T_reference_current_guess;
  MotionEstimate mapped = toMap(T_map_reference_ * start);
  if (!mapped.registered())
  {
    return estimate;
  }
  mapped.T_previous_current =
      orthonormalised(T_map_reference_.inverse() * mapped.T_previous_current);
  mapped.iterations += estimate.iterations;
  return mapped;
}

void LoamMatcher::accept(const Pose& T_reference_current)
{
  edges_.set(features_.target_edges);
  planes_.set(features_.target_planes);
  if (mapping_)
  {
    T_map_reference_ = orthonormalised(T_map_reference_ * T_reference_current);
    edge_map_.add(features_.target_edges, T_map_reference_, options_.map_edge_size,
                  options_.map_radius);
    plane_map_.add(features_.target_planes, T_map_reference_, options_.map_plane_size,
                   options_.map_radius);
  }
}

void LoamMatcher::Target::exchangeState(StateArchive& archive)
{
  archive(points, rings);
  if (archive.isLoading())
  {
    tree = KdTree(points);
  }
}

void LoamMatcher::exchangeReference(StateArchive& archive)
{
  archive(edges_, planes_, edge_map_.target, plane_map_.target, T_map_reference_);
}
}  // namespace dyslam
