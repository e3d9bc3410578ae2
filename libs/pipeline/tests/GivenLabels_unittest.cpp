// SPDX-License-Identifier: BSD-3-Clause
#include "../src/GivenLabels.h"

#include <dyslam/base/Error.h>
#include <dyslam/core/Labels.h>
#include <dyslam/formats/LabelFiles.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "TestFolder.h"

namespace dyslam
{
namespace
{
constexpr Label moving_car = 252;

Frame frameOf(std::size_t points)
{
  Frame frame;
  frame.index = 7;
  for (std::size_t i = 0; i < points; ++i)
  {
    frame.scan.points.emplace_back(1 + static_cast<float>(i), 2.0F, 3.0F);
    frame.scan.intensity.push_back(0.1F * static_cast<float>(i));
  }
  return frame;
}

/** All returns of a scan. */
Cloud cloudOf(const Scan& scan)
{
  Cloud cloud;
  for (std::size_t i = 0; i < scan.size(); ++i)
  {
    if (isReturn(scan.points[i]))
    {
      cloud.points.push_back(scan.points[i]);
      cloud.intensity.push_back(scan.intensity[i]);
      cloud.source.push_back(static_cast<std::uint32_t>(i));
    }
  }
  return cloud;
}

TEST(GivenLabels, TakeMovingPointsOutAndPutThemBack)
{
  const TestFolder folder;
  std::filesystem::create_directories(folder.file("run/labels"));
  writeLabels(folder.file("run/labels/000007.label"), {9, moving_car, 9, 0, moving_car});
  Frame frame = frameOf(5);
  const Frame before = frame;

  LabelledPoints moving = GivenLabels(folder.file("run")).pointsOf(frame);
  frame.cloud = cloudOf(frame.scan);
  frame.cloud.phase = {0, 0.2F, 0.4F, 0.6F, 0.8F};
  moving.takeFrom(frame.cloud);
  moving.takeFrom(frame.scan);
  EXPECT_FALSE(isReturn(frame.scan.points[1]));
  EXPECT_EQ(frame.cloud.source, (std::vector<std::uint32_t>{0, 2, 3}));
  frame.moving_probability = {0.1F, 0.2F, 0.3F};

  moving.putBack(frame);
  EXPECT_EQ(frame.scan.points, before.scan.points);
  EXPECT_EQ(frame.cloud.source, (std::vector<std::uint32_t>{0, 1, 2, 3, 4}));
  EXPECT_EQ(frame.cloud.points, before.scan.points);
  EXPECT_EQ(frame.cloud.intensity, before.scan.intensity);
  EXPECT_EQ(frame.cloud.phase, (std::vector<float>{0, 0.2F, 0.4F, 0.6F, 0.8F}));
  ASSERT_EQ(frame.moving_probability.size(), 5U);
  EXPECT_EQ(frame.moving_probability[2], 0.2F);
  EXPECT_GT(frame.moving_probability[1], 0.9F);
  EXPECT_GT(frame.moving_probability[4], 0.9F);
  EXPECT_TRUE(frame.static_prior.empty()) << "the segmenter gave none";
}

TEST(GivenLabels, PutBackAScanOfWhichAllPointsMove)
{
  const TestFolder folder;
  writeLabels(folder.file("000007.label"), {moving_car, moving_car});
  Frame frame = frameOf(2);
  const Frame before = frame;
  LabelledPoints moving = GivenLabels(folder.path()).pointsOf(frame);
  frame.cloud = cloudOf(frame.scan);
  frame.cloud.intensity.clear();  // the recording has none
  moving.takeFrom(frame.cloud);
  moving.takeFrom(frame.scan);
  moving.putBack(frame);
  EXPECT_EQ(frame.cloud.points, before.scan.points);
  EXPECT_EQ(frame.cloud.source, (std::vector<std::uint32_t>{0, 1}));
  EXPECT_TRUE(frame.cloud.intensity.empty());
  EXPECT_TRUE(frame.cloud.phase.empty());
}

TEST(GivenLabels, AreOfTheSameScans)
{
  const TestFolder folder;
  EXPECT_EQ(messageOfError<UserError>([&] { (void)GivenLabels{folder.path()}; })
                .rfind("dyseg.labels: " + folder.path() + ": has no labels", 0),
            0U);
  writeLabels(folder.file("000007.label"), {9, moving_car});
  const GivenLabels labels(folder.path());
  Frame longer = frameOf(3);
  EXPECT_THROW((void)labels.pointsOf(longer), UserError);
  Frame another = frameOf(2);
  another.index = 8;
  EXPECT_THROW((void)labels.pointsOf(another), UserError);
}

TEST(GivenLabels, NumbersOfALearningMapAreWarnedOf)
{
  const TestFolder folder;
  writeLabels(folder.file("000000.label"), {1, 1, 0});
  EXPECT_TRUE(GivenLabels(folder.path()).warnings().empty()) << "nothing moves";
  writeLabels(folder.file("000001.label"), {1, 2, 0});
  const std::vector<std::string> said = GivenLabels(folder.path()).warnings();
  ASSERT_EQ(said.size(), 1U);
  EXPECT_EQ(
      said[0].rfind("dyseg.labels: no label of " + folder.path() + " is of a moving class", 0), 0U)
      << said[0];
  writeLabels(folder.file("000002.label"), {9, moving_car});
  EXPECT_TRUE(GivenLabels(folder.path()).warnings().empty());
  EXPECT_TRUE(GivenLabels("").warnings().empty());
}

TEST(GivenLabels, WithoutAFolderNothingChanges)
{
  const GivenLabels none("");
  EXPECT_FALSE(none.any());
  Frame frame = frameOf(2);
  const Frame before = frame;
  LabelledPoints moving = none.pointsOf(frame);
  frame.cloud = cloudOf(frame.scan);
  moving.takeFrom(frame.cloud);
  moving.takeFrom(frame.scan);
  EXPECT_EQ(frame.scan.points, before.scan.points);
  EXPECT_EQ(frame.cloud.points, before.scan.points);
  moving.putBack(frame);
  EXPECT_EQ(frame.cloud.points, before.scan.points);
}
}  // namespace
}  // namespace dyslam
