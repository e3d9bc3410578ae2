// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/io/LiveScene.h>
#include <gtest/gtest.h>
#include <mrpt/opengl/COpenGLScene.h>
#include <mrpt/opengl/CPointCloudColoured.h>
#include <mrpt/opengl/CSetOfLines.h>
#include <mrpt/opengl/CText.h>

#include <vector>

namespace dyslam
{
namespace
{
/** A post of 100 points 5 m beside the vehicle, and ten moving points ahead of it.
 * \param x of the vehicle [m] */
Frame frameAt(std::size_t index, double x)
{
  Frame frame;
  frame.index = index;
  frame.scan.stamp = 100 + 0.1 * static_cast<double>(index);
  frame.T_odom_vehicle.translation().x() = x;
  for (int i = 0; i < 100; ++i)
  {
    frame.cloud.points.emplace_back(0, 5, 0.3F * static_cast<float>(i));
    frame.moving.push_back(false);
  }
  for (int i = 0; i < 10; ++i)
  {
    frame.cloud.points.emplace_back(8, static_cast<float>(i), 0);
    frame.moving.push_back(true);
  }
  return frame;
}

/** Numbers of points of the clouds, in the order of the scene: parts of the map, moving points. */
std::vector<std::size_t> cloudSizes(const mrpt::opengl::COpenGLScene& scene)
{
  std::vector<std::size_t> sizes;
  for (const auto& object : *scene.getViewport())
  {
    if (const auto cloud = std::dynamic_pointer_cast<mrpt::opengl::CPointCloudColoured>(object))
    {
      sizes.push_back(cloud->size());
    }
  }
  return sizes;
}
}  // namespace

TEST(LiveScene, HasEveryStaticPlaceOnceAndTheNewestMovingPoints)
{
  LiveScene scene;
  EXPECT_EQ((std::vector<std::size_t>{100, 10}), cloudSizes(*scene.add(frameAt(0, 0))));
  EXPECT_EQ((std::vector<std::size_t>{100, 10}), cloudSizes(*scene.add(frameAt(1, 0))));
  EXPECT_EQ((std::vector<std::size_t>{200, 10}), cloudSizes(*scene.add(frameAt(2, 4))));
  EXPECT_EQ(Eigen::Vector3d(4, 0, 0), scene.vehiclePosition());
}

TEST(LiveScene, MapIsThatOfTheLast200Metres)
{
  LiveScene scene;
  std::vector<std::size_t> sizes;
  for (std::size_t i = 0; i < 40; ++i)
  {
    sizes = cloudSizes(*scene.add(frameAt(i, 11.0 * static_cast<double>(i))));
  }
  std::vector<std::size_t> expected(20, 100);
  expected.push_back(10);
  EXPECT_EQ(expected, sizes);
}

TEST(LiveScene, AnEarlierIndexBeginsANewScene)
{
  LiveScene scene;
  (void)scene.add(frameAt(0, 0));
  (void)scene.add(frameAt(1, 4));
  EXPECT_EQ((std::vector<std::size_t>{100, 10}), cloudSizes(*scene.add(frameAt(0, 2))));
}

TEST(LiveScene, ReportedObjectsHaveBoxAndLabel)
{
  LiveScene scene;
  Frame frame = frameAt(0, 0);
  TrackedObject object;
  object.id = 7;
  object.object_class = ObjectClass::car;
  object.velocity = {3, 4, 0};
  object.dynamic = true;
  object.reported = true;
  frame.objects = {object, object};
  frame.objects[1].reported = false;
  const auto drawn = scene.add(frame);
  EXPECT_TRUE(drawn->getByClass<mrpt::opengl::CSetOfLines>());
  const auto label = drawn->getByClass<mrpt::opengl::CText>();
  ASSERT_TRUE(label);
  EXPECT_EQ("Car 7: 5.0 m/s", label->getString());
  EXPECT_FALSE(drawn->getByClass<mrpt::opengl::CText>(1));
}

TEST(LiveScene, AFrameWithoutAPoseKeepsTheMap)
{
  LiveScene scene;
  (void)scene.add(frameAt(0, 0));
  Frame lost = frameAt(1, 0);
  lost.T_odom_vehicle.translation().x() = std::nan("");
  EXPECT_EQ(100U, cloudSizes(*scene.add(lost)).front());
  EXPECT_EQ(Eigen::Vector3d(0, 0, 0), scene.vehiclePosition());
}
}  // namespace dyslam
