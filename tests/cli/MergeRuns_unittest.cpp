// SPDX-License-Identifier: BSD-3-Clause
// dyslam-map --merge: recordings of one place, from the simulator to one map.
#include <dyslam/formats/GeoreferenceFile.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/mrpt/Geodesy.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "RunProgram.h"

namespace dyslam
{
namespace
{
namespace fs = std::filesystem;

/** Drives: two past the same houses, the second of which begins a little farther on and has other
 * traffic, two longer ones past them with satellite receiver, and one elsewhere. */
class MergeRuns : public testing::Test
{
 protected:
  static void SetUpTestSuite()
  {
    folder = (fs::temp_directory_path() / ("dyslam_merge_" + std::to_string(getpid()))).string();
    fs::create_directories(folder);
    make("first", "--seed 42 --traffic-seed 1");
    make("second", "--seed 42 --traffic-seed 2 --start 0.03");
    make("elsewhere", "--seed 7");
    make("on_earth", "--seed 42 --traffic-seed 4 --traffic 0.1 --gnss --imu",
         "--speed 5 --seconds 16");
    make("on_earth_later", "--seed 42 --traffic-seed 5 --traffic 0.1 --gnss --start 0.1",
         "--speed 5 --seconds 12");
  }
  static void TearDownTestSuite() { fs::remove_all(folder); }

  static void make(const std::string& name,
                   const std::string& flags,
                   const std::string& way = "--speed 3 --seconds 11")
  {
    const std::string rawlog = at(name + ".rawlog");
    const Outcome simulated =
        runProgram("dyslam-sim",
                   "--world campus --sensor VLP16 --columns 600 --loop 240 --no-flow --no-stops -q "
                   "-o " +
                       rawlog + " " + flags + " " + way,
                   folder);
    ASSERT_EQ(simulated.code, 0) << simulated.err;
    const Outcome run =
        runProgram("dyslam",
                   "-i " + rawlog + " -c vlp16.ini -o " + at(name) +
                       " -v ERROR --set output.replay=false --set output.page=false",
                   folder);
    ASSERT_EQ(run.code, 0) << run.err;
  }
  static std::string at(const std::string& name) { return folder + "/" + name; }
  static Outcome merge(const std::string& rest)
  {
    return runProgram("dyslam-map", "-q --set labels.hindsight=false --merge " + rest, folder);
  }
  static void expectRefusal(const std::string& rest, const std::vector<std::string>& words)
  {
    const Outcome outcome = merge(rest);
    EXPECT_EQ(outcome.code, 1) << rest;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    for (const std::string& word : words)
    {
      EXPECT_NE(outcome.err.find(word), std::string::npos) << outcome.err << "lacks " << word;
    }
  }

  static inline std::string folder;
};

/** Numbers of the first row of a table under its header. */
std::vector<std::string> firstRow(const std::string& csv)
{
  std::stringstream text(csv);
  std::string line;
  std::getline(text, line);
  std::getline(text, line);
  std::vector<std::string> cells;
  std::stringstream words(line);
  for (std::string cell; std::getline(words, cell, ',');)
  {
    cells.push_back(cell);
  }
  return cells;
}

TEST_F(MergeRuns, OneMapAndATrajectoryOfEach)
{
  const std::string runs = at("first") + " " + at("second");
  const Outcome one = merge(runs + " --threads 1 -o " + at("one.ply"));
  ASSERT_EQ(one.code, 0) << one.err;
  EXPECT_NE(one.out.find("2 of 2 runs joined, 220 scans, 0 without a pose"), std::string::npos)
      << one.out;
  const std::vector<std::string> row = firstRow(contentOf(at("one_merge.csv")));
  ASSERT_EQ(row.size(), 8U);
  EXPECT_EQ(row[0], "first - second");
  EXPECT_GE(std::stoi(row[1]), 4) << "loops";
  EXPECT_GE(std::stoi(row[4]), 8) << "places";
  EXPECT_LT(std::stod(row[6]), 0.05) << "RMSE [m]";
  for (const char* run : {"first", "second"})
  {
    const std::string tum = contentOf(at(std::string("one_") + run + "_tum.txt"));
    const std::string kitti = contentOf(at(std::string("one_") + run + "_kitti.txt"));
    EXPECT_EQ(std::count(tum.begin(), tum.end(), '\n'), 110) << run;
    EXPECT_EQ(std::count(kitti.begin(), kitti.end(), '\n'), 110) << run;
  }
  // Without labels the moving points are those with hindsight, whatever the setting.
  const Outcome two = merge(runs + " --set labels.hindsight=true --threads 2 -o " + at("two.ply"));
  ASSERT_EQ(two.code, 0) << two.err;
  for (const char* ending : {".ply", "_merge.csv", "_first_tum.txt", "_second_tum.txt"})
  {
    EXPECT_EQ(contentOf(at("one") + ending), contentOf(at("two") + ending)) << ending;
  }
}

TEST_F(MergeRuns, ARunWithSatellitePositionsPlacesTheOthersOnTheEarth)
{
  const std::string runs = at("first") + " " + at("on_earth");
  const Outcome map = merge(runs + " -o " + at("earth.ply"));
  ASSERT_EQ(map.code, 0) << map.err;
  EXPECT_NE(map.out.find("satellite receivers: "), std::string::npos) << map.out;
  EXPECT_NE(map.out.find("accelerometers: z of the merged map is "), std::string::npos) << map.out;
  const Georeference found = readGeoreference(at("earth_georeference.ini"));
  const Trajectory first = readTum(at("earth_first_tum.txt"));
  const Trajectory truth = readTum(at("first.gt/poses_tum.txt"));
  const GeodeticPosition origin{49, 8.4, 115};  // of the simulated world
  ASSERT_EQ(first.size(), truth.size());
  for (std::size_t i = 0; i < first.size(); ++i)
  {
    const Eigen::Vector3d enu =
        toEnu(fromEnu(found.T_enu_map * first[i].pose.translation(), found.origin), origin);
    EXPECT_LT((enu - truth[i].pose.translation()).head<2>().norm(), 3);
  }
  EXPECT_EQ(readTum(at("earth_first_utm.txt")).size(), first.size());
  const std::string ini = contentOf(at("earth.effective.ini"));
  EXPECT_NE(ini.find("\nhindsight = true"), std::string::npos)
      << "is in effect, whatever labels.hindsight is";

  const Outcome utm = merge(runs + " --utm -o " + at("utm.las"));
  ASSERT_EQ(utm.code, 0) << utm.err;
  EXPECT_NE(contentOf(at("utm.las")).substr(0, 2000).find("LASF_Projection"), std::string::npos);
  expectRefusal(at("first") + " " + at("second") + " --utm -o " + at("never.las"),
                {"--utm: no run has a georeference.ini"});
}

TEST_F(MergeRuns, SatellitePositionsOfTwoRunsHaveToAgree)
{
  const Outcome map = merge(at("on_earth") + " " + at("on_earth_later") + " -o " + at("both.ply"));
  ASSERT_EQ(map.code, 0) << map.err;
  EXPECT_LT(std::stod(firstRow(contentOf(at("both_merge.csv")))[6]), 0.15) << "RMSE [m]";
  const Georeference own = readGeoreference(at("on_earth/georeference.ini"));
  const Georeference later = readGeoreference(at("on_earth_later/georeference.ini"));
  const Georeference found = readGeoreference(at("both_georeference.ini"));
  EXPECT_EQ(found.fixes, own.fixes + later.fixes);
  EXPECT_EQ(found.origin.latitude, own.origin.latitude);
  EXPECT_TRUE(found.fused);
  EXPECT_LT(found.horizontal_rmse, 2);

  fs::copy(at("on_earth_later"), at("moved"), fs::copy_options::recursive);
  Georeference moved = later;
  moved.origin.longitude += 0.003;  // 219 m
  writeGeoreference(moved, at("moved/georeference.ini"));
  const std::string runs = at("on_earth") + " " + at("moved");
  expectRefusal(runs + " -o " + at("never.ply"),
                {at("moved") + ": loops place it 2",
                 " m from where its satellite positions do, by those of " + at("on_earth") + " (",
                 "merge.gnss=false", "nothing was written"});
  EXPECT_FALSE(fs::exists(at("never.ply")));
  EXPECT_EQ(merge(runs + " --set merge.gnss=false -o " + at("without.ply")).code, 0);
  EXPECT_FALSE(fs::exists(at("without_georeference.ini")));
}

TEST_F(MergeRuns, ARunOfAnotherPlaceIsNamed)
{
  expectRefusal(at("first") + " " + at("elsewhere") + " -o " + at("never.ply"),
                {at("elsewhere") + ": no place in common with " + at("first") + " was recognised (",
                 " found, ", "nothing was written"});
  EXPECT_FALSE(fs::exists(at("never.ply")));
  expectRefusal(at("first") + " " + at("elsewhere") + " " + at("second") + " -o " + at("rest.ply"),
                {at("elsewhere") + ": no place in common", "the map of the rest was written"});
  EXPECT_TRUE(fs::exists(at("rest.ply")));
  EXPECT_TRUE(fs::exists(at("rest_second_tum.txt")));
  EXPECT_FALSE(fs::exists(at("rest_elsewhere_tum.txt")));
}

TEST_F(MergeRuns, WhatIsNoRunIsRefused)
{
  const std::string out = " -o " + at("never.ply");
  expectRefusal(at("first") + out, {"--merge: give two runs or more"});
  expectRefusal(at("first") + " " + at("none") + out, {at("none") + ": is not a folder"});
  expectRefusal(at("first") + " " + at("first") + out, {"is given twice"});
  fs::create_directories(at("hollow"));
  expectRefusal(at("first") + " " + at("hollow") + out, {at("hollow") + ": has no report.json"});
  expectRefusal(at("first") + " " + at("second") + "=" + at("moved.rawlog") + out,
                {at("moved.rawlog") + ": the recording of " + at("second") + " is not there"});
  expectRefusal(at("first") + " " + at("second") + " -i " + at("first.rawlog") + out,
                {"--merge", "--input"});
  expectRefusal(at("first") + " " + at("second") + " --set preprocess.max_range=50" + out,
                {"preprocess.max_range", "loop, solver and merge"});
  expectRefusal(at("first") + " " + at("second") + "=" + at("elsewhere.rawlog") + out,
                {at("second"), "no place in common"});
  fs::copy(at("second"), at("torn"), fs::copy_options::recursive);
  const std::string graph = contentOf(at("first/factor_graph.txt"));
  std::ofstream(at("torn/factor_graph.txt")) << graph.substr(0, graph.find("EGO 3"));
  expectRefusal(at("first") + " " + at("torn") + out, {"factor_graph.txt", "of one run?"});
  EXPECT_FALSE(fs::exists(at("never.ply")));
  const Outcome nothing = runProgram("dyslam-map", "-o " + at("never.ply"), folder);
  EXPECT_EQ(nothing.code, 1);
  EXPECT_NE(nothing.err.find("--input is required"), std::string::npos) << nothing.err;
}
}  // namespace
}  // namespace dyslam
