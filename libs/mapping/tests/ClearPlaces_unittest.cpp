// SPDX-License-Identifier: BSD-3-Clause
#include "../src/ClearPlaces.h"

#include <dyslam/core/StateArchive.h>
#include <gtest/gtest.h>

#include <string>

namespace dyslam
{
namespace
{
constexpr std::uint64_t place = 42;

TEST(ClearPlaces, AreKnownForSixToTenScans)
{
  for (std::size_t found = 0; found < 5; ++found)
  {
    ClearPlaces clear;
    std::size_t lasted = 0;
    for (std::size_t scan = 0; scan < 30; ++scan)
    {
      clear.beginScan(scan);
      if (scan == found)
      {
        clear.add(place);
      }
      lasted += clear.contain(place) ? 1 : 0;
    }
    EXPECT_EQ(lasted, 10 - found) << "found at scan " << found;
  }
}

TEST(ClearPlaces, AreForgottenWhereNumbersAreLeftOut)
{
  for (const std::size_t next : {10U, 100U})
  {
    ClearPlaces clear;
    clear.beginScan(0);
    clear.add(place);
    clear.beginScan(next);
    EXPECT_FALSE(clear.contain(place)) << next;
    clear.add(place);
    EXPECT_TRUE(clear.contain(place)) << next;
  }
  ClearPlaces clear;
  clear.beginScan(0);
  clear.add(place);
  clear.beginScan(9);
  EXPECT_TRUE(clear.contain(place));
}

TEST(ClearPlaces, StayKnownAfterResuming)
{
  ClearPlaces clear;
  clear.beginScan(3);
  clear.add(place);
  StateArchive saved;
  clear.exchangeState(saved);
  ClearPlaces resumed;
  const std::string bytes(saved.bytes());
  StateArchive loaded{bytes};
  resumed.exchangeState(loaded);
  EXPECT_TRUE(resumed.contain(place));
  EXPECT_FALSE(resumed.contain(place + 1));
}
}  // namespace
}  // namespace dyslam
