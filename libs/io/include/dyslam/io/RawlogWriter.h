// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Options.h>
#include <dyslam/core/GnssFix.h>
#include <dyslam/core/MotionSamples.h>
#include <dyslam/core/Pose.h>
#include <dyslam/core/Scan.h>

#include <cstddef>
#include <memory>
#include <optional>
#include <string>

namespace dyslam
{
class StateArchive;

struct RawlogWriterOptions : Options
{
  bool external_storage = false;                    //!< clouds as .bin files in `<name>_Images/`
  int compression_level = 1;                        //!< level of gzip, 0 (none) to 9
  std::string sensor_label = "lidar";               //!< sensor label of scans that have none
  std::string ground_truth_label = "ground_truth";  //!< sensor label of the true poses
  bool growing = false;  //!< under its name from the start, see RawlogWriter; not in an ini

  void describe(OptionsVisitor& visitor) override;
};

/** Writes scans as an observation-only gzip rawlog that stock MRPT programs read.
 *
 * Per scan, all with the scan's time stamp: the ground truth (CObservationRobotPose) if given, per
 * point time and ring if the scan has them (CObservationPointCloud labelled `<label>_time_ring`),
 * then the scan (CObservationPointCloud of XYZI, or XYZ if it has no intensity). Every point is
 * kept, in order. The same input gives the same bytes.
 *
 * The file is written to `<path>.tmp` and renamed when closed: by close(), or by the destructor
 * when an exception unwinds the stack after the first scan, so that a file under its final name is
 * always complete. The same holds for externally stored clouds, in `<name>_Images.tmp/`; those of
 * an earlier rawlog of the name are removed. A killed program leaves the `.tmp` files.
 *
 * A growing file (RawlogWriterOptions::growing) has its name from the start, replaces an earlier
 * one at once, and can be read while it is written; external storage is not for it.
 */
class RawlogWriter
{
 public:
  /** Creates the file. \throws UserError if it cannot be created. */
  explicit RawlogWriter(const std::string& path, const RawlogWriterOptions& options = {});
  /** Continues the file of another object, saved by exchangeState(). \throws UserError. */
  RawlogWriter(const std::string& path, const RawlogWriterOptions& options, StateArchive& saved);
  ~RawlogWriter();
  RawlogWriter(RawlogWriter&&) noexcept;
  RawlogWriter& operator=(RawlogWriter&&) noexcept;

  /** Writes a scan. \param truth T_world_vehicle at the scan's stamp
   * \throws UserError if the disk is full or the stamp is not a number. */
  void write(const Scan& scan, const std::optional<Pose>& truth = std::nullopt);
  /** Writes a CObservationIMU: angular velocity, and acceleration if given; label `imu`. To be
   * written before the first scan that is not older. \throws UserError as for a scan. */
  void write(const ImuSample& sample);
  /** Writes a CObservationOdometry: velocities, and the pose integrated from them since the first
   * sample; label `odometry`. To be written before the first scan that is not older. \throws
   * UserError as for a scan. */
  void write(const WheelSample& sample);
  /** Writes a CObservationGPS: a GGA message and, if the standard deviations are known, a
   * NV_OEM6_BESTPOS with them; label `gnss`. To be written before the first scan that is not older.
   * \throws UserError as for a scan. */
  void write(const GnssFix& fix);
  /** Lets readers of a growing file have all that was written so far. \throws UserError as for a
   * scan. */
  void flush();
  /** Completes the file under its temporary name; nothing can be written behind it. \throws
   * UserError if the disk is full. */
  void finish();
  /** Completes and renames the file. \throws UserError if that fails. Later calls do nothing. */
  void close();

  /** Called instead of close(): removes all that was written; an earlier file is kept, unless it
   * was replaced by a growing one. */
  void abandon();

  /** Saves or loads the state of the file. */
  void saveState(StateArchive& archive);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};
}  // namespace dyslam
