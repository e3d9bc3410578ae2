// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/GnssFix.h>
#include <dyslam/core/MotionSamples.h>
#include <dyslam/core/Options.h>
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
 * always complete. So do clouds in files of their own, in `<name>_Images.tmp/`. A killed program
 * leaves the `.tmp`s.
 */
class RawlogWriter
{
 public:
  /** \throws UserError if the file cannot be made. */
  explicit RawlogWriter(const std::string& path, const RawlogWriterOptions& options = {});
  /** Continues the file of another object, saved by exchangeState(). \throws UserError. */
  RawlogWriter(const std::string& path, const RawlogWriterOptions& options, StateArchive& saved);
  ~RawlogWriter();
  RawlogWriter(RawlogWriter&&) noexcept;
  RawlogWriter& operator=(RawlogWriter&&) noexcept;

  /** \param truth T_world_vehicle at the scan's stamp.
   * \throws UserError if the disk is full or the stamp is not a number. */
  void write(const Scan& scan, const std::optional<Pose>& truth = std::nullopt);
  /** A CObservationIMU: angular velocity, and acceleration if given; label `imu`. To be written
   * before the first scan that is not older. \throws UserError as for a scan. */
  void write(const ImuSample& sample);
  /** A CObservationOdometry: velocities, and the pose that they add up to since the first one;
   * label `odometry`. To be written before the first scan that is not older. \throws UserError as
   * for a scan. */
  void write(const WheelSample& sample);
  /** A CObservationGPS: a GGA message and, if the standard deviations are known, with them a
   * NV_OEM6_BESTPOS; label `gnss`. To be
   * written before the first scan that is not older. \throws UserError as for a scan. */
  void write(const GnssFix& fix);
  /** Finishes the file. \throws UserError if that fails. Later calls do nothing. */
  void close();

  /** Removes all that was written, instead of close(). An earlier file of the name stays. */
  void abandon();

  /** The state of the file. */
  void saveState(StateArchive& archive);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};
}  // namespace dyslam
