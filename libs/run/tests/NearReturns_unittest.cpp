// SPDX-License-Identifier: BSD-3-Clause
#include "../src/outputs/NearReturns.h"

#include <dyslam/core/ScanParts.h>
#include <gtest/gtest.h>

#include <algorithm>

namespace dyslam
{
namespace
{
constexpr float min_range = 1.5F;

/** A frame whose cloud has the returns from `min_range` on. */
Frame frameOf(const std::vector<Eigen::Vector3f>& points)
{
  Frame frame;
  frame.scan.points = points;
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    if (isReturn(points[i]) && points[i].norm() >= min_range)
    {
      frame.cloud.source.push_back(static_cast<std::uint32_t>(i));
      frame.cloud.points.push_back(points[i]);
    }
  }
  return frame;
}

/** Returns of an upright surface from (x, y0) to (x, y1). */
void addWall(float x, float y0, float y1, std::vector<Eigen::Vector3f>& points)
{
  for (float y = y0; y <= y1; y += 0.1F)
  {
    for (float z = -0.5F; z <= 0.5F; z += 0.1F)
    {
      points.emplace_back(x, y, z);
    }
  }
}

TEST(NearReturns, ContinueWhatMoves)
{
  std::vector<Eigen::Vector3f> points;
  addWall(0.6F, -0.8F, 2.5F, points);  // a vehicle that passes
  const std::size_t body = points.size();
  addWall(-0.7F, -0.5F, 0.5F, points);  // the sensor's own, which touches nothing
  const std::size_t own = points.size();
  addWall(0.6F, -3.5F, -2.6F, points);  // a house
  const Frame frame = frameOf(points);
  const Label car = makeLabel(252, 7);
  std::vector<Label> labels(points.size(), 0);
  for (const std::uint32_t i : frame.cloud.source)
  {
    labels[i] = i < body ? car : label_static;
  }
  std::size_t near = 0;
  labelNearReturns(frame, labels);
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    near += i < body && points[i].norm() < min_range ? 1 : 0;
    EXPECT_EQ(labels[i], i < body ? car : i < own ? 0U : label_static) << points[i].transpose();
  }
  EXPECT_GT(near, 100U);
}

TEST(NearReturns, OfAFurtherLidarAreThoseAroundIt)
{
  std::vector<Eigen::Vector3f> seen;
  addWall(0.6F, -0.8F, 2.5F, seen);  // a vehicle that passes the second lidar
  const std::size_t body = seen.size();
  addWall(-0.7F, -0.5F, 0.5F, seen);  // the second lidar's own
  Frame frame;
  addWall(5, -1, 1, frame.scan.points);  // a house before the first
  frame.cloud = frameOf(frame.scan.points).cloud;
  const std::size_t first = frame.scan.size();
  Scan further;
  further.points = seen;
  further.T_vehicle_lidar = poseFromYpr(-4, 1, 0, M_PI, 0, 0);
  appendScan(further, 1, frame.scan);
  std::vector<Label> labels(frame.scan.size(), label_static);
  std::fill(labels.begin() + static_cast<std::ptrdiff_t>(first), labels.end(), 0);
  const Label car = makeLabel(252, 7);
  for (const std::uint32_t i : frameOf(seen).cloud.source)
  {
    frame.cloud.source.push_back(static_cast<std::uint32_t>(first + i));
    frame.cloud.points.push_back(frame.scan.points[first + i]);
    labels[first + i] = car;
  }
  labelNearReturns(frame, labels);
  for (std::size_t i = 0; i < labels.size(); ++i)
  {
    EXPECT_EQ(labels[i], i < first ? label_static : i < first + body ? car : 0U) << i;
  }
}

TEST(NearReturns, StayUnlabelledBesideWhatIsStaticOrNoObject)
{
  std::vector<Eigen::Vector3f> points;
  addWall(0.6F, -2.5F, 2.5F, points);
  points.emplace_back(0.0F, 0.0F, 0.0F);  // no return
  const Frame frame = frameOf(points);
  for (const Label of_cloud : {label_static, label_moving})
  {
    std::vector<Label> labels(points.size(), 0);
    for (const std::uint32_t i : frame.cloud.source)
    {
      labels[i] = of_cloud;
    }
    const std::vector<Label> before = labels;
    labelNearReturns(frame, labels);
    EXPECT_EQ(labels, before) << of_cloud;
  }
}

TEST(NearReturns, AFrameWithoutACloudIsLeftAsItIs)
{
  std::vector<Eigen::Vector3f> points;
  addWall(0.6F, -0.5F, 0.5F, points);
  const Frame frame = frameOf(points);
  ASSERT_TRUE(frame.cloud.source.empty());
  std::vector<Label> labels(points.size(), 0);
  labelNearReturns(frame, labels);
  EXPECT_EQ(labels, std::vector<Label>(points.size(), 0));
}
}  // namespace
}  // namespace dyslam
