// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/tracking/TrackMerging.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace dyslam
{
namespace
{
constexpr double overlap = 0.3;

Box boxAt(double x, double y = 0, double length = 4, double yaw = 0)
{
  Box box;
  box.centre = {x, y, 0.8};
  box.size = {length, 1.8, 1.5};
  box.yaw = yaw;
  return box;
}

TEST(TrackMerging, TracksAtTheSamePlaceAreOneObject)
{
  std::vector<TrackBox> boxes;
  for (std::size_t scan = 0; scan < 10; ++scan)
  {
    const double x = static_cast<double>(scan);
    boxes.push_back({scan, 8, boxAt(x)});
    boxes.push_back({scan, 3, boxAt(x + 1, 0.2, 1.5, 0.4)});  // a part of it
    boxes.push_back({scan, 5, boxAt(x + 5)});                 // the next vehicle in the lane
    boxes.push_back({scan, 1, boxAt(x, 2.2)});                // in the lane beside
  }
  const std::map<int, int> expected = {{8, 3}};
  EXPECT_EQ(findMergedTracks(boxes, overlap), expected);
  std::reverse(boxes.begin(), boxes.end());
  EXPECT_EQ(findMergedTracks(boxes, overlap), expected);
  EXPECT_TRUE(findMergedTracks(boxes, 1).empty());
}

TEST(TrackMerging, AtAnOverlapOfOneNoneAreMerged)
{
  for (int i = 0; i < 100; ++i)
  {
    const double yaw = 0.06 * i;
    const double x = 1 + 7.3 * i;
    // The second box is within the first one, at any yaw.
    EXPECT_TRUE(
        findMergedTracks({{0, 1, boxAt(x, 3, 4, yaw)}, {0, 2, boxAt(x, 3, 2, yaw)}}, 1).empty())
        << i;
  }
}

TEST(TrackMerging, ObjectsThatMeetAreTwo)
{
  std::vector<TrackBox> boxes;
  for (std::size_t scan = 0; scan < 20; ++scan)
  {
    const double x = static_cast<double>(scan) - 10;
    boxes.push_back({scan, 0, boxAt(0)});
    boxes.push_back({scan, 1, boxAt(x)});  // overlaps in 5 of 20 scans
  }
  EXPECT_TRUE(findMergedTracks(boxes, overlap).empty());
  EXPECT_EQ(findMergedTracks(boxes, overlap, 0.25).size(), 1U);
}

TEST(TrackMerging, SharesAreOfTheScansWithBoth)
{
  // The second track begins where the first one is lost: they have two scans in common.
  std::vector<TrackBox> boxes;
  for (std::size_t scan = 0; scan < 20; ++scan)
  {
    boxes.push_back({scan, scan < 10 ? 4 : 6, boxAt(static_cast<double>(scan))});
  }
  boxes.push_back({10, 4, boxAt(10.3)});
  boxes.push_back({11, 4, boxAt(11.6)});
  EXPECT_EQ(findMergedTracks(boxes, overlap), (std::map<int, int>{{6, 4}}));
}

TEST(TrackMerging, IsTransitive)
{
  std::vector<TrackBox> boxes;
  for (std::size_t scan = 0; scan < 5; ++scan)
  {
    boxes.push_back({scan, 9, boxAt(0)});
    boxes.push_back({scan, 7, boxAt(2)});
    boxes.push_back({scan, 8, boxAt(4)});  // does not overlap with 9
  }
  EXPECT_EQ(findMergedTracks(boxes, overlap), (std::map<int, int>{{8, 7}, {9, 7}}));
}

TEST(TrackMerging, BoxesWithoutExtentOrPlaceOverlapNothing)
{
  EXPECT_TRUE(findMergedTracks({}, overlap).empty());
  Box flat = boxAt(0);
  flat.size.y() = 0;
  Box nowhere = boxAt(std::numeric_limits<double>::quiet_NaN());
  EXPECT_TRUE(
      findMergedTracks({{0, 1, flat}, {0, 2, boxAt(0)}, {0, 3, nowhere}, {1, 4, boxAt(0)}}, overlap)
          .empty());
}
}  // namespace
}  // namespace dyslam
