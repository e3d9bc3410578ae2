// SPDX-License-Identifier: BSD-3-Clause
#include "../src/results/RunHistory.h"

#include <gtest/gtest.h>

#include <vector>

namespace dyslam
{
namespace
{
TEST(RunHistory, KeepsPastObjectsOnDisk)
{
  MemoryLimit tiny;
  tiny.file = std::make_shared<SwapFile>(testing::TempDir());
  tiny.bytes = 1;
  RunHistory history(tiny);
  constexpr std::size_t scans = 5000;
  for (std::size_t i = 0; i < scans; ++i)
  {
    Frame frame;
    frame.index = 10 + i;
    frame.scan.stamp = static_cast<double>(i);
    frame.scan.T_vehicle_lidar.translation().z() = i < 3 ? 1.5 : 1.7;
    frame.moving = {true, false, true};
    frame.cloud.points.resize(3);
    for (int id = 0; id < 3; ++id)
    {
      TrackedObject object;
      object.id = id;
      object.reported = id != 1;
      object.dynamic = id == 2;
      object.box.centre.x() = static_cast<double>(i);
      object.velocity.y() = 0.5;
      object.score = 0.25;
      frame.objects.push_back(object);
    }
    history.addScan(frame);
    history.addObjects(frame.index, frame.objects, TrackLife::reported);
  }
  ASSERT_EQ(history.scans().size(), scans);
  EXPECT_EQ(history.scans()[7].index, 17U);
  EXPECT_EQ(history.scans()[7].moving_points, 2U);
  EXPECT_EQ(history.mounts().size(), 2U);
  EXPECT_EQ(history.scans()[7].mount, 1U);
  EXPECT_GT(tiny.file->size(), 100000U);
  std::size_t count = 0;
  history.forEachObject(
      [&](const PastObject& object)
      {
        EXPECT_EQ(object.scan, count / 2);
        EXPECT_EQ(object.id, count % 2 == 0 ? 0 : 2);
        EXPECT_EQ(object.box.centre.x(), static_cast<double>(count / 2));
        EXPECT_EQ(object.tracked().velocity.y(), 0.5);
        EXPECT_EQ(object.score, 0.25);
        EXPECT_EQ(object.dynamic, count % 2 == 1);
        EXPECT_TRUE(object.tracked().reported);
        ++count;
      });
  EXPECT_EQ(count, 2 * scans);
}

/** Object 7 at some scans: observed in 2 to 7 but for 4 and 5, reported in 3, 4 and 6 to 9. */
TrackedObject sevenAt(std::size_t scan)
{
  TrackedObject object;
  object.id = 7;
  object.observed = scan >= 2 && scan <= 7 && scan != 4 && scan != 5;
  object.reported = scan == 3 || scan == 4 || scan >= 6;
  object.dynamic = scan >= 6;
  return object;
}

std::vector<std::size_t> scansOfSeven(TrackLife life)
{
  RunHistory history;
  for (std::size_t i = 0; i < 12; ++i)
  {
    Frame frame;
    frame.index = i;
    history.addScan(frame);
    std::vector<TrackedObject> objects;
    if (i >= 2 && i <= 9)
    {
      objects.push_back(sevenAt(i));
    }
    TrackedObject never_reported;
    never_reported.id = 1;
    never_reported.observed = true;
    objects.push_back(never_reported);
    history.addObjects(i, objects, life);
  }
  std::vector<std::size_t> scans;
  history.forEachObject(
      [&](const PastObject& object)
      {
        EXPECT_EQ(object.id, 7);
        scans.push_back(object.scan);
      });
  return scans;
}

TEST(RunHistory, TracksCountWhereReportedOrFromFirstToLastObservation)
{
  EXPECT_EQ(scansOfSeven(TrackLife::reported), (std::vector<std::size_t>{3, 4, 6, 7, 8, 9}));
  EXPECT_EQ(scansOfSeven(TrackLife::whole), (std::vector<std::size_t>{2, 3, 4, 5, 6, 7}));
}

TEST(RunHistory, OfMergedTracksTheObservedOneCounts)
{
  RunHistory history;
  for (std::size_t i = 0; i < 3; ++i)
  {
    Frame frame;
    frame.index = i;
    for (const int id : {2, 5, 6})
    {
      TrackedObject object;
      object.id = id;
      object.reported = true;
      object.observed = id == 2 ? i == 0 : i <= 1;
      object.score = id;  // tells which track it was
      frame.objects.push_back(object);
    }
    history.addScan(frame);
    history.addObjects(i, frame.objects, TrackLife::reported);
  }
  std::vector<std::vector<int>> seen;  // scan, id, track
  history.forEachObject(
      {{6, 2}},
      [&](const PastObject& object) {
        seen.push_back({static_cast<int>(object.scan), object.id, static_cast<int>(object.score)});
      });
  const std::vector<std::vector<int>> expected = {{0, 2, 2}, {0, 5, 5}, {1, 2, 6},
                                                  {1, 5, 5}, {2, 2, 2}, {2, 5, 5}};
  EXPECT_EQ(seen, expected);
}
}  // namespace
}  // namespace dyslam
