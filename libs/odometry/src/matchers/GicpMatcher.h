// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/NeighbourSearch.h>

#include <memory>

#include "ScanToScan.h"

namespace dyslam
{
/** Ini section `[gicp]`. */
struct GicpOptions : Options
{
  double sample_size = 0.5;   //!< side of the cubes with one point each in both scans [m]
  double max_distance = 1.0;  //!< largest distance of correspondences [m]
  int neighbours = 20;        //!< number of neighbours for a covariance
  int max_iterations = 30;
  double points_per_measurement = 50;  //!< number of points that count as one measurement

  void describe(OptionsVisitor& visitor) override;
};

/** Generalised ICP by PCL, scan to scan. PCL supports no weights: points that are more likely
 * moving than static are left out. */
class GicpMatcher final : public ScanToScan
{
 public:
  GicpMatcher(const GicpOptions& options, ThreadPool& pool);
  ~GicpMatcher() override;
  [[nodiscard]] std::string name() const override { return "gicp"; }

 protected:
  std::string extract(const Frame& frame) override;
  MotionEstimate align(const Pose& T_reference_current_guess) override;
  void accept(const Pose& T_reference_current) override;
  void exchangeReference(StateArchive& archive) override;

 private:
  struct Pcl;
  /** Pose T with the information of point-to-plane rows there, since PCL gives none; registered
   * if there are enough of them. */
  MotionEstimate estimateAt(const Pose& T);

  GicpOptions options_;
  ThreadPool& pool_;
  std::vector<Eigen::Vector3f> points_;     //!< points of the frame
  std::vector<Eigen::Vector3f> reference_;  //!< points of the reference frame
  KdTree tree_;                             //!< search tree of reference_
  std::unique_ptr<Pcl> pcl_;
};
}  // namespace dyslam
