// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/formats/MotionFiles.h>

#include <Eigen/Cholesky>

#include "../RunOutput.h"
#include "StreamedFile.h"

namespace dyslam
{
namespace
{
constexpr const char* name = "motions.csv";

MotionCovariance covarianceOf(const Frame& frame)
{
  MotionCovariance motion{frame.scan.stamp, frame.is_keyframe};
  const Eigen::LLT<Matrix6> cholesky(frame.motion.information);
  if (frame.dt > 0 && cholesky.info() == Eigen::Success)
  {
    motion.covariance = cholesky.solve(Matrix6::Identity());
    motion.pose_noise = frame.motion.pose_noise;
  }
  return motion;
}

/** `motions.csv`: the odometry's covariance of each motion. */
class MotionOutput : public RunOutput
{
 public:
  explicit MotionOutput(const RunOutputContext& context) : RunOutput(context, {name}) {}
  void open() override { file_.open(path(name), motionFileHeader()); }
  void add(const Frame& frame) override { file_.write(motionFileRow(covarianceOf(frame))); }
  void exchangeState(StateArchive& archive) override { file_.exchangeState(path(name), archive); }
  void finish(const RunResults& /*results*/) override { file_.close(); }

 private:
  StreamedFile file_;
};
}  // namespace

std::unique_ptr<RunOutput> makeMotionOutput(const RunOutputContext& context)
{
  return std::make_unique<MotionOutput>(context);
}
}  // namespace dyslam
