// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Angle.h>
#include <dyslam/benchmarks/DetectionDeskew.h>
#include <dyslam/core/BoxOverlap.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

using namespace dyslam;

namespace
{
Box boxAt(double range, double azimuth)
{
  Box box;
  box.centre = {range * std::cos(azimuth), range * std::sin(azimuth), -0.8};
  box.yaw = 0.4;
  return box;
}
}  // namespace

/** A standing box is observed from the moving, turning vehicle at the time of its sweep. */
TEST(DetectionDeskew, RecoversAStandingBoxFromItsSkewedObservation)
{
  constexpr double period = 0.1;
  const double interval = 0.2;  // the ego-motion is of two revolutions
  const Pose T_now_next = poseFromYpr(2.8, 0.1, 0.02, 0.06, 0, 0);
  for (const double azimuth : {-2.5, -0.8, 0.0, 0.6, 1.5, 3.0})
  {
    const Box seen = boxAt(15, azimuth);
    // The vehicle faces this azimuth at -azimuth / (2 pi) of a revolution.
    const double time = -azimuth / (2 * M_PI) * 0.1;
    EXPECT_NEAR(sweepTime(azimuth, period), time, 1e-15);
    const Pose T_now_then = expSE3(time / interval * logSE3(T_now_next));
    const Box expected = transformed(seen, T_now_then);
    const Box found = deskewed(seen, T_now_next, interval, period);
    EXPECT_NEAR((found.centre - expected.centre).norm(), 0, 1e-12);
    EXPECT_NEAR(wrapAngle(found.yaw - expected.yaw), 0, 1e-12);
    const Box again = skewed(found, T_now_next, interval, period);
    EXPECT_NEAR((again.centre - seen.centre).norm(), 0, 0.002) << azimuth;
  }
  // The left is swept before the stamp on a clockwise sweep. Driving ahead, the box is nearer at
  // the stamp than it was then.
  EXPECT_LT(deskewed(boxAt(15, 0.8), T_now_next, interval, period).centre.x(),
            boxAt(15, 0.8).centre.x());
  const SweepModel counter_clockwise{1, M_PI};
  EXPECT_GT(deskewed(boxAt(15, 0.8), T_now_next, interval, period, counter_clockwise).centre.x(),
            boxAt(15, 0.8).centre.x());
}

TEST(DetectionDeskew, TurnsCovariancesAlongAndChecksTimes)
{
  std::vector<Detection> detections(1);
  detections[0].box = boxAt(10, -M_PI / 2);
  detections[0].covariance = Eigen::Vector4d(0.04, 0.01, 0.02, 0.03).asDiagonal();
  const Pose turn = poseFromYpr(0, 0, 0, 0.4, 0, 0);
  deskewDetections(detections, turn, 0.1, 0.1);
  // A quarter of a revolution later: the vehicle had turned by 0.1 rad.
  EXPECT_NEAR(detections[0].box.yaw, 0.5, 1e-12);
  const Eigen::Vector2d x(std::cos(0.1), std::sin(0.1));
  EXPECT_NEAR(x.dot(detections[0].covariance.topLeftCorner<2, 2>() * x), 0.04, 1e-12);
  EXPECT_THROW(deskewDetections(detections, turn, 0, 0.1), std::invalid_argument);
  EXPECT_THROW(deskewDetections(detections, turn, 0.1, -0.1), std::invalid_argument);
}

/** The sweep of scans is modelled once: here in double precision, around the stamp. */
TEST(DetectionDeskew, SweepTimeIsThatOfThePoints)
{
  constexpr double period = 0.1;
  for (const SweepModel& model : {SweepModel{}, SweepModel{1, M_PI}, SweepModel{-1, 1.0}})
  {
    for (const double azimuth : {-3.0, -1.2, 0.0, 0.4, 2.9})
    {
      const Eigen::Vector3f p = boxAt(10, azimuth).centre.cast<float>();
      EXPECT_NEAR((static_cast<double>(sweepFraction(p, model)) - 0.5) * period,
                  sweepTime(azimuth, period, model), 1e-5);
    }
  }
}
