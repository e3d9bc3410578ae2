// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/NeighbourSearch.h>
#include <dyslam/core/Normals.h>

#include "ScanToScan.h"

namespace dyslam
{
/** Ini section `[icp_po2pl]`. */
struct IcpOptions : Options
{
  double sample_size = 0.6;      //!< side of the cubes with one source point each [m]
  double reference_size = 0.25;  //!< side of the cubes with one reference point each [m]
  double max_distance = 1.5;   //!< largest distance of correspondences, at the first iterations [m]
  double end_distance = 0.4;   //!< largest distance of correspondences, at the last iterations [m]
  double loss_width = 0.1;     //!< width of the robust loss, point to plane only [m]
  int neighbours = 10;         //!< number of neighbours for a normal, point to plane only
  double normal_radius = 1.0;  //!< radius of the neighbourhood for a normal [m]
  int max_iterations = 40;
  double points_per_measurement = 50;  //!< number of points that count as one measurement

  void describe(OptionsVisitor& visitor) override;
};

/** Ini section `[icp_po2po]`. Point-to-point residuals include the spacing of the samples: each has
 * less information, and the robust loss is as wide as the largest distance of correspondences. */
struct IcpPointToPointOptions : IcpOptions
{
  IcpPointToPointOptions() { points_per_measurement = 5000; }

  void describe(OptionsVisitor& visitor) override;
};

/** Scan-to-scan ICP, point to point or point to plane, with exact nearest neighbours. */
class IcpMatcher final : public ScanToScan
{
 public:
  enum class Residual
  {
    point_to_point,
    point_to_plane
  };
  IcpMatcher(Residual residual, const IcpOptions& options, ThreadPool& pool)
      : residual_(residual), options_(options), pool_(pool)
  {
  }
  [[nodiscard]] std::string name() const override
  {
    return residual_ == Residual::point_to_point ? "icp_po2po" : "icp_po2pl";
  }

 protected:
  std::string extract(const Frame& frame) override;
  MotionEstimate align(const Pose& T_reference_current_guess) override;
  void accept(const Pose& T_reference_current) override;
  void exchangeReference(StateArchive& archive) override;

 private:
  struct Reference
  {
    std::vector<Eigen::Vector3f> points;
    std::vector<LocalShape> shapes;
    KdTree tree;
  };

  Residual residual_;
  IcpOptions options_;
  ThreadPool& pool_;
  std::vector<Eigen::Vector3f> dense_;   //!< points of the frame, as the next reference
  std::vector<Eigen::Vector3f> sample_;  //!< points of the frame that are registered
  std::vector<float> weights_;           //!< weights of sample_; empty: 1
  Reference reference_;
};
}  // namespace dyslam
