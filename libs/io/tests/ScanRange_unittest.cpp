// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/io/ScanRange.h>
#include <gtest/gtest.h>

#include <vector>

namespace dyslam
{
namespace
{
/** Numbers of the scans taken out of twenty, 0.1 s apart from 1000 s on. */
std::vector<std::size_t> taken(const ScanRange& range, int every_n = 1)
{
  ScanSelection selection(range, every_n);
  std::vector<std::size_t> numbers;
  for (std::size_t i = 0; i < 20; ++i)
  {
    const bool takes = selection.takes(i, 1000 + 0.1 * static_cast<double>(i));
    EXPECT_FALSE(takes && selection.isPastEnd());
    if (takes)
    {
      numbers.push_back(i);
    }
  }
  return numbers;
}

ScanRange range(int skip_first_n, double start, double end)
{
  ScanRange range;
  range.skip_first_n = skip_first_n;
  range.start = start;
  range.end = end;
  return range;
}

TEST(ScanRange, TimesAreSinceTheFirstScanAndTheEndIsLeftOut)
{
  EXPECT_EQ(20U, taken({}).size());
  EXPECT_EQ((std::vector<std::size_t>{5, 6, 7}), taken(range(0, 0.5, 0.8)));
  EXPECT_EQ((std::vector<std::size_t>{0, 1}), taken(range(0, 0, 0.2)));
  EXPECT_EQ((std::vector<std::size_t>{18, 19}), taken(range(0, 1.75, 0)));
}

TEST(ScanRange, ConsecutivePartsTakeEachScanOnce)
{
  std::vector<std::size_t> all = taken(range(0, 0, 0.7));
  for (const double start : {0.7, 1.4})
  {
    const auto part = taken(range(0, start, start + 0.7));
    all.insert(all.end(), part.begin(), part.end());
  }
  EXPECT_EQ(all, taken({}));
}

TEST(ScanRange, SkippedAndThinned)
{
  EXPECT_EQ((std::vector<std::size_t>{3, 7, 11, 15, 19}), taken(range(3, 0, 0), 4));
  EXPECT_EQ((std::vector<std::size_t>{6, 8}), taken(range(2, 0.5, 1.0), 2));
  EXPECT_TRUE(taken(range(20, 0, 0)).empty());
}

TEST(ScanRange, ScansAfterAClockThatWasSetBackAreTaken)
{
  ScanSelection all(range(0, 0, 0.2));
  EXPECT_TRUE(all.takes(0, 1000));
  EXPECT_TRUE(all.takes(1, 500));
  ScanSelection late(range(0, 0.1, 0));
  EXPECT_FALSE(late.takes(0, 1000));
  EXPECT_FALSE(late.takes(1, 500));
  EXPECT_TRUE(late.takes(2, 1000.1));
  EXPECT_TRUE(late.takes(3, 500.1));
}

TEST(ScanRange, PastTheEndNothingFollows)
{
  ScanSelection selection(range(0, 0, 0.2));
  EXPECT_TRUE(selection.takes(0, 7));
  EXPECT_FALSE(selection.isPastEnd());
  EXPECT_FALSE(selection.takes(1, 7.2));
  EXPECT_TRUE(selection.isPastEnd());
}

/** A scan each 0.1 s; a tenth of the recording is read with each. */
TEST(ScanRange, ProgressIsThatOfTheScansToUse)
{
  const auto progressAt = [](const ScanRange& range, std::size_t last)
  {
    ScanSelection selection(range);
    std::size_t used = 0;
    double progress = 0;
    for (std::size_t i = 0; i <= last; ++i)
    {
      used += selection.takes(i, 1000 + 0.1 * static_cast<double>(i)) ? 1 : 0;
      progress = selection.progress(0.1 * static_cast<double>(i + 1), used);
    }
    return progress;
  };
  EXPECT_NEAR(0.3, progressAt({}, 2), 1e-9);
  EXPECT_NEAR(1, progressAt({}, 9), 1e-9);
  EXPECT_EQ(0, progressAt(range(0, 0.5, 0), 4)) << "none is used yet";
  EXPECT_NEAR(0, progressAt(range(0, 0.5, 0), 5), 1e-9);
  EXPECT_NEAR(0.5, progressAt(range(5, 0, 0), 7), 1e-9);
  EXPECT_NEAR(1, progressAt(range(5, 0, 0), 9), 1e-9);
  EXPECT_EQ(1, progressAt(range(9, 0, 0), 9)) << "the last scan alone";
  EXPECT_NEAR(0.5, progressAt(range(0, 0.2, 0.6), 4), 1e-5);
  EXPECT_EQ(1, progressAt(range(0, 0.2, 0.6), 6));
  EXPECT_NEAR(0.5, progressAt(range(0, 0, 100), 4), 1e-9) << "the recording ends before";
  ScanRange first = range(2, 0, 0);
  first.only_first_n = 4;
  EXPECT_NEAR(0.25, progressAt(first, 2), 1e-9);
  EXPECT_NEAR(0.75, progressAt(first, 4), 1e-9);
}

TEST(ScanRange, AsFlags)
{
  ScanRange some = range(2, 0.25, 1600.5);
  EXPECT_EQ("--skip-first-n 2 --start 0.25 --end 1600.5", some.flags());
  EXPECT_FALSE(some.isAll());
  some = range(0, 0, 0);
  EXPECT_EQ("", some.flags());
  EXPECT_TRUE(some.isAll());
  some.only_first_n = 5;
  EXPECT_EQ("--only-first-n 5", some.flags());
  EXPECT_FALSE(some.isAll());
}

TEST(ScanRange, AnEndBeforeTheStartIsAnError)
{
  EXPECT_THROW(ScanSelection(range(0, 2, 1)), UserError);
  EXPECT_THROW(ScanSelection(range(0, 2, 2)), UserError);
}
}  // namespace
}  // namespace dyslam
