// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/batch/ControlGroup.h>
#include <gtest/gtest.h>

#include "TestFolder.h"

namespace dyslam::batch
{
namespace
{
/** A root folder with /proc and /sys. */
class ControlGroup : public testing::Test
{
 protected:
  void process(const std::string& groups) { root_.write("proc/self/cgroup", groups); }
  void group(const std::string& path,
             const std::string& limit,
             const std::string& used,
             const std::string& cache) const
  {
    const std::string folder = "sys/fs/cgroup/" + path;
    root_.write(folder + "/memory.max", limit + "\n");
    root_.write(folder + "/memory.current", used + "\n");
    root_.write(folder + "/memory.stat",
                "anon 10\nfile 999\nactive_file 5\ninactive_file " + cache + "\nslab 7\n");
  }
  [[nodiscard]] std::optional<std::uint64_t> left() const
  {
    return memoryLeftByGroups(root_.path());
  }

  const TestFolder root_;
};
}  // namespace

TEST_F(ControlGroup, LeavesTheRestOfTheTightestLimitOnTheWayToTheRoot)
{
  process("0::/system.slice/job_7/step_0\n");
  group("system.slice/job_7/step_0", "max", "100", "0");
  group("system.slice/job_7", "1000", "400", "0");
  group("system.slice", "5000", "4100", "0");
  EXPECT_EQ(left(), 600U);
  group("system.slice", "5000", "4500", "0");
  EXPECT_EQ(left(), 500U);
  group("", "450", "0", "0");
  EXPECT_EQ(left(), 450U) << "the root of a container is a group of the host";
  group("other", "1", "0", "0");
  EXPECT_EQ(left(), 450U);
}

TEST_F(ControlGroup, CacheOfFilesIsFree)
{
  process("0::/job\n");
  group("job", "1000", "990", "700");
  EXPECT_EQ(left(), 710U);
  group("job", "1000", "990", "2000");
  EXPECT_EQ(left(), 1000U);
  group("job", "1000", "1200", "100");
  EXPECT_EQ(left(), 0U) << "the limit was lowered below what is used";
}

TEST_F(ControlGroup, OfVersionTwoIsFoundBehindThoseOfVersionOne)
{
  process("9:name=systemd:/\n4:memory:/process\n0::/job\n");
  group("unified/job", "1000", "300", "100");
  group("job", "10", "0", "0");
  EXPECT_EQ(left(), 800U);
}

TEST_F(ControlGroup, LeavesAllWithoutALimit)
{
  EXPECT_FALSE(left()) << "no groups";
  process("4:memory:/job\n");
  group("job", "1000", "300", "100");
  EXPECT_FALSE(left()) << "version 1";
  process("0::/job/step\n");
  group("job", "max", "300", "100");
  EXPECT_FALSE(left());
  process("0::/../job\n");
  group("job", "1000", "300", "100");
  EXPECT_EQ(left(), 800U) << "nothing outside the hierarchy is read";
}
}  // namespace dyslam::batch
