// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/packets/PacketScans.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace dyslam
{
namespace
{
/** Points of the scans that a lidar of 10 Hz with 1800 blocks a revolution is cut to, in 0.44 s.
 * \param direction 1: clockwise, -1: counter-clockwise \param jitter the azimuth of every seventh
 * block is that much behind [0.01 deg] */
std::vector<std::size_t> scansOf(int direction, int jitter)
{
  RevolutionCutter cutter(M_PI, false);
  std::vector<std::size_t> sizes;
  for (int n = 0; n < 7900; ++n)
  {
    const int azimuth = direction * (20 * n - (n % 7 == 0 ? jitter : 0));
    const double stamp = 1000 + 0.1 / 1800 * n;
    cutter.scanOf((azimuth % 36000 + 36000) % 36000, stamp).points.emplace_back(1, 0, 0);
  }
  cutter.finish();
  while (const auto scan = cutter.take())
  {
    sizes.push_back(scan->size());
  }
  return sizes;
}

TEST(RevolutionCutter, JitterOfTheAzimuthCutsNothing)
{
  for (const int direction : {1, -1})
  {
    for (const int jitter : {0, 21, 45})
    {
      const std::vector<std::size_t> sizes = scansOf(direction, jitter);
      ASSERT_EQ(3U, sizes.size()) << direction << ", " << jitter;
      for (const std::size_t size : sizes)
      {
        EXPECT_NEAR(1800, static_cast<double>(size), 3) << direction << ", " << jitter;
      }
    }
  }
}
}  // namespace
}  // namespace dyslam
