// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Printable.h>
#include <dyslam/formats/RunFiles.h>

#include <algorithm>
#include <cmath>

#include "RunOutput.h"
#include "StreamedFile.h"

namespace dyslam
{
namespace
{
constexpr const char* header =
    "frame,stamp,points,moving_points,odometry_converged,odometry_accepted,odometry_inliers,"
    "odometry_rmse,odometry_rejection,registered,inliers,rmse,reason,forward,turn_deg,keyframe\n";

std::string rowOf(const Frame& frame)
{
  const MotionEstimate& odometry = frame.odometry;
  const MotionEstimate& motion = frame.motion;
  std::string row =
      formatted("%zu,%.9f,%zu,%td,%d,%d,%zu,%.4f,", frame.index, frame.scan.stamp,
                frame.cloud.size(), std::count(frame.moving.begin(), frame.moving.end(), true),
                odometry.registered() ? 1 : 0, frame.odometry_accepted ? 1 : 0, odometry.inliers,
                odometry.rmse) +
      csvField(frame.odometry_rejection);
  row += formatted(",%d,%zu,%.4f,", motion.registered() ? 1 : 0, motion.inliers, motion.rmse) +
         csvField(motion.reason);
  const Pose& step = motion.T_previous_current;
  return row + formatted(",%.4f,%.4f,%d\n", step.translation().x(),
                         rotationAngle(step) * 180 / M_PI, frame.is_keyframe ? 1 : 0);
}

/** `scans.csv`: the result of each scan. */
class ScanTableOutput : public RunOutput
{
 public:
  explicit ScanTableOutput(const RunOutputContext& context)
      : RunOutput(context, {run_files::scan_table})
  {
  }
  void open() override { file_.open(path(run_files::scan_table), header); }
  void add(const Frame& frame) override { file_.write(rowOf(frame)); }
  void exchangeState(StateArchive& archive) override
  {
    file_.exchangeState(path(run_files::scan_table), archive);
  }
  void finish(const RunResults& /*results*/) override { file_.close(); }

 private:
  StreamedFile file_;
};
}  // namespace

std::unique_ptr<RunOutput> makeScanTableOutput(const RunOutputContext& context)
{
  return std::make_unique<ScanTableOutput>(context);
}
}  // namespace dyslam
