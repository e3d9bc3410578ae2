// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/GnssFix.h>
#include <dyslam/core/MotionSamples.h>
#include <mrpt/obs/CObservationGPS.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationOdometry.h>

#include <cstddef>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "BodyVelocities.h"
#include "LabelPattern.h"
#include "RecordingNotes.h"

namespace dyslam
{
struct RawlogSourceOptions;
struct RecordedScan;

/** Selects one of the sensors of a kind: the first whose label fits. */
class SensorChoice
{
 public:
  explicit SensorChoice(const LabelPattern& pattern) : pattern_(pattern) {}

  /** Whether samples of this label are used. Others of a fitting label are noted. */
  [[nodiscard]] bool takes(const std::string& label, RecordingNotes& notes);
  /** Label of the selected sensor; empty if there is none. */
  [[nodiscard]] std::string label() const { return chosen_.value_or(""); }
  /** Whether no label fits the given pattern. */
  [[nodiscard]] bool misses() const { return !chosen_ && !pattern_.pattern().empty(); }
  [[nodiscard]] const LabelPattern& pattern() const { return pattern_; }

 private:
  LabelPattern pattern_;
  std::optional<std::string> chosen_;
};

/** Samples of one sensor that wait for the next scan. */
template <typename Sample>
class SampleQueue
{
 public:
  static constexpr std::size_t most = 20000;  //!< largest number of samples: the latest are kept
  static constexpr double memory = 10;        //!< farthest time before the scan [s]
  static constexpr double longest_lead = 1;   //!< farthest time after the scan [s]

  /** \param sample by the clock of the scans */
  void push(const Sample& sample);
  /** The clock was set back: adds the shift to the samples read since then, which begin where the
   * times go back farthest. \param shift [s] */
  void shiftClock(double shift);
  /** Takes the samples out that are near a scan, each later than the one before. \param stamp of
   * the scan [s] \param leaves_later those after the stamp go on waiting */
  [[nodiscard]] std::vector<Sample> takeNear(double stamp, bool leaves_later);
  /** Whether samples wait, but none is near a scan. \param stamp stamp of the scan [s] */
  [[nodiscard]] bool isFar(double stamp) const;

 private:
  [[nodiscard]] static bool isNear(const Sample& sample, double stamp);

  std::deque<Sample> waiting_;        //!< in the order of the file
  std::optional<double> last_stamp_;  //!< stamp of the last sample taken out [s]
};

/** Collects what inertial measurement units, wheels and satellite receivers measured between the
 * scans of a recording: of CObservationIMU the angular velocity and the acceleration, of
 * CObservationOdometry the local velocity or, as long as that is missing or zero, the displacement
 * since the observation before, of CObservationGPS the position of a GGA message with a fix.
 *
 * Samples without a time stamp or with numbers that are not finite are left out. Not thread-safe.
 */
class MotionSampleReader
{
 public:
  /** \throws UserError for a label that is not a regular expression. */
  explicit MotionSampleReader(const RawlogSourceOptions& options);

  /** \param clock_shift from the recording's stamps to those of the scans [s]
   * \return whether the observation is of such a sensor, used or not. */
  bool take(const mrpt::obs::CObservation& observation, double clock_shift, RecordingNotes& notes);
  /** The clock of the recording was set back; later calls of take() have the new clock_shift.
   * \param shift by how much it grew [s] */
  void shiftClock(double shift);
  /** Hands the samples since the last call to a scan; if its stamp was late, those after the moved
   * one wait for the next scan. \param stamp of its frame [s] */
  void handOver(double stamp, RecordedScan& scan, RecordingNotes& notes);
  /** Warnings about given labels that fit no sensor so far. */
  [[nodiscard]] std::vector<std::string> missing() const;

 private:
  /** Passes a sample with its stamp as recorded on, if there is one and its sensor is used. */
  template <typename Sample>
  void takeSample(std::optional<Sample> sample,
                  const mrpt::obs::CObservation& observation,
                  SensorChoice& choice,
                  SampleQueue<Sample>& queue,
                  double clock_shift,
                  RecordingNotes& notes);
  void takeOdometry(const mrpt::obs::CObservationOdometry& observation,
                    double clock_shift,
                    RecordingNotes& notes);

  SensorChoice imu_choice_;
  SensorChoice wheel_choice_;
  SensorChoice gnss_choice_;
  SampleQueue<ImuSample> imu_;
  SampleQueue<WheelSample> wheels_;
  SampleQueue<GnssFix> gnss_;
  BodyVelocities velocities_;  //!< velocities by the odometry, with recorded stamps
};
}  // namespace dyslam
