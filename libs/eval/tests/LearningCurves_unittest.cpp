// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/eval/LearningCurves.h>
#include <gtest/gtest.h>

namespace dyslam
{
TEST(LearningCurves, StepsAndValuesOfAnySizeAreDrawn)
{
  for (const std::string rows :
       {"1,0.5\n2,0.4\n", "1e16,1\n", "1e16,1\n10000000000000002,2\n",
        "-1e308,1e308\n1e308,-1e308\n", "nan,1\n", "inf,1\n3,nan\n", "0,1e-320\n1,2e-320\n"})
  {
    const auto log = parseLearningLog("step,loss\n" + rows, "a.csv");
    EXPECT_GT(renderLearningCurves(log).size(), 1000U) << rows;
  }
}
}  // namespace dyslam
