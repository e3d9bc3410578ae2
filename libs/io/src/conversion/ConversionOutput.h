// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Trajectory.h>
#include <dyslam/formats/GroundTruth.h>
#include <dyslam/io/Conversion.h>
#include <dyslam/io/RawlogWriter.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
/** Longest time between a scan and the true poses from which its own is interpolated [s], as
 * RawlogSourceOptions::ground_truth_max_gap. */
constexpr double truth_max_gap = 0.2;

/** True pose at a stamp [s]: one within 1 us, or interpolated between poses within truth_max_gap;
 * nothing without. */
[[nodiscard]] std::optional<Pose> truePoseAt(const Trajectory& truth, double stamp);

/** \param inputs files and folders that a conversion reads; empty ones are skipped.
 * \throws UserError if writing the rawlog `output` with its sidecar would replace one of them. */
void requireNoInput(const std::string& output, const std::vector<std::string>& inputs);

/** For errors: the flags of the range, which leave no scan. */
[[nodiscard]] std::string emptyRange(const ScanRange& range);

/** Warning for scans that are thinned out and whose points have no times. */
constexpr const char* thinned_without_times =
    "not every scan is converted and the points have no times: deskewing by azimuth would take the "
    "time between two converted scans for a revolution; run dyslam with --set "
    "preprocess.deskew=none";

/** A rawlog and, once there is truth for it, its sidecar; counts what it writes.
 *
 * Both get their names by close(). When an error ends the work after the first scan, the scans
 * before it are kept, unless there is an earlier recording or truth of the name: then that stays,
 * and all that was written is removed. A growing rawlog replaces an earlier one from its first scan
 * on.
 */
class ConversionOutput
{
 public:
  /** \param origin source of the true poses */
  ConversionOutput(const std::string& path,
                   const ConversionOptions& options,
                   const PoseOrigin& origin);
  ~ConversionOutput();
  ConversionOutput(const ConversionOutput&) = delete;
  ConversionOutput& operator=(const ConversionOutput&) = delete;

  /** \param T_world_lidar true pose at the scan's stamp, if it is known */
  void write(const Scan& scan, const std::optional<Pose>& T_world_lidar);
  /** Writes a scan of a further lidar, which is not counted. */
  void writeFurther(const Scan& scan);
  /** To be written before the first scan that is not older. */
  void write(const ImuSample& sample) { writer().write(sample); }
  void write(const GnssFix& fix) { writer().write(fix); }
  void write(const WheelSample& sample) { writer().write(sample); }
  /** Writes the labels of the scan written last. */
  void addLabels(const std::vector<Label>& labels);
  /** Writes true boxes of the scan written last, lidar frame; LabelledBox::frame is set here. */
  void addBox(LabelledBox box);
  /** Calls `progress` for the scan written last. If `progress` throws, all that was written is
   * removed. */
  void reportProgress(const ConversionProgress& progress, double fraction);
  ConversionResult close();
  /** Calls `work`, which fills and closes the output. \throws UserError of `work`, whose message
   * then also names the recording that is kept, if there is one. */
  ConversionResult fill(const std::function<ConversionResult()>& work);

  /** Number of the scan written last. \pre there is one */
  [[nodiscard]] std::size_t lastFrame() const { return result_.scans - 1; }

 private:
  /** The writer, opened if it is not. */
  RawlogWriter& writer();
  GroundTruthWriter& truth();
  std::string keepAfterError();
  void abandon();

  std::string path_;     //!< file of the rawlog
  std::string folder_;   //!< folder of the ground truth
  std::string pending_;  //!< temporary folder of the ground truth
  RawlogWriterOptions writer_options_;
  std::optional<RawlogWriter> writer_;  //!< nothing: the growing rawlog has no scan yet
  PoseOrigin origin_;
  std::unique_ptr<GroundTruthWriter> truth_;
  ConversionResult result_;
  bool closed_ = false;
};
}  // namespace dyslam
