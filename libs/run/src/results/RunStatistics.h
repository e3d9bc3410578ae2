// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>
#include <dyslam/core/Trajectory.h>

#include <Eigen/Core>
#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace dyslam
{
class StateArchive;
struct MotionSensorOptions;

/** Counts why scans failed; reasons that differ only in their numbers are counted together. */
class Reasons
{
 public:
  struct Kind
  {
    std::size_t count = 0;
    std::string example;  //!< last reason of this kind
    FailureCause cause = FailureCause::estimation;
  };

  /** \param failed an estimate that found no motion */
  void add(const MotionEstimate& failed);
  [[nodiscard]] std::size_t total() const { return total_; }
  /** The most frequent kind; its count is 0 if there was none. */
  [[nodiscard]] Kind mostFrequent() const;
  void exchangeState(StateArchive& archive);

 private:
  std::map<std::string, Kind> kinds_;  //!< by the reason without its numbers
  std::size_t total_ = 0;
};

/** Where a vehicle sees the points of a cloud, from above. */
struct View
{
  /** Mean of the unit vectors to the points: near zero for a spinning lidar, whatever is around it.
   */
  Eigen::Vector2d direction = Eigen::Vector2d::Zero();
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  //!< mean of the points, vehicle frame [m]
  double spread = 0;                                 //!< RMS distance of the points from it [m]
  bool has_near = false;  //!< a share of the points is near the vehicle, as of lidars on it

  /** Whether another view is so different that a lidar at rest has not seen both. */
  [[nodiscard]] bool differsFrom(const View& other) const;
};

/** The views of the clouds of a run. */
struct Views
{
  /** View of the first cloud, or of the first one after it with more than twice its points: the
   * first may be empty or a part of a revolution. */
  View first;
  std::size_t first_points = 0;  //!< number of points of that cloud
  std::size_t shifted = 0;       //!< number of clouds since then whose view differs

  /** \param cloud points, vehicle frame [m] */
  void add(const std::vector<Eigen::Vector3f>& cloud);
};

/** Statistics of the frames of a run. */
struct RunStatistics
{
  void add(const Frame& frame);
  void exchangeState(StateArchive& archive);

  /** Duration from the start of the first scan to the end of the last one, assuming that a scan
   * lasts as long as the scans are apart [s]. */
  [[nodiscard]] double recordingTime() const;

  /** Ground truth in the map frame, aligned with the first pose of the trajectory. */
  [[nodiscard]] Trajectory referenceInMap(const Trajectory& trajectory) const;

  /** Warnings of a run without errors, one sentence each.
   * \param has_labels the run read labels of an earlier one (dyseg.labels) */
  [[nodiscard]] std::vector<std::string> warnings(bool has_labels) const;

  /** The warning that advises a second pass because of dense traffic; else empty. */
  [[nodiscard]] std::string secondPassAdvice(bool has_labels) const;

  /** The warning that the vehicle moved in another direction than x; empty if it did not. */
  [[nodiscard]] std::string directionWarning() const;

  /** The warning that the points seem to be in the frame of a map: the vehicle was at rest all the
   * time, but sees points elsewhere than at first; empty if it does not. */
  [[nodiscard]] std::string frameWarning() const;

  /** Why the result is unusable, if more than half of the scans could not be registered; else
   * empty.
   * \param ini path of the ini that was given, which may be the reason; empty: none
   * \param sensors options of the run: advises to do without the sensors that it used */
  [[nodiscard]] std::string failure(const std::string& ini,
                                    const MotionSensorOptions& sensors) const;

  /** That a run with failures did without deskewing, which may be the reason, and what to do; empty
   * if most scans were deskewed, or the verdict() is "usable". Also of scans whose points all have
   * the same time: these count as deskewed. */
  [[nodiscard]] std::string deskewingAdvice() const;

  /** How far the result can be trusted: "unusable" (there is a failure()), "doubtful" (more than a
   * fifth of the scans could not be registered, the local map was restarted, or there is a
   * frameWarning(); the warnings say so) or "usable". */
  [[nodiscard]] std::string verdict() const;

  std::size_t frames = 0;
  double first_time = 0;  //!< Frame::time() of the first frame [s]
  double last_time = 0;
  Reasons registration_failures;  //!< of frames whose motion was predicted, not measured
  std::size_t map_restarts = 0;  //!< number of restarts of the local map, after successive failures
  std::size_t unregistered_keyframes = 0;
  std::size_t not_settled = 0;  //!< registered frames whose iterations ended too early
  Reasons odometry_failures;
  bool has_imu = false;     //!< there are samples of an IMU
  bool has_wheels = false;  //!< there are samples of wheel odometry
  double path = 0;          //!< sum of the registered motions [m]
  double path_forward = 0;  //!< part of it along x of the vehicle [m]
  double path_left = 0;     //!< part of it along y of the vehicle [m]
  double farthest = 0;      //!< largest distance of a pose from the first one [m]
  double largest_turn = 0;  //!< largest angle of a pose to the first one [rad]
  Views views;
  std::size_t points = 0;         //!< number of points of all clouds
  std::size_t moving_points = 0;  //!< number of moving points, by the causal labels
  std::size_t detections = 0;     //!< number of detections in all scans
  std::size_t without_times = 0;  //!< number of clouds without times of their points
  std::size_t equal_times = 0;    //!< number of clouds whose points all have the same time
  Trajectory reference;           //!< ground truth as recorded

 private:
  // Warnings, each empty if there is no reason for it.
  /** odometry.method found no motion on too many scans. */
  [[nodiscard]] std::string odometryWarning() const;
  /** Too many scans could not be registered, but not so many that the result is unusable. */
  [[nodiscard]] std::string registrationWarning() const;
  /** The registration of too many scans ended before it converged. */
  [[nodiscard]] std::string settlingWarning() const;
  [[nodiscard]] std::string restartWarning() const;
  /** Keyframes could not be registered. */
  [[nodiscard]] std::string keyframeWarning() const;

  /** Whether registration failed on more than `share` of all scans. */
  [[nodiscard]] bool failedOnMoreThan(double share) const;
  /** Sentence "N of M scans could not be registered: `consequence`; most often because: ...". */
  [[nodiscard]] std::string registrationSentence(const std::string& consequence) const;
};
}  // namespace dyslam
