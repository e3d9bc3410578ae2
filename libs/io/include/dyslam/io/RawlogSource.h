// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Options.h>
#include <dyslam/core/Frame.h>
#include <dyslam/io/Levelling.h>
#include <dyslam/io/ScanRange.h>

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
struct RawlogSourceOptions : Options, ScanRange
{
  /** Regex for the label of the first lidar; empty: the first one in the file that further_lidars
   * does not select. */
  std::string sensor_label;
  /** Regex for the labels of further lidars, whose scans are merged with the nearest scans of the
   * first lidar in time (Scan::parts); empty: none. */
  std::string further_lidars;
  bool merge_further = true;  //!< false: only the first lidar is read; not in the ini
  std::string ground_truth_label = "ground_truth";  //!< sensor label of the CObservationRobotPose
  /** Largest time between a scan and the true poses before and after it for interpolation, if no
   * true pose has the scan's stamp [s]. */
  double ground_truth_max_gap = 0.2;
  bool external_anywhere = false;  //!< external files may be outside of the recording's folder
  double intensity_scale = 0;  //!< factor on the file's intensities; 0: 1, or 1/255 for 0..255 data
  std::string imu_label;       //!< regex for the IMU's label; empty: the first IMU with a gyroscope
  std::string odometry_label;  //!< regex for the wheel odometry's label; empty: the first one
  std::string gnss_label;      //!< regex for the satellite receiver's label; empty: the first one
  bool level = true;           //!< settingsFor() sets roll and pitch
  double roll = 0;   //!< roll of the recording's vehicle frame over level ground, about x [rad]
  double pitch = 0;  //!< pitch of that frame, about y, after roll [rad]

  [[nodiscard]] Levelling levelling() const { return {roll, pitch}; }

  void describe(OptionsVisitor& visitor) override;
};

/** Streams the 3D scans of an MRPT rawlog, plain or gzip, observation-only or sensory frames.
 *
 * Reads CObservationPointCloud, CObservationVelodyneScan, CObservationRotatingScan and
 * CObservation3DRangeScan, external storage (`<name>_Images/`) included. At most a few observations
 * are in memory. Frame::index counts the lidar's scans in the file from 0, so that it fits the
 * ground-truth sidecar whatever is skipped. See doc/formats.md for how per-point time and ring are
 * stored.
 *
 * The vehicle frame of scans, IMU and ground truth is the levelled one, by roll and pitch of the
 * options.
 *
 * With several lidars each frame has the scan of the first one and, if selected, those of the
 * others, placed by the sensor poses of the observations. For scans recorded late, up to three
 * scans of the first lidar are read ahead.
 *
 * CObservationIMU and CObservationOdometry are also read. Frame::imu and Frame::wheels have the
 * samples recorded since the previous scan, and older ones that follow that scan in the file.
 * Damaged samples are left out.
 *
 * Late stamps are moved to the first points of their scans, as ScanDecoder describes.
 *
 * Observations of classes unknown to MRPT are left out, with a warning per class.
 *
 * A scan whose time stamp is not after that of the previous scan is dropped with a warning;
 * more than ten in a row are an error. A file cut short delivers every complete scan first, then
 * next() throws.
 *
 * A file that is still being written (dyslam/base/GrowingFile.h) is followed until its writer
 * closes it: next() waits for its scans.
 *
 * One thread at a time may call it.
 */
class RawlogSource
{
 public:
  /** Opens the file and reads up to the first scan.
   * \param stop asked while the source waits for more of a file that grows; true ends it, with the
   * scans that are there. Null for never.
   * \throws UserError if it is missing, empty, not a rawlog, or has no 3D scan. */
  explicit RawlogSource(const std::string& path,
                        const RawlogSourceOptions& options = {},
                        std::function<bool()> stop = nullptr);
  ~RawlogSource();
  RawlogSource(RawlogSource&&) noexcept;
  RawlogSource& operator=(RawlogSource&&) noexcept;

  /** Frame of the next scan with its ground truth, nothing at the end. Sets index, scan, imu,
   * wheels, gnss and T_world_vehicle_truth. \throws UserError for damaged data, after all scans
   * before it were delivered. */
  [[nodiscard]] std::optional<Frame> next();

  /** Fraction of the scans to use that were delivered so far, 0 to 1: of the (compressed) file
   * after the scans that are skipped, of the time to `end`, or of `only_first_n`. */
  [[nodiscard]] double progress() const;
  /** Number of frames delivered so far. */
  [[nodiscard]] std::size_t framesRead() const;
  /** Number of scans dropped because of their time stamps so far. */
  [[nodiscard]] std::size_t framesDropped() const;
  /** Label of the lidar that is being read. */
  [[nodiscard]] std::string sensorLabel() const;
  /** Whether `stop` has ended it while it waited. */
  [[nodiscard]] bool isStopped() const;
  /** Warnings for the user, one line each, each kind once with its count. */
  [[nodiscard]] std::vector<std::string> warnings() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};
}  // namespace dyslam
