// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/formats/ProgramLines.h>
#include <gtest/gtest.h>

#include <string>

namespace dyslam
{
TEST(ProgramLines, ErrorsAreReadAsTheyAreWritten)
{
  const std::string line = errorLine("dyslam", "a.rawlog: no such file\x1b[2J");
  EXPECT_EQ("dyslam: a.rawlog: no such file?[2J", line);
  EXPECT_EQ("a.rawlog: no such file?[2J", messageOfErrorLine("dyslam", line));
  EXPECT_FALSE(messageOfErrorLine("dyslam", "dyslam-map: no"));
  EXPECT_FALSE(messageOfErrorLine("dyslam", "2 scans"));
}

TEST(ProgramLines, AStoppedRunIsKnownByItsError)
{
  const std::string reason = stopReason("on request after 3 scans");
  EXPECT_EQ("stopped on request after 3 scans", reason);
  for (const std::string input : {"a.rawlog", "a\n.rawlog"})
  {
    const std::string line = errorLine("dyslam", stoppedMessage(input, reason + ", whose results"));
    EXPECT_TRUE(isStoppedLine("dyslam", input, line)) << line;
    EXPECT_FALSE(isStoppedLine("dyslam", "b.rawlog", line)) << line;
  }
  EXPECT_FALSE(isStoppedLine("dyslam", "a.rawlog", "dyslam: a.rawlog: no scans"));
  EXPECT_FALSE(isStoppedLine("dyslam", "a.rawlog", ""));
}

TEST(ProgramLines, ARunThatCanBeCompletedIsKnownByItsError)
{
  const std::string message = "out/a/map.pcd: cannot be written: No space left on device; ";
  EXPECT_TRUE(
      canBeCompletedLine("dyslam", errorLine("dyslam", message + completeLaterAdvice("out/a"))));
  EXPECT_FALSE(canBeCompletedLine("dyslam", errorLine("dyslam", message)));
  EXPECT_FALSE(canBeCompletedLine("dyslam", ""));
}

TEST(ProgramLines, ProgressIsReadAsItIsWritten)
{
  EXPECT_EQ(" 45% 9 scans, 4.5/s, 0:02 left", progressText(0.45, 9, "scans", 2));
  EXPECT_EQ("100% 1 scan in 2.0 s, 0.5/s", progressText(1, 1, "scans", 2));
  EXPECT_EQ("9 scans, 4.5/s", progressText(-1, 9, "scans", 2));
  const EarlierWork earlier{0.5, 5};
  EXPECT_EQ(" 80% 9 scans, 2.0/s, 0:01 left", progressText(0.8, 9, "scans", 2, earlier));
  EXPECT_EQ("100% 10 scans, 5 of them in 2.0 s, 2.5/s", progressText(1, 10, "scans", 2, earlier));
  EXPECT_EQ("6 scans, 0.5/s", progressText(0.5, 6, "scans", 2, earlier));
  EXPECT_EQ(" 12% 0 recordings, 0:15 left", progressText(0.12, 0, "recordings", 2));
  EXPECT_EQ("100% 3 recordings in 100.0 s", progressText(1, 3, "recordings", 100));
  EXPECT_EQ("0 recordings", progressText(0, 0, "recordings", 2));
  std::string log = "attempt 1\n";
  EXPECT_EQ(0, lastProgressIn(log).fraction);
  for (const double fraction : {0.05, 0.45, 1.0})
  {
    log += "dyslam: " + progressText(fraction, 9, "scans", 2) + "\n";
    EXPECT_NEAR(fraction, lastProgressIn(log).fraction, 1e-9);
    EXPECT_EQ("dyslam", lastProgressIn(log).title);
    const std::string warned = log + "warning: 17 % of the points move\n";
    EXPECT_NEAR(fraction, lastProgressIn(warned).fraction, 1e-9);
  }
  EXPECT_EQ(0, lastProgressIn(progressText(-1, 9, "scans", 2)).fraction);
  const std::string title = progressTitle("dyslam", conversion_part);
  EXPECT_EQ("dyslam, conversion", title);
  EXPECT_EQ("dyslam", progressTitle("dyslam", ""));
  log += title + ": " + progressText(0.5, 9, "scans", 2) + "\n";
  EXPECT_EQ(title, lastProgressIn(log).title);
  EXPECT_NEAR(0.5, lastProgressIn(log).fraction, 1e-9);
  EXPECT_EQ("", lastProgressIn(" 45% 9 scans").title);
}
}  // namespace dyslam
