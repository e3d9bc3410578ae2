// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>
#include <dyslam/core/Options.h>

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace dyslam
{
struct DetectorOptions : Options
{
  double ground_clearance = 0.2;      //!< lower points do not join clusters [m]
  double ground_cell = 2.0;           //!< of the local ground height map [m]
  double distance = 0.4;              //!< joins points near the sensor [m]
  double distance_per_range = 0.012;  //!< added per metre of range [m/m]
  double max_distance = 1.2;          //!< [m]
  int min_points = 6;                 //!< of a cluster
  double min_height = 0.3;            //!< of a cluster's points [m]
  double max_length = 20;             //!< of a cluster [m]
  double max_range = 80;              //!< [m]
  double yaw_step = 0.0262;           //!< of the L-shape search [rad]
  double position_sigma = 0.15;       //!< of a well seen box [m]
  double yaw_sigma = 0.15;            //!< of a well seen box [rad]

  void describe(OptionsVisitor& visitor) override;
};

/** Moving points to boxes: range-adaptive clustering of what stands above the local ground, an
 * L-shape fit to each cluster, a class by size.
 *
 * Deterministic and thread-safe: detect() is const.
 */
class Detector
{
 public:
  explicit Detector(const DetectorOptions& options = {});

  /** Reads the frame's cloud, moving and moving_probability, fills its detections. */
  void detect(Frame& frame) const;

  /** Boxes of the points that move, vehicle frame. \param moving as long as `points`, or empty
   * if nothing moves \param probability of moving, for the score; as long as `points`, or empty for
   * 1 */
  [[nodiscard]] std::vector<Detection> detect(const std::vector<Eigen::Vector3f>& points,
                                              const std::vector<bool>& moving,
                                              const std::vector<float>& probability) const;

 private:
  [[nodiscard]] std::vector<std::uint32_t> candidates(const std::vector<Eigen::Vector3f>& points,
                                                      const std::vector<bool>& moving) const;
  [[nodiscard]] std::vector<std::vector<std::uint32_t>> clusters(
      const std::vector<Eigen::Vector3f>& points, const std::vector<std::uint32_t>& chosen) const;

  DetectorOptions options_;
};

/** The upright rectangle whose sides the points lie closest to (Zhang et al., "Efficient L-shape
 * fitting for vehicle detection using laser scanners", 2017, closeness criterion), of the points'
 * full height. The yaw lies along the longer side, in (-pi/2, pi/2]. */
[[nodiscard]] Box fitLShape(const std::vector<Eigen::Vector3f>& points, double yaw_step);

/** Class by the visible size alone: what is seen may be less than there is. */
[[nodiscard]] ObjectClass guessClass(const Eigen::Vector3d& size);
/** Class by full size and speed [m/s]; keeps `guess` where the motion agrees. */
[[nodiscard]] ObjectClass refineClass(ObjectClass guess, const Eigen::Vector3d& size, double speed);

/** A box of at least `size` that keeps the sides of `seen` facing the sensor (at the origin) where
 * they are: what is hidden lies behind. */
[[nodiscard]] Box completedBox(const Box& seen, const Eigen::Vector3d& size);
}  // namespace dyslam
