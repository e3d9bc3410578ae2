// SPDX-License-Identifier: BSD-3-Clause
#include "../src/ClearVoxels.h"

#include <dyslam/base/StateArchive.h>
#include <gtest/gtest.h>

#include <string>

namespace dyslam
{
namespace
{
constexpr std::uint64_t found_voxel = 42;

TEST(ClearVoxels, AreKnownForSixToTenScans)
{
  for (std::size_t found = 0; found < 5; ++found)
  {
    ClearVoxels clear;
    std::size_t lasted = 0;
    for (std::size_t scan = 0; scan < 30; ++scan)
    {
      clear.beginScan(scan);
      if (scan == found)
      {
        clear.add(found_voxel);
      }
      lasted += clear.contain(found_voxel) ? 1 : 0;
    }
    EXPECT_EQ(lasted, 10 - found) << "found at scan " << found;
  }
}

TEST(ClearVoxels, AreForgottenWhereNumbersAreLeftOut)
{
  for (const std::size_t next : {10U, 100U})
  {
    ClearVoxels clear;
    clear.beginScan(0);
    clear.add(found_voxel);
    clear.beginScan(next);
    EXPECT_FALSE(clear.contain(found_voxel)) << next;
    clear.add(found_voxel);
    EXPECT_TRUE(clear.contain(found_voxel)) << next;
  }
  ClearVoxels clear;
  clear.beginScan(0);
  clear.add(found_voxel);
  clear.beginScan(9);
  EXPECT_TRUE(clear.contain(found_voxel));
}

TEST(ClearVoxels, StayKnownAfterResuming)
{
  ClearVoxels clear;
  clear.beginScan(3);
  clear.add(found_voxel);
  StateArchive saved;
  clear.exchangeState(saved);
  ClearVoxels resumed;
  const std::string bytes(saved.bytes());
  StateArchive loaded{bytes};
  resumed.exchangeState(loaded);
  EXPECT_TRUE(resumed.contain(found_voxel));
  EXPECT_FALSE(resumed.contain(found_voxel + 1));
}
}  // namespace
}  // namespace dyslam
