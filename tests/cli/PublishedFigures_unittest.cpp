// SPDX-License-Identifier: BSD-3-Clause
// dyslam-eval on estimates whose errors others have published.
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "RealData.h"

namespace
{
namespace fs = std::filesystem;

std::vector<std::string> cellsOf(const std::string& line)
{
  std::vector<std::string> cells;
  std::istringstream in(line);
  for (std::string cell; std::getline(in, cell, ',');)
  {
    cells.push_back(cell);
  }
  return cells;
}

// SiMpLE's online estimates of KITTI odometry 00 to 10 and the t_rel published with them.
TEST(DyslamEval, TrajectoryGivesThePublishedDriftOfAllSequences)
{
  DYSLAM_REQUIRE_DATA("kitti_odometry_text");
  const std::array<double, 11> published{0.6667, 0.7749, 0.6263, 0.7369, 0.4067, 0.3372,
                                         0.2613, 0.4706, 0.8236, 0.5684, 0.6454};
  const std::string folder = *dyslam::realDataFolder("kitti_odometry_text") + "/";
  const std::string csv =
      (fs::temp_directory_path() / ("dyslam_published_" + std::to_string(::getpid()) + ".csv"))
          .string();
  std::string references = " --reference";
  std::string estimates = " --estimate";
  for (std::size_t i = 0; i < published.size(); ++i)
  {
    const std::string name = (i < 10 ? "/0" : "/") + std::to_string(i) + ".txt";
    references += " " + folder + "poses_gt_cam0" + name;
    estimates += " " + folder + "est_simple_online_cam0" + name;
  }
  ASSERT_EQ(std::system((std::string(DYSLAM_BIN_DIR) + "/dyslam-eval trajectory" + references +
                         estimates + " --csv " + csv + " > /dev/null")
                            .c_str()),
            0);
  std::ifstream table(csv);
  std::string line;
  ASSERT_TRUE(std::getline(table, line));
  ASSERT_EQ(cellsOf(line).at(3), "t_rel [%]");
  double sum = 0;
  for (std::size_t i = 0; i < published.size(); ++i)
  {
    ASSERT_TRUE(std::getline(table, line));
    const double found = std::stod(cellsOf(line).at(3));
    EXPECT_NEAR(found, published[i], 0.5e-3) << line;
    sum += found;
  }
  EXPECT_NEAR(sum / 11, 0.5744, 0.5e-3);
  ASSERT_TRUE(std::getline(table, line)) << "the row of means";
  EXPECT_NEAR(std::stod(cellsOf(line).at(3)), 0.5744, 0.5e-3);
  std::remove(csv.c_str());
}
}  // namespace
