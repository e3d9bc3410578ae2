// SPDX-License-Identifier: BSD-3-Clause
#include "IcpMatcher.h"

#include <dyslam/base/StateArchive.h>
#include <dyslam/core/PoseGaussNewton.h>
#include <dyslam/core/VoxelGrid.h>

namespace dyslam
{
namespace
{
/** Least planarity of a neighbourhood with a plane. */
constexpr float least_planarity = 0.2F;

void describeCorrespondences(IcpOptions& o, OptionsVisitor& v)
{
  v.real("sample_size", o.sample_size, 0.05, 10,
         "side of the cubes with one source point each [m]");
  v.real("reference_size", o.reference_size, 0.05, 10,
         "side of the cubes with one reference point each [m]");
  v.real("max_distance", o.max_distance, 0.01, 100,
         "largest distance of correspondences, at the first iterations [m]");
  v.real("end_distance", o.end_distance, 0.01, 100,
         "largest distance of correspondences, at the last iterations [m]");
}

void describeIterations(IcpOptions& o, OptionsVisitor& v)
{
  v.integer("max_iterations", o.max_iterations, 1, 500,
            "upper limit of the iterations of a registration");
  v.real("points_per_measurement", o.points_per_measurement, 1, 1e6,
         "number of correlated points that count as one measurement");
}
}  // namespace

void IcpOptions::describe(OptionsVisitor& v)
{
  describeCorrespondences(*this, v);
  v.real("loss_width", loss_width, 0.001, 10, "width of the robust loss of the residuals [m]");
  v.integer("neighbours", neighbours, 3, 100, "number of neighbours of a point for its normal");
  v.real("normal_radius", normal_radius, 0.01, 10,
         "radius of the neighbourhood of a point for its normal [m]");
  describeIterations(*this, v);
}

void IcpPointToPointOptions::describe(OptionsVisitor& v)
{
  describeCorrespondences(*this, v);
  describeIterations(*this, v);
}

std::string IcpMatcher::extract(const Frame& frame)
{
  dense_ = voxelDownsample(frame.cloud.points, options_.reference_size).points;
  const VoxelSample sample = voxelDownsample(frame.cloud.points, options_.sample_size);
  sample_ = sample.points;
  const std::vector<float> weights = pointWeights(frame);
  weights_.clear();
  if (!weights.empty())
  {
    for (const std::uint32_t i : sample.index)
    {
      weights_.push_back(weights[i]);
    }
  }
  return {};
}

MotionEstimate IcpMatcher::align(const Pose& T_reference_current_guess)
{
  const bool planes = residual_ == Residual::point_to_plane;
  const auto match =
      [&](std::size_t begin, std::size_t end, const Pose& T, double gate, NormalEquations& sums)
  {
    const Eigen::Matrix3d R = T.linear();
    Neighbour nearest;
    for (std::size_t i = begin; i < end; ++i)
    {
      const Eigen::Vector3d p = sample_[i].cast<double>();
      const Eigen::Vector3d q = T * p;
      if (!reference_.tree.nearest(q.cast<float>(), nearest, static_cast<float>(gate)))
      {
        continue;
      }
      const double own = weights_.empty() ? 1.0 : static_cast<double>(weights_[i]);
      if (planes)
      {
        const LocalShape& shape = reference_.shapes[nearest.index];
        if (!shape.valid() || shape.planarity() < least_planarity)
        {
          continue;
        }
        const Eigen::Vector3d n = shape.normal.cast<double>();
        const double r = n.dot(q - shape.mean.cast<double>());
        const double flat = static_cast<double>(shape.planarity());
        sums.addRow(n, p, R, r, own * flat * flat * gemanMcClureWeight(r * r, options_.loss_width));
      }
      else
      {
        const Eigen::Vector3d d = q - reference_.points[nearest.index].cast<double>();
        const double w = own * gemanMcClureWeight(d.squaredNorm(), gate);
        sums.addRow(Eigen::Vector3d::UnitX(), p, R, d.x(), w);
        sums.addRow(Eigen::Vector3d::UnitY(), p, R, d.y(), w);
        sums.addRow(Eigen::Vector3d::UnitZ(), p, R, d.z(), w);
      }
      ++sums.inliers;
    }
  };
  PoseGaussNewtonSettings settings;
  settings.max_iterations = options_.max_iterations;
  settings.start_gate = options_.max_distance;
  settings.end_gate = options_.end_distance;
  return toMotionEstimate(
      poseGaussNewton(sample_.size(), match, T_reference_current_guess, settings, pool_),
      options_.points_per_measurement);
}

void IcpMatcher::accept(const Pose& /*T_reference_current*/)
{
  reference_.points.swap(dense_);
  reference_.tree = KdTree(reference_.points);
  if (residual_ == Residual::point_to_plane)
  {
    reference_.shapes = estimateNormals(
        reference_.points, reference_.tree, static_cast<std::size_t>(options_.neighbours),
        static_cast<float>(options_.normal_radius), Eigen::Vector3f::Zero(), pool_);
  }
}

void IcpMatcher::exchangeReference(StateArchive& archive)
{
  archive(reference_.points, reference_.shapes);
  if (archive.isLoading())
  {
    reference_.tree = KdTree(reference_.points);
  }
}
}  // namespace dyslam
