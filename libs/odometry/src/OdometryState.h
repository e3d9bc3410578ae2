// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/StateArchive.h>
#include <dyslam/odometry/LocalMapRegistration.h>
#include <dyslam/odometry/Odometry.h>
#include <dyslam/odometry/ScanMatcher.h>

#include <memory>
#include <string>

#include "FrameContext.h"
#include "IntervalResolver.h"
#include "MotionPredictor.h"
#include "MotionUncertainty.h"

namespace dyslam
{
/** What the steps of a frame need of the frames before. Saved as a whole. */
struct OdometryHistory
{
  Pose T_odom_previous = Pose::Identity();  //!< pose at the previous scan
  /** Motion during the previous sweep that its cloud was deskewed with. */
  Pose T_sweep_previous = Pose::Identity();
  double time_without_scan = 0;  //!< time from the last usable scan to the previous scan [s]
  bool registered = false;       //!< a scan has been registered to the map
  int segmenter_frames = 0;      //!< number of frames with an appearance prior
  int segmenter_failures = 0;    //!< number of those in which the segmenter found no ego-motion
};

/** What Odometry keeps from frame to frame, and the steps of its stages. */
struct Odometry::State
{
  /** \param given the scan matcher; null for the one that the config names */
  State(ConfigLoader& config,
        ThreadPool& pool,
        mrpt::system::CTimeLogger& time_logger,
        std::unique_ptr<ScanMatcher> given);

  [[nodiscard]] bool registers() const { return refine.method != RefineMethod::none; }
  /** The scan is the first to be registered to its map. */
  [[nodiscard]] bool startsMap() const { return registration.framesInMap() == 1; }

  void countSegmenterMotions(const Frame& frame);
  [[nodiscard]] bool acceptsSegmenterMotion(const Frame& frame) const;
  void fuseSegmenterMotion(Frame& frame);
  [[nodiscard]] std::string rejectionReason(const Frame& frame) const;
  void matchScan(Frame& frame);
  void weightByAppearance(Frame& frame) const;
  [[nodiscard]] Pose initialGuess(const Frame& frame) const;
  [[nodiscard]] double initialSigma(const Frame& frame) const;
  [[nodiscard]] RegistrationResult registerFrom(const Frame& frame, const Pose& T_guess);
  void registerToMap(Frame& frame, const Pose& T_guess);
  void takeMatcherMotion(Frame& frame, const Pose& T_guess);

  void exchangeState(StateArchive& archive)
  {
    archive(predictor, *matcher, registration, uncertainty, history);
  }

  mrpt::system::CTimeLogger& times;
  OdometryOptions options;
  FusionOptions fusion;
  MotionFilterOptions motion;
  RefineOptions refine;
  std::unique_ptr<ScanMatcher> matcher;
  LocalMapRegistration registration;
  MotionPredictor predictor;
  IntervalResolver resolver{predictor, registration};
  MotionUncertainty uncertainty;
  OdometryHistory history;
  FrameContext context;  //!< of the frame that predict() was called with last; not saved
};
}  // namespace dyslam
