// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>
#include <mrpt/obs/CObservation.h>

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
struct RawlogSourceOptions;

/** A scan of the lidar that is read, not decoded yet. */
struct RecordedScan
{
  mrpt::obs::CObservation::Ptr observation;
  mrpt::obs::CObservation::Ptr time_ring;  //!< its points' times and rings; null if it has none
  std::size_t index = 0;                   //!< among the lidar's scans in the recording, from 0
  double clock_shift = 0;  //!< to add to its stamps, after the clock was set back [s]
  // For Frame::imu, wheels and gnss, clock_shift is in their stamps
  std::vector<ImuSample> imu;
  std::vector<WheelSample> wheels;
  std::vector<GnssFix> gnss;

  /** With clock_shift [s]. */
  [[nodiscard]] double stamp() const;
};

/** Makes frames from the observations of a recording: chooses the lidar, drops scans with bad time
 * stamps, joins the observations of one scan. RawlogSource lists the supported classes.
 *
 * Stamps of the frames increase. Where those of the recording go back and run on from there, the
 * clock was set back: the scans that show it are dropped, later stamps are shifted.
 *
 * The samples of one IMU, one wheel odometry and one satellite receiver go to the next scan that is
 * used, those from 10 s before it to 1 s after it. Samples that are not later than the ones before
 * are left out.
 *
 * Not thread-safe; one object per recording.
 */
class ScanDecoder
{
 public:
  /** Of the options, only_first_n is left to the caller.
   * \param recording its name, for messages \param external_folder of externally stored data
   * \throws UserError for bad options. */
  ScanDecoder(const RawlogSourceOptions& options,
              const std::string& recording,
              const std::string& external_folder);
  ~ScanDecoder();
  ScanDecoder(ScanDecoder&&) noexcept;
  ScanDecoder& operator=(ScanDecoder&&) noexcept;

  /** The next observation of the recording. \return it, if it is a scan to use.
   * \throws UserError if the time stamps stand still or run backwards for long. */
  [[nodiscard]] std::optional<RecordedScan> take(const mrpt::obs::CObservation::Ptr& observation);

  /** No later scan is to be used: it would be at or after the end of the options. */
  [[nodiscard]] bool isPastEnd() const;

  /** Whether scans of further lidars that are recorded late may still come for a scan: not once
   * those of all are past it, or three more scans of the first lidar were taken. */
  [[nodiscard]] bool waitsForFurther(const RecordedScan& scan) const;

  /** Fills index, scan, imu and wheels of a frame. The scan gets those of further lidars, among the
   * observations taken so far, that are nearer to it than to the one after, and late ones.
   * \pre each scan of take() is decoded once, in order. \throws UserError for damaged data. */
  [[nodiscard]] Frame decode(const RecordedScan& scan);

  /** Ground truth among the observations taken so far (it may follow its scan), T_world_vehicle at
   * a scan. Requested times must not decrease.
   * \param stamp of its frame [s] \param clock_shift of its RecordedScan [s] */
  [[nodiscard]] std::optional<Pose> truthAt(double stamp, double clock_shift);

  /** Reports why the observations taken so far have no usable scan.
   * \param left_out how many others the recording has of each class. \throws UserError always. */
  [[noreturn]] void failWithoutScans(const std::map<std::string, std::size_t>& left_out) const;

  /** Scans dropped for their time stamps so far. */
  [[nodiscard]] std::size_t framesDropped() const;
  /** Label of the lidar that is being read. */
  [[nodiscard]] std::string sensorLabel() const;
  /** What the user should know about the recording, one line each, each kind once with its count.
   */
  [[nodiscard]] std::vector<std::string> warnings() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};
}  // namespace dyslam
