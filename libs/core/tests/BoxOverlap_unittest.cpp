// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Angle.h>
#include <dyslam/core/BoxOverlap.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

using namespace dyslam;

namespace
{
Box makeBox(double x, double y, double z, double l, double w, double h, double yaw)
{
  Box box;
  box.centre = {x, y, z};
  box.size = {l, w, h};
  box.yaw = yaw;
  return box;
}

bool contains(const Box& box, const Eigen::Vector3d& p)
{
  const Eigen::Vector3d d = p - box.centre;
  const double along = std::cos(box.yaw) * d.x() + std::sin(box.yaw) * d.y();
  const double across = -std::sin(box.yaw) * d.x() + std::cos(box.yaw) * d.y();
  return std::abs(along) <= 0.5 * box.size.x() && std::abs(across) <= 0.5 * box.size.y() &&
         std::abs(d.z()) <= 0.5 * box.size.z();
}
}  // namespace

TEST(BoxOverlap, knownCases)
{
  const Box a = makeBox(1000, -500, 0, 4, 2, 1.5, 0.3);
  EXPECT_NEAR(boxOverlap(a, a).iou, 1, 1e-12);
  EXPECT_NEAR(boxOverlap(a, a).giou, 1, 1e-12);
  Box turned = a;
  turned.yaw += M_PI;
  EXPECT_NEAR(boxIou(a, turned), 1, 1e-9);
  const Box b = makeBox(0, 0, 0, 2, 2, 2, 0);
  const Box c = makeBox(1, 0, 0, 2, 2, 2, 0);
  EXPECT_NEAR(boxOverlap(b, c).iou, 4.0 / 12, 1e-12);
  EXPECT_NEAR(boxOverlap(b, c).giou, 4.0 / 12, 1e-12);  // the hull is the union
  const Box far = makeBox(4, 0, 0, 2, 2, 2, 0);
  EXPECT_EQ(boxOverlap(b, far).iou, 0);
  EXPECT_NEAR(boxOverlap(b, far).giou, -(24.0 - 16) / 24, 1e-12);
  // A square turned by 45 degrees meets itself in a regular octagon.
  const double octagon = 8 * (std::sqrt(2.0) - 1);
  Box diamond = b;
  diamond.yaw = M_PI / 4;
  EXPECT_NEAR(boxOverlap(b, diamond).ground_iou, octagon / (8 - octagon), 1e-9);
}

TEST(BoxOverlap, agreesWithCounting)
{
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> offset(-2, 2);
  std::uniform_real_distribution<double> size(1, 4);
  std::uniform_real_distribution<double> angle(-4, 4);
  for (int trial = 0; trial < 12; ++trial)
  {
    const Box a =
        makeBox(0, 0, 0, size(generator), size(generator), size(generator), angle(generator));
    const Box b = makeBox(offset(generator), offset(generator), 0.5 * offset(generator),
                          size(generator), size(generator), size(generator), angle(generator));
    std::uniform_real_distribution<double> place(-5, 5);
    int both = 0;
    int any = 0;
    for (int i = 0; i < 200000; ++i)
    {
      const Eigen::Vector3d p(place(generator), place(generator), 0.6 * place(generator));
      const bool in_a = contains(a, p);
      const bool in_b = contains(b, p);
      both += in_a && in_b ? 1 : 0;
      any += in_a || in_b ? 1 : 0;
    }
    const BoxOverlap overlap = boxOverlap(a, b);
    EXPECT_NEAR(overlap.iou, static_cast<double>(both) / any, 0.02);
    EXPECT_NEAR(overlap.iou, boxIou(a, b), 1e-12);
    EXPECT_NEAR(overlap.iou, boxIou(b, a), 1e-9);
    EXPECT_LE(overlap.giou, overlap.iou + 1e-12);
    EXPECT_GT(overlap.giou, -1);
  }
}

TEST(BoxOverlap, nothingForNaNAndFlatBoxes)
{
  const Box a = makeBox(0, 0, 0, 2, 2, 2, 0);
  Box bad = a;
  bad.centre.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(boxIou(a, bad), 0);
  EXPECT_EQ(boxOverlap(bad, a).giou, -1);
  Box flat = a;
  flat.size.z() = 0;
  EXPECT_EQ(boxIou(a, flat), 0);
}

TEST(BoxOverlap, transformedMovesCentreAndYaw)
{
  const Box a = makeBox(3, 0, 1, 4, 2, 1.5, 0.2);
  const Box moved = transformed(a, poseFromYpr(10, 20, 0, M_PI / 2, 0, 0));
  EXPECT_NEAR((moved.centre - Eigen::Vector3d(10, 23, 1)).norm(), 0, 1e-12);
  EXPECT_NEAR(wrapAngle(moved.yaw - 0.2 - M_PI / 2), 0, 1e-12);
  EXPECT_EQ(moved.size, a.size);
}

/** Also between frames that are tilted against each other, or upside down. */
TEST(BoxOverlap, transformedHasAnInverse)
{
  for (const Pose& T : {poseFromYpr(1, 2, 3, 0.4, 0, 0), poseFromYpr(0, 1, 0, -2, 0.35, -0.2),
                        poseFromYpr(0, 0, 2, 0.1, 0.05, M_PI)})
  {
    for (int i = -6; i <= 6; ++i)
    {
      const Box box = makeBox(5, -3, 1, 4, 2, 1.5, 0.5 * i);
      const Box back = transformedBack(transformed(box, T), T);
      EXPECT_NEAR((back.centre - box.centre).norm(), 0, 1e-9);
      EXPECT_NEAR(wrapAngle(back.yaw - box.yaw), 0, 1e-9);
      EXPECT_EQ(box.size, back.size);
    }
  }
}
