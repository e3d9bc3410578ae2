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
  double coarse_distance = 3.0;  //!< largest distance of correspondences at the start [m] ...
  double fine_distance = 0.6;    //!< ... and at the end
  int max_iterations = 30;
  int max_points = 2500;  //!< of the source that are used, evenly picked
  int normal_neighbours = 10;
  double normal_radius = 1.5;       //!< [m]
  double loss_width = 0.2;          //!< of the robust loss of point-to-plane distances [m]
  double noise_floor = 0.05;        //!< least standard deviation of a point-to-plane distance [m]
  double sigma_translation = 0.03;  //!< added, since neighbouring points are correlated [m]
  double sigma_rotation = 0.002;    //!< [rad]
};

struct KeyframeRegistrationResult
{
  Pose T_target_source = Pose::Identity();
  Matrix6 information = Matrix6::Identity();  //!< over the tangent of T_target_source
  bool converged = false;
  int iterations = 0;
  double overlap = 0;        //!< fraction of source points above ground with a correspondence
  double rmse = 0;           //!< of their point-to-plane distances [m]
  double observability = 0;  //!< weakest over strongest direction of translation, 0 to 1
};

/** A target cloud of registrations. */
class RegistrationTarget
{
 public:
  RegistrationTarget(std::vector<Eigen::Vector3f> points,
                     const KeyframeRegistrationOptions& options);

  /** Point-to-plane Gauss-Newton with robust weights; the correspondence distance shrinks from
   * coarse to fine. Not const: normals are computed where they are first needed. */
  [[nodiscard]] KeyframeRegistrationResult align(const std::vector<Eigen::Vector3f>& source,
                                                 const Pose& T_target_source_initial);

  [[nodiscard]] const std::vector<Eigen::Vector3f>& points() const { return points_; }

 private:
  [[nodiscard]] double overlap(const std::vector<Eigen::Vector3f>& source,
                               const Pose& T_target_source) const;
  [[nodiscard]] const Eigen::Vector3f& normalAt(std::uint32_t index);
  /** The point-to-plane residual of a source point, if it has a correspondence nearer than `gate`
   * [m]. */
  void addRow(const Eigen::Vector3d& p,
              const Pose& T_target_source,
              double gate,
              NormalEquations& sums);

  KeyframeRegistrationOptions options_;
  std::vector<Eigen::Vector3f> points_;
  std::vector<Eigen::Vector3f> normals_;  //!< zero where there is no surface, NaN: not yet known
  std::vector<Neighbour> neighbours_;     //!< scratch
  std::vector<Eigen::Vector3f> patch_;    //!< scratch
  KdTree tree_;
};

/** Best planar alignment of the source to the target seen from above, by counting overlapping
 * structure in a grid: heading within `heading_range` of the initial one, offset within `range` of
 * it.
 * \return the best planar pose with the initial height, roll and pitch; nothing without overlap.
 */
[[nodiscard]] std::optional<Pose> correlateFromAbove(const std::vector<Eigen::Vector3f>& source,
                                                     const std::vector<Eigen::Vector3f>& target,
                                                     const Pose& T_target_source_initial,
                                                     double range,
                                                     double heading_range);
}  // namespace dyslam
