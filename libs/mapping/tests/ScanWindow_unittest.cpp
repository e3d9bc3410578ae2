// SPDX-License-Identifier: BSD-3-Clause
#include "../src/ScanWindow.h"

#include <dyslam/base/StateArchive.h>
#include <gtest/gtest.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
namespace
{
constexpr int size = 4;  // scans before, and after, the current one

/** A scan without points, as many metres along x as its number. */
Frame emptyScan(std::size_t number)
{
  Frame frame;
  frame.index = number;
  frame.T_odom_vehicle.translation().x() = static_cast<double>(number);
  return frame;
}

/** A complete window. \param number number of its current scan \param tracks objects of a scan, by
 * its number */
ScanWindow windowAt(std::size_t number,
                    int history,
                    const std::function<std::vector<TrackedObject>(std::size_t)>& tracks = {})
{
  ScanWindow window(size, history);
  for (std::size_t i = 0; i <= number + static_cast<std::size_t>(size); ++i)
  {
    Frame frame = emptyScan(i);
    if (tracks)
    {
      frame.objects = tracks(i);
    }
    EXPECT_FALSE(window.isComplete());
    window.add(frame, FrameParts::all);
    if (window.isComplete() && window.number() < number)
    {
      window.advance();
    }
  }
  EXPECT_TRUE(window.isComplete());
  EXPECT_EQ(window.number(), number);
  return window;
}

/** Distances from the scans used to the current scan [scans]; negative: later scans. */
std::vector<int> distances(const ScanWindow& window)
{
  std::vector<int> result;
  for (const OtherScan& other : window.others())
  {
    const auto distance = static_cast<int>(other.T_other_this.translation().x());
    EXPECT_EQ(other.after, distance < 0);
    result.push_back(distance);
  }
  return result;
}

TEST(ScanWindow, UsesTheScansAroundAndEveryEighthBefore)
{
  const std::vector<int> around{1, -1, 2, -2, 3, -3, 4, -4};
  std::vector<int> expected = around;
  EXPECT_EQ(distances(windowAt(30, 0)), expected);
  expected.insert(expected.end(), {6, 14});  // scans 24 and 16
  EXPECT_EQ(distances(windowAt(30, 10)), expected);
  expected.insert(expected.end(), {22, 30});  // scans 8 and 0
  EXPECT_EQ(distances(windowAt(30, 100)), expected);
}

TEST(ScanWindow, UsesFewerScansThatAreFarAway)
{
  ScanWindow window(20, 0);
  for (std::size_t i = 0; i <= 20; ++i)
  {
    window.add(emptyScan(i), FrameParts::none);
  }
  EXPECT_EQ(distances(window), (std::vector<int>{-1, -2, -3, -4, -6, -9, -13, -18}));
  EXPECT_EQ(window.lowestReturns().size(), 5U);  // scans 0, 5, 10, 15 and 20
}

TEST(ScanWindow, GivesEachFrameThatIsKeptOnce)
{
  ScanWindow window(size, 0);
  EXPECT_FALSE(window.hasCurrent());
  window.add(emptyScan(0), FrameParts::none);
  window.add(emptyScan(1), FrameParts::all);
  EXPECT_FALSE(window.takeFrame());
  window.advance();
  const std::optional<Frame> frame = window.takeFrame();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->index, 1U);
  EXPECT_FALSE(window.takeFrame());
  EXPECT_TRUE(window.hasCurrent());
  window.advance();
  EXPECT_FALSE(window.hasCurrent());
}

TEST(ScanWindow, KnowsWhatTracksEverAreWhileTheyAreInIt)
{
  const auto tracks = [](std::size_t scan)
  {
    TrackedObject object;
    object.id = 7;
    object.confirmed = true;
    object.dynamic = scan == 5;
    object.reported = scan == 3;
    return scan <= 6 ? std::vector<TrackedObject>{object} : std::vector<TrackedObject>{};
  };
  EXPECT_FALSE(windowAt(0, 0, tracks).isEverDynamic(7)) << "scan 5 is unknown";
  EXPECT_TRUE(windowAt(0, 0, tracks).isEverReported(7));
  EXPECT_TRUE(windowAt(1, 0, tracks).isEverDynamic(7));
  EXPECT_TRUE(windowAt(10, 0, tracks).isEverDynamic(7));
  EXPECT_FALSE(windowAt(11, 0, tracks).isEverDynamic(7));
  EXPECT_FALSE(windowAt(11, 0, tracks).isEverReported(7));
  EXPECT_FALSE(windowAt(10, 0, tracks).isEverReported(8));
}

TEST(ScanWindow, IsTheSameAfterResuming)
{
  ScanWindow window = windowAt(30, 100);
  StateArchive saved;
  window.exchangeState(saved);
  const std::string bytes(saved.bytes());
  StateArchive loaded{bytes};
  ScanWindow resumed(size, 100);
  resumed.exchangeState(loaded);
  EXPECT_EQ(resumed.number(), 30U);
  EXPECT_TRUE(resumed.isComplete());
  EXPECT_EQ(distances(resumed), distances(window));
  const std::optional<Frame> frame = resumed.takeFrame();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->index, 30U);
}
}  // namespace
}  // namespace dyslam
