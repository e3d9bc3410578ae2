// SPDX-License-Identifier: BSD-3-Clause
#include "SegmentShape.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cstddef>

namespace dyslam
{
namespace
{
/** Extent and horizontal spread of a segment's voxels. */
class SegmentSpread
{
 public:
  /** \param p a point of the voxel, odometry frame [m] */
  void add(const Eigen::Vector3f& p)
  {
    if (count_ == 0)
    {
      first_ = low_ = high_ = p;
    }
    low_ = low_.cwiseMin(p);
    high_ = high_.cwiseMax(p);
    const Eigen::Vector2d offset = (p - first_).head<2>().cast<double>();
    ++count_;
    sum_ += offset;
    squares_ += offset * offset.transpose();
  }

  [[nodiscard]] SegmentShape shape() const
  {
    const Eigen::Vector3f size = high_ - low_;
    const double n = std::max(count_, 1.0);
    const Eigen::Vector2d mean = sum_ / n;
    const Eigen::Matrix2d covariance = squares_ / n - mean * mean.transpose();
    // Points spread evenly over a length l have the variance l^2 / 12.
    const Eigen::Vector2d sides = (12 * Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>()
                                            .computeDirect(covariance, Eigen::EigenvaluesOnly)
                                            .eigenvalues()
                                            .cwiseMax(0))
                                      .cwiseSqrt();
    return {std::max(size.x(), size.y()), size.z(), static_cast<float>(sides[1]),
            static_cast<float>(sides[0])};
  }

 private:
  Eigen::Vector3f first_ = Eigen::Vector3f::Zero();  // origin of the offsets, against rounding
  Eigen::Vector3f low_ = Eigen::Vector3f::Zero();
  Eigen::Vector3f high_ = Eigen::Vector3f::Zero();
  double count_ = 0;
  Eigen::Vector2d sum_ = Eigen::Vector2d::Zero();
  Eigen::Matrix2d squares_ = Eigen::Matrix2d::Zero();
};
}  // namespace

std::vector<SegmentShape> segmentShapes(const Segments& segments,
                                        const std::vector<Eigen::Vector3f>& points)
{
  std::vector<SegmentSpread> spread(segments.segments);
  for (std::size_t v = 0; v < segments.first_point.size(); ++v)
  {
    spread[segments.segment_of_voxel[v]].add(points[segments.first_point[v]]);
  }
  std::vector<SegmentShape> shapes;
  shapes.reserve(spread.size());
  for (const SegmentSpread& of_voxels : spread)
  {
    shapes.push_back(of_voxels.shape());
  }
  return shapes;
}
}  // namespace dyslam
