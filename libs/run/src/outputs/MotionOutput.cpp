// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/formats/MotionFiles.h>
#include <dyslam/formats/RunFiles.h>
#include <dyslam/io/RawlogSource.h>

#include <Eigen/Cholesky>

#include "RunOutput.h"
#include "StreamedFile.h"

namespace dyslam
{
namespace
{

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

/** Transforms covariances of the levelled vehicle's motion to the recording's vehicle frame. */
void toRecorded(const Levelling& levelling, MotionCovariance& motion)
{
  if (!levelling.isNone())
  {
    const Matrix6 turn = adjointSE3(levelling.T_level_recorded().inverse());
    motion.covariance = turn * motion.covariance * turn.transpose();
    motion.pose_noise = turn * motion.pose_noise * turn.transpose();
  }
}

/** `motions.csv`: covariance of each odometry motion, in the recording's vehicle frame. */
class MotionOutput : public RunOutput
{
 public:
  explicit MotionOutput(const RunOutputContext& context)
      : RunOutput(context, {run_files::motions}),
        levelling_(context.config.get<RawlogSourceOptions>("input").levelling())
  {
  }
  void open() override { file_.open(path(run_files::motions), motionFileHeader()); }
  void add(const Frame& frame) override
  {
    MotionCovariance motion = covarianceOf(frame);
    toRecorded(levelling_, motion);
    file_.write(motionFileRow(motion));
  }
  void exchangeState(StateArchive& archive) override
  {
    file_.exchangeState(path(run_files::motions), archive);
  }
  void finish(const RunResults& /*results*/) override { file_.close(); }

 private:
  Levelling levelling_;
  StreamedFile file_;
};
}  // namespace

std::unique_ptr<RunOutput> makeMotionOutput(const RunOutputContext& context)
{
  return std::make_unique<MotionOutput>(context);
}
}  // namespace dyslam
