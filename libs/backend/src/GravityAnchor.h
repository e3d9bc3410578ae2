// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/FactorGraph.h>
#include <dyslam/backend/GravityOptions.h>
#include <dyslam/core/Gravity.h>
#include <dyslam/core/MotionSamples.h>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "objects/FrameInKeyframe.h"

namespace dyslam
{
/** Collects the accelerations of an IMU during a run, and finds the vertical from them at the end.
 *
 * An accelerometer measures the specific force: the acceleration of its place minus gravity. Over a
 * window of a few seconds the trajectory's own mean acceleration is subtracted; what is left is
 * gravity and the accelerometer's bias. Both means have the same smooth weights, which vanish at
 * the ends of the window: the acceleration is then a sum of small changes of velocity, weighted,
 * and errors of single poses cancel. */
class GravityAnchor
{
 public:
  explicit GravityAnchor(const GravityOptions& options) : options_(options) {}

  /** Adds the next frame, and what was recorded since the frame before. Accelerations count for the
   * two frames that they lie between in time, also if they were recorded sooner or later.
   * \param time time of the frame, by a clock that is never set [s] \param samples with stamps of
   * that clock \param T_previous_vehicle motion since the frame before */
  void add(double time, const std::vector<ImuSample>& samples, const Pose& T_previous_vehicle);

  /** Adds the vertical, the bias and their factors to the graph, with values that are optimal at
   * the graph's present poses. \param frames poses of the frames that were added \return whether
   * the accelerations could be used */
  bool addTo(FactorGraph& graph, const std::vector<FrameInKeyframe>& frames);
  static void removeFrom(FactorGraph& graph);
  /** Makes the vertical the least rotation with its tilt, see levellingOf(). No factor determines
   * its yaw, and an optimisation may leave it anywhere. */
  static void removeYaw(FactorGraph& graph);
  /** Whether the directions fit the graph. */
  [[nodiscard]] bool fits(const FactorGraph& graph) const;
  /** Result. \pre addTo() returned true, and the graph still has the factors that it added */
  [[nodiscard]] Gravity gravity(const FactorGraph& graph) const;
  /** Reasons why accelerations were not used, one line each. */
  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }
  void warn(const std::string& what) { warnings_.push_back(what); }
  [[nodiscard]] const GravityOptions& options() const { return options_; }

  void exchangeState(StateArchive& archive);

 private:
  /** What was measured between the frame before and a frame. */
  struct Interval
  {
    double end = 0;                                      //!< time of the frame [s]
    Eigen::Vector3d rotation = Eigen::Vector3d::Zero();  //!< since the frame before [rad]
    std::size_t samples = 0;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();  //!< specific forces, axes of the frame [m/s^2]
    Eigen::Vector3d imu = Eigen::Vector3d::Zero();  //!< position of the IMU, vehicle frame [m]

    /** Mean specific force, axes of the frame [m/s^2]. \pre samples > 0 */
    [[nodiscard]] Eigen::Vector3d mean() const { return sum / static_cast<double>(samples); }
  };
  /** Specific force without the vehicle's own acceleration: gravity's counterforce and bias. */
  struct Measured
  {
    std::size_t frame = 0;                              //!< in the middle of the window
    Eigen::Vector3d upwards = Eigen::Vector3d::Zero();  //!< axes of that frame [m/s^2]
  };

  /** Adds an acceleration to the interval of its time, if there is one. \pre it is not later than
   * the last frame */
  void addToInterval(const ImuSample& sample);
  /** Unit of the accelerations [m/s^2]: some drivers, such as Livox's, give them in multiples of
   * standard gravity. */
  [[nodiscard]] double unit() const;
  /** \param first, last frames of the window \return nothing if the window has gaps */
  [[nodiscard]] std::optional<Measured> measure(const FactorGraph& graph,
                                                const std::vector<FrameInKeyframe>& frames,
                                                std::size_t first,
                                                std::size_t last,
                                                double unit) const;
  [[nodiscard]] std::vector<Measured> measureAll(const FactorGraph& graph,
                                                 const std::vector<FrameInKeyframe>& frames) const;
  /** Least squares over all directions. */
  struct Solution
  {
    Eigen::Vector3d upwards;  //!< gravity's counterforce, map frame [m/s^2]
    Eigen::Vector3d bias;     //!< of the accelerometer, vehicle's axes [m/s^2]
    double tilt_sigma;        //!< [rad]
  };
  [[nodiscard]] Solution solve(const FactorGraph& graph,
                               const std::vector<FrameInKeyframe>& frames,
                               const std::vector<Measured>& all) const;
  /** Why so few directions were measured. */
  [[nodiscard]] std::string reasonForFew(std::size_t directions) const;
  [[nodiscard]] double rmse(const FactorGraph& graph) const;

  GravityOptions options_;
  std::vector<Interval> intervals_;  //!< one per frame
  std::vector<ImuSample> waiting_;   //!< accelerations later than the last frame
  double tilt_sigma_ = 0;            //!< of the vertical that addTo() found [rad]
  std::vector<std::string> warnings_;
};

/** T_level_map: the least rotation that makes `up_map` the z axis. \param up_map upwards in the map
 * frame, of any length */
[[nodiscard]] Pose levellingOf(const Eigen::Vector3d& up_map);
}  // namespace dyslam
