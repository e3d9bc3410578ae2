// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Options.h>
#include <dyslam/core/Frame.h>

#include <cstddef>
#include <memory>
#include <string>

namespace dyslam
{
class StateArchive;

struct ReplayWriterOptions : Options
{
  int every = 1;             //!< interval between written scans; 1: every scan
  double resolution = 0.15;  //!< static cloud: one point per cube of this side [m]; 0: all points
  int scene_points = 30000;  //!< largest number of points in the 3D scene; 0: no scene
  int trajectory_points = 2000;  //!< largest number of poses of the trajectory in a scene
  int compression_level = 1;     //!< level of gzip, 0 (none) to 9

  void describe(OptionsVisitor& visitor) override;
};

/** Writes the results of a run as a rawlog of stock MRPT classes, for an unmodified RawLogViewer.
 *
 * Per scan: CObservationPointCloud `static` and `moving` (XYZI, vehicle frame),
 * CObservationRobotPose `estimate` (and `ground_truth` where known), and a CObservation3DScene in
 * the vehicle frame with points coloured static or moving, boxes of the reported objects with ids,
 * velocity arrows and the trajectory so far. Streams: memory does not grow with the run. The same
 * input gives the same bytes.
 *
 * The file is written to `<path>.tmp` and renamed when closed: by close(), or by the destructor
 * when an exception unwinds the stack after the first scan. A full disk leaves an earlier file.
 */
class ReplayWriter
{
 public:
  /** Creates the file. \throws UserError if it cannot be created. */
  explicit ReplayWriter(const std::string& path, const ReplayWriterOptions& options = {});
  /** Continues the file of another object, saved by exchangeState(). \throws UserError. */
  ReplayWriter(const std::string& path, const ReplayWriterOptions& options, StateArchive& saved);
  ~ReplayWriter();
  ReplayWriter(ReplayWriter&&) noexcept;
  ReplayWriter& operator=(ReplayWriter&&) noexcept;

  /** Reads scan.stamp, cloud, moving, objects and the poses of the frame.
   * \throws UserError if the disk is full. */
  void write(const Frame& frame);
  /** Finishes the file; later calls do nothing. \throws UserError if that fails. */
  void close();

  /** Saves or loads the state of the file. */
  void saveState(StateArchive& archive);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};
}  // namespace dyslam
