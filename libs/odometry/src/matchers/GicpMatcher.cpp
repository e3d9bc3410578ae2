// SPDX-License-Identifier: BSD-3-Clause
#include "GicpMatcher.h"

#include <dyslam/base/Printable.h>
#include <dyslam/base/StateArchive.h>
#include <dyslam/core/Normals.h>
#include <dyslam/core/PoseGaussNewton.h>
#include <dyslam/core/VoxelGrid.h>
#include <pcl/point_types.h>
#include <pcl/registration/gicp.h>

#include <algorithm>

namespace dyslam
{
namespace
{
using PclCloud = pcl::PointCloud<pcl::PointXYZ>;
/** Number of points that the information is computed from. */
constexpr std::size_t information_points = 3000;

PclCloud::Ptr toPcl(const std::vector<Eigen::Vector3f>& points)
{
  auto cloud = pcl::make_shared<PclCloud>();
  for (const Eigen::Vector3f& p : points)
  {
    cloud->push_back(pcl::PointXYZ(p.x(), p.y(), p.z()));
  }
  return cloud;
}
}  // namespace

void GicpOptions::describe(OptionsVisitor& v)
{
  v.real("sample_size", sample_size, 0.05, 10,
         "side of the cubes with one point each in both scans [m]");
  v.real("max_distance", max_distance, 0.01, 100, "largest distance of correspondences [m]");
  v.integer("neighbours", neighbours, 5, 100, "number of neighbours of a point for its covariance");
  v.integer("max_iterations", max_iterations, 1, 500,
            "upper limit of the iterations of a registration");
  v.real("points_per_measurement", points_per_measurement, 1, 1e6,
         "number of correlated points that count as one measurement");
}

struct GicpMatcher::Pcl
{
  PclCloud::Ptr source;
  PclCloud::Ptr target;
};

GicpMatcher::GicpMatcher(const GicpOptions& options, ThreadPool& pool)
    : options_(options), pool_(pool), pcl_(std::make_unique<Pcl>())
{
}
GicpMatcher::~GicpMatcher() = default;

std::string GicpMatcher::extract(const Frame& frame)
{
  const std::vector<float> weights = pointWeights(frame);
  const VoxelSample sample = voxelDownsample(frame.cloud.points, options_.sample_size);
  points_.clear();
  for (std::size_t i = 0; i < sample.index.size(); ++i)
  {
    if (weights.empty() || weights[sample.index[i]] >= 0.5F)
    {
      points_.push_back(sample.points[i]);
    }
  }
  pcl_->source = toPcl(points_);
  // PCL's GICP does not check that there are so many neighbours.
  const auto needed = static_cast<std::size_t>(options_.neighbours) + 1;
  if (points_.size() < needed)
  {
    return "only " + counted(points_.size(), "point") + (points_.size() == 1 ? " is" : " are") +
           " left after thinning";
  }
  return {};
}

MotionEstimate GicpMatcher::align(const Pose& T_reference_current_guess)
{
  pcl::GeneralizedIterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ> gicp;
  gicp.setMaximumIterations(options_.max_iterations);
  gicp.setMaxCorrespondenceDistance(options_.max_distance);
  gicp.setCorrespondenceRandomness(options_.neighbours);
  gicp.setInputSource(pcl_->source);
  gicp.setInputTarget(pcl_->target);
  PclCloud moved;
  try
  {
    gicp.align(moved, T_reference_current_guess.matrix().cast<float>());
  }
  catch (const pcl::PCLException& e)
  {
    MotionEstimate failed;
    failed.information.setZero();
    failed.reason = std::string("PCL: ") + e.what();
    return failed;
  }
  Pose T;
  T.matrix() = gicp.getFinalTransformation().cast<double>();
  T = orthonormalised(T);

  MotionEstimate estimate = estimateAt(T);
  if (estimate.registered() && !(gicp.hasConverged() && T.matrix().allFinite()))
  {
    estimate.status = MotionStatus::not_found;
    estimate.reason = "PCL did not converge";
  }
  return estimate;
}

MotionEstimate GicpMatcher::estimateAt(const Pose& T)
{
  const std::size_t step = std::max<std::size_t>(1, points_.size() / information_points);
  const auto match =
      [&](std::size_t begin, std::size_t end, const Pose& at, double gate, NormalEquations& sums)
  {
    std::vector<Neighbour> neighbours;
    std::vector<Eigen::Vector3f> patch;
    for (std::size_t k = begin; k < end; ++k)
    {
      const Eigen::Vector3f& p = points_[k * step];
      const Eigen::Vector3f q = (at * p.cast<double>()).cast<float>();
      tree_.nearest(q, 8, neighbours, static_cast<float>(gate));
      patch.clear();
      for (const Neighbour& n : neighbours)
      {
        patch.push_back(reference_[n.index]);
      }
      const LocalShape shape = fitLocalShape(patch, Eigen::Vector3f::Zero());
      if (!shape.valid() || shape.planarity() < 0.2F)
      {
        continue;
      }
      const double r = static_cast<double>(shape.normal.dot(q - shape.mean));
      sums.addRow(shape.normal.cast<double>(), p.cast<double>(), at.linear(), r,
                  gemanMcClureWeight(r * r, 0.1) * static_cast<double>(shape.planarity()));
      ++sums.inliers;
    }
  };
  PoseGaussNewtonSettings settings;
  settings.max_iterations = 1;
  settings.start_gate = settings.end_gate = options_.max_distance;
  MotionEstimate estimate =
      toMotionEstimate(poseGaussNewton(points_.size() / step, match, T, settings, pool_),
                       options_.points_per_measurement / static_cast<double>(step));
  estimate.T_previous_current = T;
  estimate.status =
      estimate.inliers >= settings.min_inliers ? MotionStatus::converged : MotionStatus::not_found;
  if (estimate.registered())
  {
    estimate.reason.clear();
  }
  return estimate;
}

void GicpMatcher::accept(const Pose& /*T_reference_current*/)
{
  pcl_->target = pcl_->source;
  reference_ = points_;
  tree_ = KdTree(reference_);
}

void GicpMatcher::exchangeReference(StateArchive& archive)
{
  bool is_there = pcl_->target != nullptr;
  archive(reference_, is_there);
  if (archive.isLoading())
  {
    tree_ = KdTree(reference_);
    pcl_->target = is_there ? toPcl(reference_) : nullptr;
  }
}
}  // namespace dyslam
