// SPDX-License-Identifier: BSD-3-Clause
// Every file that dyslam-map writes is read back by a program of others.
#include <dyslam/core/Trajectory.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "RunProgram.h"

namespace dyslam
{
namespace
{
namespace fs = std::filesystem;

/** Output and exit code of an installed program. */
Outcome runForeign(const std::string& command, const std::string& folder)
{
  const std::string out = folder + "/foreign.txt";
  const int status = std::system((command + " > " + out + " 2>&1").c_str());
  Outcome outcome;
  outcome.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  outcome.out = contentOf(out);
  return outcome;
}

bool installed(const std::string& program)
{
  return std::system(("command -v " + program + " > /dev/null 2>&1").c_str()) == 0;
}

/** Number of points by the header of an ASCII PCD or PLY file, and its rows of numbers. */
struct AsciiCloud
{
  std::vector<std::string> fields;
  std::vector<std::vector<double>> rows;
};

AsciiCloud readAsciiPcd(const std::string& path)
{
  AsciiCloud cloud;
  std::ifstream in(path);
  bool data = false;
  for (std::string line; std::getline(in, line);)
  {
    std::istringstream words(line);
    if (data)
    {
      cloud.rows.emplace_back();
      for (double value = 0; words >> value;)
      {
        cloud.rows.back().push_back(value);
      }
      continue;
    }
    std::string word;
    words >> word;
    data = word == "DATA";
    for (; word == "FIELDS" && words >> word; word = "FIELDS")
    {
      cloud.fields.push_back(word);
    }
  }
  return cloud;
}

/** One map of the bundled street in every format. */
class Exports : public testing::Test
{
 protected:
  static void SetUpTestSuite()
  {
    folder = (fs::temp_directory_path() / ("dyslam_exports_" + std::to_string(getpid()))).string();
    fs::create_directories(folder);
    const std::string street = DYSLAM_SOURCE_DIR "/rawlog/street64";
    std::string outputs;
    for (const char* ending : {"pcd", "ply", "las", "bt", "ot", "png", "gridmap", "simplemap"})
    {
      outputs += " -o " + folder + "/m." + ending;
    }
    const Outcome made =
        runProgram("dyslam-map",
                   "-q -i " + street + ".rawlog --trajectory " + street +
                       ".gt/poses_tum.txt --only-first-n 12 --set labels.hindsight=false" + outputs,
                   folder);
    ASSERT_EQ(made.code, 0) << made.err;
    const std::size_t at = made.out.find(" keyframes, ");
    ASSERT_NE(at, std::string::npos) << made.out;
    points = std::stoul(made.out.substr(at + 12));
    ASSERT_GT(points, 10000U);
  }
  static void TearDownTestSuite() { fs::remove_all(folder); }

  static inline std::string folder;
  static inline std::size_t points = 0;
};

TEST_F(Exports, PcdIsReadByPclTools)
{
  if (!installed("pcl_convert_pcd_ascii_binary"))
  {
    GTEST_SKIP() << "needs pcl-tools";
  }
  const Outcome read = runForeign(
      "pcl_convert_pcd_ascii_binary " + folder + "/m.pcd " + folder + "/ascii.pcd 0", folder);
  ASSERT_EQ(read.code, 0) << read.out;
  const AsciiCloud cloud = readAsciiPcd(folder + "/ascii.pcd");
  ASSERT_EQ(cloud.rows.size(), points);
  const std::vector<std::string> fields{"x",        "y",        "z",       "intensity",
                                        "normal_x", "normal_y", "normal_z"};
  ASSERT_EQ(cloud.fields, fields);
  std::size_t up = 0;
  for (const auto& row : cloud.rows)
  {
    ASSERT_EQ(row.size(), 7U);
    ASSERT_LT(std::hypot(row[0], row[1]), 200);
    const double length = std::sqrt(row[4] * row[4] + row[5] * row[5] + row[6] * row[6]);
    ASSERT_TRUE(length == 0 || std::abs(length - 1) < 1e-3) << length;
    up += row[6] > 0.9 ? 1 : 0;
  }
  EXPECT_GT(up, points / 10);
}

TEST_F(Exports, PlyIsReadByPclTools)
{
  if (!installed("pcl_ply2pcd"))
  {
    GTEST_SKIP() << "needs pcl-tools";
  }
  const Outcome read =
      runForeign("pcl_ply2pcd -format 0 " + folder + "/m.ply " + folder + "/ply.pcd", folder);
  ASSERT_EQ(read.code, 0) << read.out;
  EXPECT_NE(read.out.find(std::to_string(points) + " points"), std::string::npos) << read.out;
}

/** loaders.gl, where DYSLAM_LOADERS_GL names the folder that it is installed in: Debian 12 has no
 * program that reads LAS. */
TEST_F(Exports, LasIsReadByLoadersGl)
{
  const char* modules = std::getenv("DYSLAM_LOADERS_GL");
  if (modules == nullptr || !installed("node"))
  {
    GTEST_SKIP()
        << "Debian has no program that reads LAS; to test with loaders.gl: apt-get install "
           "nodejs npm; npm install --prefix ~/loaders_gl @loaders.gl/core "
           "@loaders.gl/las; export DYSLAM_LOADERS_GL=~/loaders_gl";
  }
  fs::copy_file(DYSLAM_SOURCE_DIR "/tests/cli/read_las.mjs", fs::path(modules) / "read_las.mjs",
                fs::copy_options::overwrite_existing);
  const Outcome read =
      runForeign("node " + std::string(modules) + "/read_las.mjs " + folder + "/m.las", folder);
  ASSERT_EQ(read.code, 0) << read.out;
  std::istringstream words(read.out);
  std::size_t count = 0;
  std::vector<double> low(3);
  words >> count >> low[0] >> low[1] >> low[2];
  EXPECT_EQ(count, points) << read.out;
  double x = std::numeric_limits<double>::infinity();
  for (const auto& row : readCloud(folder + "/m.pcd").points)
  {
    x = std::min(x, static_cast<double>(row.x()));
  }
  EXPECT_NEAR(low[0], x, 0.002);
}

TEST_F(Exports, OctreeIsReadByOctomapsTools)
{
  if (!installed("convert_octree"))
  {
    GTEST_SKIP() << "needs octomap-tools";
  }
  for (const char* name : {"m.bt", "m.ot"})
  {
    const Outcome read = runForeign(
        "convert_octree " + folder + "/" + name + " " + folder + "/converted.ot", folder);
    ASSERT_EQ(read.code, 0) << read.out;
    EXPECT_GT(fs::file_size(folder + "/converted.ot"), 100000U);
  }
}

/** As map_server's readme states: image, resolution, origin, negate and two thresholds; a pixel p
 * means an occupancy of (255 - p) / 255, the first row is the highest y. */
TEST_F(Exports, GridFollowsMapServersRules)
{
  std::map<std::string, std::string> yaml;
  std::ifstream in(folder + "/m.yaml");
  for (std::string line; std::getline(in, line);)
  {
    const std::size_t colon = line.find(": ");
    ASSERT_NE(colon, std::string::npos) << line;
    yaml[line.substr(0, colon)] = line.substr(colon + 2);
  }
  ASSERT_EQ(yaml["image"], "m.png");
  ASSERT_EQ(yaml["negate"], "0");
  const double resolution = std::stod(yaml["resolution"]);
  const double occupied_above = std::stod(yaml["occupied_thresh"]);
  const double free_below = std::stod(yaml["free_thresh"]);
  double x0 = 0;
  double y0 = 0;
  double yaw = 1;
  ASSERT_EQ(std::sscanf(yaml["origin"].c_str(), "[%lf, %lf, %lf]", &x0, &y0, &yaw), 3);
  EXPECT_EQ(yaw, 0);
  const cv::Mat image = cv::imread(folder + "/" + yaml["image"], cv::IMREAD_UNCHANGED);
  ASSERT_EQ(image.type(), CV_8UC1);
  const auto occupancyAt = [&](double x, double y)
  {
    const int column = static_cast<int>(std::floor((x - x0) / resolution));
    const int row = image.rows - 1 - static_cast<int>(std::floor((y - y0) / resolution));
    return (255 - image.at<unsigned char>(row, column)) / 255.0;
  };
  const auto driven = readTrajectory(DYSLAM_SOURCE_DIR "/rawlog/street64.gt/poses_tum.txt");
  for (std::size_t i = 1; i < 12; ++i)
  {
    const Eigen::Vector3d at = driven.trajectory[i].pose.translation();
    EXPECT_LT(occupancyAt(at.x(), at.y()), free_below) << "where the vehicle drove, scan " << i;
  }
  int occupied = 0;
  int unknown = 0;
  for (int i = 0; i < static_cast<int>(image.total()); ++i)
  {
    const double p = (255 - image.at<unsigned char>(i / image.cols, i % image.cols)) / 255.0;
    occupied += p > occupied_above ? 1 : 0;
    unknown += p >= free_below && p <= occupied_above ? 1 : 0;
  }
  EXPECT_GT(occupied, 500);
  EXPECT_GT(unknown, 500);
}

TEST_F(Exports, SimplemapIsReadByMrptsObservations2map)
{
  if (!installed("observations2map"))
  {
    GTEST_SKIP() << "needs mrpt-apps";
  }
  std::ofstream(folder + "/map.ini") << "[MappingApplication]\npointsMap_count = 1\n"
                                        "[MappingApplication_pointsMap_00_creationOpts]\n"
                                        "[MappingApplication_pointsMap_00_insertOpts]\n"
                                        "minDistBetweenLaserPoints = 0\nisPlanarMap = false\n";
  const Outcome read = runForeign(
      "cd " + folder + " && observations2map map.ini m.simplemap out " + "< /dev/null", folder);
  EXPECT_EQ(read.code, 0) << read.out;
  bool any = false;
  for (const auto& entry : fs::directory_iterator(folder))
  {
    any = any ||
          (entry.path().filename().string().rfind("out", 0) == 0 && fs::file_size(entry) > 10000);
  }
  EXPECT_TRUE(any) << read.out;
}
}  // namespace
}  // namespace dyslam
