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

/** A scan of the first lidar that is not decoded yet. */
struct RecordedScan
{
  mrpt::obs::CObservation::Ptr observation;
  mrpt::obs::CObservation::Ptr time_ring;  //!< times and rings of its points; null: none
  std::size_t index = 0;                   //!< number of the lidar's scan in the recording, from 0
  double late_shift = 0;   //!< added to its stamp, if that was late in the scan: 0 or less [s]
  double clock_shift = 0;  //!< added to its stamps, after the clock was set back [s]
  // For Frame::imu, wheels and gnss; their stamps include clock_shift
  std::vector<ImuSample> imu;
  std::vector<WheelSample> wheels;
  std::vector<GnssFix> gnss;

  /** Stamp of its frame, including both shifts [s]. */
  [[nodiscard]] double stamp() const;
};

/** Makes frames from the observations of a recording: chooses the lidar, drops scans with bad time
 * stamps, joins the observations of one scan. RawlogSource lists the supported classes.
 *
 * Stamps of the frames increase. If the stamps of the recording go back and continue from there,
 * the clock was set back: the scans that show it are dropped, later stamps are shifted.
 *
 * Stamps that are late in the scans, as those of the last points, are moved to the first points:
 * all those of a lidar by the same time, which its first two scans with times of the points in the
 * recording show, used or not.
 *
 * The samples of one IMU, one wheel odometry and one satellite receiver are passed to the next scan
 * that is used, if they are from 10 s before to 1 s after it. Samples that are not later than the
 * previous ones are left out. Those after a stamp that was moved wait for the scan after it.
 *
 * Not thread-safe; one object per recording.
 */
class ScanDecoder
{
 public:
  /** The option only_first_n is left to the caller.
   * \param recording name of the recording, for messages \param external_folder folder of
   * externally stored data \throws UserError for bad options. */
  ScanDecoder(const RawlogSourceOptions& options,
              const std::string& recording,
              const std::string& external_folder);
  ~ScanDecoder();
  ScanDecoder(ScanDecoder&&) noexcept;
  ScanDecoder& operator=(ScanDecoder&&) noexcept;

  /** Takes the next observation of the recording. \return the scan, if it is one that is used
   * \throws UserError if the time stamps stand still or go back for long. */
  [[nodiscard]] std::optional<RecordedScan> take(const mrpt::obs::CObservation::Ptr& observation);

  /** Whether no later scan is used, as it would be at or after the `end` of the options. */
  [[nodiscard]] bool isPastEnd() const;
  /** As ScanSelection::progress(). */
  [[nodiscard]] double progress(double read, std::size_t used);

  /** Whether late scans of further lidars may still come for a scan: false once the scans of all
   * lidars are past it, or three more scans of the first lidar were taken. */
  [[nodiscard]] bool waitsForFurther(const RecordedScan& scan) const;

  /** Sets index, scan, imu, wheels and gnss of a frame. Scans of further lidars among the
   * observations taken so far are merged with it if they are nearer to it than to the next one, or
   * late. \pre each scan of take() is decoded once, in order. \throws UserError for damaged data.
   */
  [[nodiscard]] Frame decode(const RecordedScan& scan);

  /** Ground truth T_world_vehicle at a scan, from the observations taken so far (it may follow its
   * scan). Requested times must not decrease.
   * \param stamp stamp of its frame [s] \param clock_shift RecordedScan::clock_shift [s] */
  [[nodiscard]] std::optional<Pose> truthAt(double stamp, double clock_shift);

  /** Reports why the observations taken so far have no usable scan.
   * \param left_out number of other observations by class \throws UserError always. */
  [[noreturn]] void failWithoutScans(const std::map<std::string, std::size_t>& left_out) const;

  /** Number of scans dropped because of their time stamps so far. */
  [[nodiscard]] std::size_t framesDropped() const;
  /** Label of the lidar that is being read. */
  [[nodiscard]] std::string sensorLabel() const;
  /** Warnings for the user, one line each, each kind once with its count. */
  [[nodiscard]] std::vector<std::string> warnings() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};
}  // namespace dyslam
