// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Angle.h>
#include <dyslam/base/Options.h>
#include <dyslam/core/Frame.h>
#include <dyslam/tracking/MovingLabels.h>

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace dyslam
{
struct DetectorOptions : Options
{
  double ground_clearance = 0.2;         //!< points lower above the ground are not clustered [m]
  double hindsight_clearance = 0;        //!< the same beyond 12 m with MovingLabels::hindsight [m]
  double ground_cell = 2.0;              //!< cell size of the local ground height map [m]
  double cluster_gap = 0.4;              //!< largest gap within a cluster at range 0 [m]
  double cluster_gap_per_range = 0.012;  //!< increase of cluster_gap with range [m/m]
  double max_cluster_gap = 1.2;          //!< upper limit of the gap within a cluster [m]
  int min_points = 6;                    //!< least number of points of a cluster
  double min_height = 0.3;               //!< least height of a cluster [m]
  double max_length = 20;                //!< largest length of a cluster wider than 4 m [m]
  double max_narrow_length = 50;         //!< of a narrower one: trams, road trains [m]
  double max_range = 80;  //!< largest horizontal distance of points from the vehicle's origin [m]
  double yaw_step = 1.5 * radians_per_degree;  //!< step of the L-shape heading search [rad]
  double position_sigma = 0.15;  //!< sigma of the position of a box of many points [m]
  /** Sigma of the heading of a box of many points [rad]. */
  double yaw_sigma = 8.6 * radians_per_degree;

  void describe(OptionsVisitor& visitor) override;
};

/** Detects moving objects: range-adaptive Euclidean clustering of the moving points above the local
 * ground, an L-shape fit to each cluster and a class by size.
 *
 * With MovingLabels::hindsight also what a single ring of a sparse sensor hits, which is lower than
 * `min_height`: rows of points up to 6 m long, if no ray passes less than 0.7 m below them.
 *
 * Deterministic and thread-safe: detect() is const.
 */
class Detector
{
 public:
  /** \throws UserError if an option is out of range. */
  explicit Detector(const DetectorOptions& options = {},
                    MovingLabels labels = MovingLabels::causal);

  /** Reads the frame's cloud, moving, moving_by_prediction, moving_probability and the mounting of
   * its (first) lidar, sets its detections. */
  void detect(Frame& frame) const;

  /** \param points vehicle frame [m] \param moving as long as `points`, or empty if nothing moves
   * \param probability moving probability of each point, for the score; empty for 1
   * \param lidar position of the lidar in the vehicle frame [m]: ranges are from it, but for
   * max_range \return boxes in the vehicle frame. */
  [[nodiscard]] std::vector<Detection> detect(const std::vector<Eigen::Vector3f>& points,
                                              const std::vector<bool>& moving,
                                              const std::vector<float>& probability,
                                              const Eigen::Vector3f& lidar = {0, 0, 0}) const;

 private:
  [[nodiscard]] std::vector<std::uint32_t> selectMovingPoints(
      const std::vector<Eigen::Vector3f>& points,
      const std::vector<bool>& moving,
      const Eigen::Vector3f& lidar) const;
  /** Whether nearly all points of a cluster lie in two or more parts of the size of a person. */
  [[nodiscard]] bool arePersons(const std::vector<Eigen::Vector3f>& points,
                                const std::vector<std::vector<std::uint32_t>>& parts) const;
  /** The parts of a group of persons, which are half of the usual gap apart: of a cluster that is
   * longer than a person, smaller than a truck and lets rays through, if they are persons. Any
   * other cluster as it is. */
  [[nodiscard]] std::vector<std::vector<std::uint32_t>> splitGroup(
      const std::vector<Eigen::Vector3f>& points,
      std::vector<std::uint32_t> cluster,
      const Eigen::Vector3f& lidar) const;
  [[nodiscard]] Detection makeDetection(const Box& box,
                                        std::size_t point_count,
                                        double probability_sum) const;

  DetectorOptions options_;
  MovingLabels labels_;
};
}  // namespace dyslam
