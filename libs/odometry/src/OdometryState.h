// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/odometry/LocalMapRegistration.h>
#include <dyslam/odometry/MotionFilter.h>
#include <dyslam/odometry/MotionSensors.h>
#include <dyslam/odometry/Odometry.h>
#include <dyslam/odometry/ScanClock.h>
#include <dyslam/odometry/ScanMatcher.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "MotionUncertainty.h"

namespace dyslam
{
/** What Odometry keeps from frame to frame, and the steps of its stages. */
struct Odometry::State
{
  /** \param given the scan matcher; null for the one that the config names */
  State(ConfigLoader& config,
        ThreadPool& pool,
        mrpt::system::CTimeLogger& time_logger,
        std::unique_ptr<ScanMatcher> given);

  /** By the options or by the wheels. */
  [[nodiscard]] bool startSpeedKnown() const
  {
    return options.start_speed != 0 || start_speed_sensed;
  }
  [[nodiscard]] bool registers() const { return refine.method != RefineMethod::none; }
  /** The scan is the first to be registered to its map. */
  [[nodiscard]] bool startsMap() const { return registration.framesInMap() == 1; }

  [[nodiscard]] MotionPrior priorAfter(double dt) const;
  /** The prior is measured by other sensors: it holds without scans. */
  [[nodiscard]] bool isDeadReckoned() const
  {
    return sensed_information(0, 0) > 0 && sensed_information(3, 3) > 0;
  }
  void startAtSensedSpeed(double stamp);
  void senseMotion(const Frame& frame);
  void fuseSensedMotion(double dt, MotionPrior& prior);
  [[nodiscard]] std::optional<Pose> motionOverDoubtfulInterval(
      const Frame& frame, const std::function<Cloud(const Pose&, double)>& prepare);
  void countSegmenterMotions(const Frame& frame);
  [[nodiscard]] bool acceptsSegmenterMotion(const Frame& frame) const;
  void fuseSegmenterMotion(Frame& frame);
  [[nodiscard]] std::string rejectionReason(const Frame& frame) const;
  void matchScan(Frame& frame);
  void weightByAppearance(Frame& frame) const;
  [[nodiscard]] Pose initialGuess(const Frame& frame) const;
  [[nodiscard]] double initialSigma(const Frame& frame) const;
  [[nodiscard]] LocalMapRegistration::Alignment registerFrom(const Frame& frame,
                                                             const Pose& T_guess) const;
  void updateMeanVelocity(const Frame& frame);
  void registerToMap(Frame& frame, const Pose& T_guess);
  void takeMatcherMotion(Frame& frame, const Pose& T_guess);

  mrpt::system::CTimeLogger& times;
  OdometryOptions options;
  FusionOptions fusion;
  MotionFilterOptions motion_options;
  RefineOptions refine;
  MotionFilter filter;
  std::unique_ptr<ScanMatcher> matcher;
  LocalMapRegistration registration;
  LocalMapRegistration::Alignment alignment;  //!< of the current frame, until integrate()
  MotionSensors sensors;
  MotionUncertainty uncertainty;

  ScanClock clock;
  bool doubtful = false;                 //!< the interval to the scan at hand
  bool after_gap = false;                //!< too long to predict the velocity after it
  bool started = false;                  //!< a scan has been seen
  bool registered = false;               //!< a scan has been registered to the map
  std::optional<Vector6> mean_velocity;  //!< of the last scans registered [m/s, rad/s]
  double without_scan = 0;               //!< time since the last usable scan [s]
  Pose T_odom_previous = Pose::Identity();
  Pose T_sweep_previous = Pose::Identity();  //!< that the previous cloud was deskewed with
  /** Of the segmenter's motion, if it was fused with the frame's prior; else zero. */
  Matrix6 segmenter_information = Matrix6::Zero();
  bool moved = false;                            //!< there was a motion between two scans
  bool start_speed_sensed = false;               //!< by the wheels
  std::optional<SensedMotion> sensed;            //!< between the stamps of the last two scans
  Matrix6 sensed_information = Matrix6::Zero();  //!< of `sensed`, as fused with the frame's prior
  int segmenter_frames = 0;                      //!< with an appearance prior
  int segmenter_failures = 0;                    //!< of those, with no ego-motion found
};
}  // namespace dyslam
