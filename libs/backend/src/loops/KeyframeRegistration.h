// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/NeighbourSearch.h>
#include <dyslam/core/Pose.h>
#include <dyslam/core/PoseGaussNewton.h>

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
struct KeyframeRegistrationOptions
{
  double coarse_distance = 3.0;  //!< largest distance of correspondences at the start [m]
  double fine_distance = 0.6;    //!< largest distance of correspondences at the end [m]
  int max_iterations = 30;
  int max_points = 2500;  //!< number of source points used, evenly picked
  int normal_neighbours = 10;
  double normal_radius = 1.5;       //!< radius of the neighbourhood of a normal [m]
  double loss_width = 0.2;          //!< width of the robust loss of point-to-plane distances [m]
  double noise_floor = 0.05;        //!< least standard deviation of a point-to-plane distance [m]
  double sigma_translation = 0.03;  //!< added sigma, since neighbouring points are correlated [m]
  double sigma_rotation = 0.002;    //!< added sigma of the rotation [rad]
};

struct KeyframeRegistrationResult
{
  Pose T_target_source = Pose::Identity();
  Matrix6 information = Matrix6::Identity();  //!< information over T_target_source's tangent
  bool converged = false;
  int iterations = 0;
  double overlap = 0;        //!< fraction of source points above ground with a correspondence
  double rmse = 0;           //!< RMS of the point-to-plane distances of correspondences [m]
  double observability = 0;  //!< ratio of weakest to strongest direction of translation, 0 to 1
};

/** A cloud that others are registered to. */
class RegistrationTarget
{
 public:
  RegistrationTarget(std::vector<Eigen::Vector3f> points,
                     const KeyframeRegistrationOptions& options);

  /** Registers `source` by point-to-plane Gauss-Newton with robust weights; the largest distance of
   * correspondences shrinks from coarse to fine. Not const: normals are computed when needed. */
  [[nodiscard]] KeyframeRegistrationResult align(const std::vector<Eigen::Vector3f>& source,
                                                 const Pose& T_target_source_initial);

  [[nodiscard]] const std::vector<Eigen::Vector3f>& points() const { return points_; }

 private:
  [[nodiscard]] double overlap(const std::vector<Eigen::Vector3f>& source,
                               const Pose& T_target_source) const;
  [[nodiscard]] const Eigen::Vector3f& normalAt(std::uint32_t index);
  /** Adds the point-to-plane residual of source point `p`, if it has a correspondence nearer than
   * `gate` [m]. */
  void addRow(const Eigen::Vector3d& p,
              const Pose& T_target_source,
              double gate,
              NormalEquations& sums);

  KeyframeRegistrationOptions options_;
  std::vector<Eigen::Vector3f> points_;
  std::vector<Eigen::Vector3f> normals_;  //!< per point; zero: no surface, NaN: not computed yet
  std::vector<Neighbour> neighbours_;     //!< buffer
  std::vector<Eigen::Vector3f> patch_;    //!< buffer
  KdTree tree_;
};

/** Best planar alignment of the source to the target seen from above, by counting overlapping
 * structure in a grid: heading within `heading_range` [rad] and position within `range` [m] of the
 * initial pose.
 * \return the best planar pose with the initial height, roll and pitch; nothing without overlap.
 */
[[nodiscard]] std::optional<Pose> correlateFromAbove(const std::vector<Eigen::Vector3f>& source,
                                                     const std::vector<Eigen::Vector3f>& target,
                                                     const Pose& T_target_source_initial,
                                                     double range,
                                                     double heading_range);
}  // namespace dyslam
