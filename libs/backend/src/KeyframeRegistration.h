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
  double coarse_distance = 3.0;  //!< counterparts at most this far at first [m] ...
  double fine_distance = 0.6;    //!< ... and at last
  int max_iterations = 30;
  int max_points = 2500;  //!< of the source that are used, evenly picked
  int normal_neighbours = 10;
  double normal_radius = 1.5;       //!< [m]
  double loss_width = 0.2;          //!< of the robust loss of point-to-plane distances [m]
  double noise_floor = 0.05;        //!< least standard deviation of a point-to-plane distance [m]
  double sigma_translation = 0.03;  //!< added to the covariance: neighbouring points err alike [m]
  double sigma_rotation = 0.002;    //!< [rad]
};

struct KeyframeRegistrationResult
{
  Pose T_target_source = Pose::Identity();
  Matrix6 information = Matrix6::Identity();  //!< over the tangent of T_target_source
  bool converged = false;
  int iterations = 0;
  double overlap = 0;        //!< fraction of source points over the ground that have a counterpart
  double rmse = 0;           //!< of their point-to-plane distances [m]
  double observability = 0;  //!< weakest against strongest direction of translation, 0..1
};

/** A cloud made ready to register others to. */
class RegistrationTarget
{
 public:
  RegistrationTarget(std::vector<Eigen::Vector3f> points,
                     const KeyframeRegistrationOptions& options);

  /** Point-to-plane Gauss-Newton with robust weights; counterparts narrow from coarse to fine.
   * Not const: normals are computed where they are first needed. */
  [[nodiscard]] KeyframeRegistrationResult align(const std::vector<Eigen::Vector3f>& source,
                                                 const Pose& T_target_source_initial);

  [[nodiscard]] const std::vector<Eigen::Vector3f>& points() const { return points_; }

 private:
  [[nodiscard]] double overlap(const std::vector<Eigen::Vector3f>& source,
                               const Pose& T_target_source) const;
  [[nodiscard]] const Eigen::Vector3f& normalAt(std::uint32_t index);
  /** The point-to-plane row of a source point, if it has a counterpart nearer than `gate`. */
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

/** Where the source lies best over the target seen from above, by counting structure that meets in
 * a grid: heading within `heading_range` of the initial one, offset within `range` of it.
 * \return the best planar pose with the initial height, roll and pitch; nothing if nothing meets.
 */
[[nodiscard]] std::optional<Pose> correlateFromAbove(const std::vector<Eigen::Vector3f>& source,
                                                     const std::vector<Eigen::Vector3f>& target,
                                                     const Pose& T_target_source_initial,
                                                     double range,
                                                     double heading_range);
}  // namespace dyslam
