// SPDX-License-Identifier: BSD-3-Clause
#include "PackedPoints.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace dyslam
{
namespace
{
constexpr float nan = std::numeric_limits<float>::quiet_NaN();

double coordinate(const PackedPoints& packed, std::size_t i, int axis)
{
  const std::size_t at = 2 * (packed.count * static_cast<std::size_t>(axis) + i);
  const int number = static_cast<unsigned char>(packed.bytes[at]) +
                     256 * static_cast<unsigned char>(packed.bytes[at + 1]);
  return packed.low[axis] + packed.step[axis] * number;
}

TEST(PackedPoints, AreWithinHalfAStepOfThePoints)
{
  std::vector<Eigen::Vector3f> points;
  std::vector<float> intensity;
  for (int i = 0; i < 1000; ++i)
  {
    const auto t = static_cast<float>(i);
    points.emplace_back(-300 + 0.71F * t, 40 * std::sin(t), 2);
    intensity.push_back(t / 999);
  }
  const PackedPoints packed = packPoints(points, &intensity, 1000);
  ASSERT_EQ(packed.count, 1000U);
  ASSERT_EQ(packed.bytes.size(), 7000U);
  EXPECT_EQ(packed.voxel_size, 0);
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      EXPECT_NEAR(coordinate(packed, i, axis), static_cast<double>(points[i][axis]),
                  0.5 * packed.step[axis] + 1e-6);
    }
    EXPECT_NEAR(static_cast<unsigned char>(packed.bytes[6000 + i]) / 255.0,
                static_cast<double>(intensity[i]), 0.5 / 255 + 1e-6);
  }
  EXPECT_NEAR(packed.step.x(), 0.71 * 999 / 65535, 1e-6);
}

TEST(PackedPoints, LeaveOutWhatIsNotFinite)
{
  const PackedPoints packed = packPoints({{1, 2, 3}, {nan, 0, 0}, {4, 5, 6}}, nullptr, 10);
  ASSERT_EQ(packed.count, 2U);
  EXPECT_NEAR(coordinate(packed, 1, 2), 6, 1e-3);
  EXPECT_EQ(packPoints({{nan, nan, nan}}, nullptr, 10).count, 0U);
  EXPECT_EQ(packPoints({}, nullptr, 10).bytes, "");
}

TEST(PackedPoints, KeepWithinTheLimitAndSpreadEvenly)
{
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 100; ++i)
  {
    for (int k = 0; k < 100; ++k)
    {
      points.emplace_back(0.1F * static_cast<float>(i), 0.1F * static_cast<float>(k), 0);
    }
  }
  const PackedPoints packed = packPoints(points, nullptr, 2000);
  EXPECT_LE(packed.count, 2000U);
  EXPECT_GT(packed.count, 1000U);
  EXPECT_GT(packed.voxel_size, 0.2);
  EXPECT_NEAR(coordinate(packed, packed.count - 1, 0), 9.9, 2 * packed.voxel_size);
}

/** A room: its ceiling is given first, and packed last. */
TEST(PackedPoints, OfCeilingsAreTheLastOnes)
{
  std::vector<Eigen::Vector3f> points;
  std::vector<float> intensity;
  for (const float height : {3.0F, 0.0F})
  {
    for (int i = 0; i < 6000; ++i)
    {
      points.emplace_back(0.1F * static_cast<float>(i % 100), 0.1F * static_cast<float>(i / 100),
                          height);
      intensity.push_back(height / 3);
    }
  }
  for (const std::size_t most : {20000U, 5000U})
  {
    const PackedPoints packed = packPoints(points, &intensity, most);
    ASSERT_GT(packed.ceilings, packed.count / 3);
    ASSERT_LT(packed.ceilings, packed.count);
    const std::size_t others = packed.count - packed.ceilings;
    for (std::size_t i = others; i < packed.count; ++i)
    {
      ASSERT_NEAR(coordinate(packed, i, 2), 3, 1e-3) << i;
      ASSERT_EQ(static_cast<unsigned char>(packed.bytes[6 * packed.count + i]), 255) << i;
    }
    EXPECT_NEAR(coordinate(packed, 0, 2), 3, 1e-3) << "a corner";
    EXPECT_NEAR(coordinate(packed, others - 1, 2), 0, 1e-3);
  }
  points.resize(100);
  EXPECT_EQ(packPoints(points, nullptr, 20000).ceilings, 0U) << "no floor below";
}

TEST(PackedPoints, RefuseWhatDoesNotFit)
{
  const std::vector<float> one{0.5F};
  EXPECT_THROW((void)packPoints({{0, 0, 0}, {1, 1, 1}}, &one, 10), std::invalid_argument);
  EXPECT_THROW((void)packPoints({{0, 0, 0}}, nullptr, 0), std::invalid_argument);
}

TEST(Base64, AgreesWithTheVectorsOfRfc4648)
{
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foob"), "Zm9vYg==");
  EXPECT_EQ(base64("fooba"), "Zm9vYmE=");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64("\xff\xfe\xfd"), "//79");
}
}  // namespace
}  // namespace dyslam
