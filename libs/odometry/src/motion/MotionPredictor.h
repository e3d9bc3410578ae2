// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/StateArchive.h>
#include <dyslam/core/Frame.h>
#include <dyslam/odometry/LocalMapRegistration.h>
#include <dyslam/odometry/MotionFilter.h>
#include <dyslam/odometry/MotionSensors.h>
#include <dyslam/odometry/Odometry.h>
#include <dyslam/odometry/ScanClock.h>

#include <optional>
#include <string>
#include <vector>

#include "FrameContext.h"

namespace dyslam
{
/** Provides the prior of the motion since the previous scan.
 *
 * A constant-velocity Kalman filter predicts it over the time that the stamps say has passed;
 * gyroscope and wheels, where there are any, are fused with it. Not thread-safe.
 */
class MotionPredictor
{
 public:
  /** \param start speed at the first scan, if known
   * \param reliable_sigma largest sigma of the position of a prior that is reliable [m] */
  MotionPredictor(const OdometryOptions& start,
                  const MotionFilterOptions& motion,
                  const MotionSensorOptions& sensors,
                  double reliable_sigma);

  /** Takes in stamp and sensor samples of the next frame. Fills Frame::dt, sweep_duration,
   * clock_offset and prior, and the context's interval_doubtful, sensed and
   * sensed_information. */
  void predict(Frame& frame, FrameContext& context);
  /** The stamps of the last scan and the one before are right. */
  void acceptInterval();
  /** The motion between the last two scans took `dt` seconds, whatever their stamps say. Corrects
   * Frame::dt, clock_offset and prior, and the context's after_gap and sensed_information. */
  void correctInterval(double dt, Frame& frame, FrameContext& context);

  /** Prior of the next `dt` seconds by the filter alone. */
  [[nodiscard]] MotionPrior priorAfter(double dt) const;
  /** Fuses the context's sensed motion with a prior over `dt` seconds.
   * \return the information that was added: zero, if `dt` is not the interval of the stamps */
  [[nodiscard]] Matrix6 fuseSensed(double dt,
                                   const FrameContext& context,
                                   MotionPrior& prior) const;
  /** The frame's prior with the mean velocity of the last scans in place of the last velocity,
   * except for the components that other sensors measured; nothing where it is not known. */
  [[nodiscard]] std::optional<MotionPrior> meanVelocityPrior(const Frame& frame,
                                                             const FrameContext& context) const;

  /** The frame's prior with the gyroscope where it was not used, and without where it was; nothing
   * without samples of it. \param sensed_information is set to that of the sensors in the prior */
  [[nodiscard]] std::optional<MotionPrior> priorOtherwise(const Frame& frame,
                                                          const FrameContext& context,
                                                          Matrix6& sensed_information) const;

  /** Updates filter, sensor errors and mean velocity with the registration of the frame. */
  void update(const Frame& frame,
              const FrameContext& context,
              const RegistrationResult& registration);
  /** Updates the filter with a motion that no registration has measured.
   * \param T_previous_current the matcher's motion, or the prior's if that is rejected; taken as
   *   exact unless the matcher fuses the prior */
  void updateUnregistered(const Frame& frame,
                          const FrameContext& context,
                          const Pose& T_previous_current);

  [[nodiscard]] const ScanClock& clock() const { return clock_; }
  /** The clock of the stamps was set before the last scan, by the motion found since the previous
   * one. */
  [[nodiscard]] bool showsClockStep(const Pose& T_previous_current) const;
  /** The speed at the first scan is known, by the options or by the wheels. */
  [[nodiscard]] bool startSpeedKnown() const
  {
    return start_.start_speed != 0 || start_speed_sensed_;
  }
  /** Sensors in use: " + gyroscope + wheel_odometry", or a part of it. */
  [[nodiscard]] std::string sensorNames() const { return sensors_.name(); }
  /** Warnings about the clock and the sensors, a sentence each. */
  [[nodiscard]] std::vector<std::string> warnings() const;

  void exchangeState(StateArchive& archive)
  {
    archive(filter_, clock_, sensors_, started_, moved_, start_speed_sensed_, mean_velocity_);
  }

 private:
  void startFilter(double speed, double sigma);
  void senseMotion(const Frame& frame, FrameContext& context);

  // Options
  OdometryOptions start_;
  MotionFilterOptions motion_;
  double reliable_sigma_;  //!< largest sigma of the position of a reliable prior [m]

  // Saved
  MotionFilter filter_;
  ScanClock clock_;
  MotionSensors sensors_;
  bool started_ = false;             //!< a scan has been predicted
  bool moved_ = false;               //!< there was a motion between two scans
  bool start_speed_sensed_ = false;  //!< the wheels measured the speed at the first scan
  /** Mean velocity of the last scans registered, [translation, rotation] in the vehicle frame
   * [m/s, rad/s]. */
  std::optional<Vector6> mean_velocity_;
};
}  // namespace dyslam
