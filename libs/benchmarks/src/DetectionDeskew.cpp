// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Angle.h>
#include <dyslam/benchmarks/DetectionDeskew.h>
#include <dyslam/core/BoxOverlap.h>

#include <cmath>
#include <stdexcept>

namespace dyslam
{
namespace
{
/** Pose of the vehicle when it swept the direction of `box`, in its frame at the stamp. */
Pose sweepMotion(
    const Box& box, const Pose& T_now_next, double interval, double period, const SweepModel& model)
{
  if (!(interval > 0) || !(period > 0))
  {
    throw std::invalid_argument("deskewed: interval and period must be positive");
  }
  const double time = sweepTime(std::atan2(box.centre.y(), box.centre.x()), period, model);
  return expSE3(time / interval * logSE3(T_now_next));
}
}  // namespace

double sweepTime(double azimuth, double period, const SweepModel& model)
{
  const double middle = model.start_azimuth - M_PI;
  return model.direction * wrapAngle(azimuth - middle) / (2 * M_PI) * period;
}

Box deskewed(
    const Box& box, const Pose& T_now_next, double interval, double period, const SweepModel& model)
{
  return transformed(box, sweepMotion(box, T_now_next, interval, period, model));
}

Box skewed(
    const Box& box, const Pose& T_now_next, double interval, double period, const SweepModel& model)
{
  // The azimuth under which the box was swept is that of the result; one step from that of the
  // input is within millimetres of it.
  const Box first =
      transformed(box, sweepMotion(box, T_now_next, interval, period, model).inverse());
  return transformed(box, sweepMotion(first, T_now_next, interval, period, model).inverse());
}

void deskewDetections(std::vector<Detection>& detections,
                      const Pose& T_now_next,
                      double interval,
                      double period,
                      const SweepModel& model)
{
  for (Detection& detection : detections)
  {
    const Pose motion = sweepMotion(detection.box, T_now_next, interval, period, model);
    detection.box = transformed(detection.box, motion);
    Eigen::Matrix4d turn = Eigen::Matrix4d::Identity();
    turn.topLeftCorner<3, 3>() = motion.linear();
    detection.covariance = (turn * detection.covariance * turn.transpose()).eval();
  }
}
}  // namespace dyslam
