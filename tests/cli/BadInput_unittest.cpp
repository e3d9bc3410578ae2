// SPDX-License-Identifier: BSD-3-Clause
// Programs with rawlogs that are damaged, or hold what no recording should.
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/io/RawlogSource.h>
#include <dyslam/io/RawlogWriter.h>
#include <gtest/gtest.h>
#include <mrpt/io/CFileGZOutputStream.h>
#include <mrpt/maps/CSimpleMap.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/serialization/CArchive.h>

#include <cstddef>
#include <exception>
#include <filesystem>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "RefusedInput.h"
#include "RunProgram.h"

namespace fs = std::filesystem;

namespace dyslam
{
namespace
{
class BadInput : public test::RefusedInput
{
 protected:
  template <typename... Objects>
  static std::string writeObjects(const std::string& name, const Objects&... objects)
  {
    mrpt::io::CFileGZOutputStream file(at(name));
    auto archive = mrpt::serialization::archiveFrom(file);
    (archive << ... << objects);
    return at(name);
  }
};

TEST_F(BadInput, FilesThatAreNoRawlog)
{
  const std::string text = write("text.rawlog", "hello world, this is no rawlog\n");
  const std::string noise = write("noise.rawlog", std::string(50000, '\x8F'));
  const std::string simplemap = writeObjects("map.rawlog", mrpt::maps::CSimpleMap());
  const std::string flat = writeObjects("flat.rawlog", mrpt::obs::CObservation2DRangeScan());
  // Two programs that read rawlogs.
  const std::vector<std::pair<std::string, std::string>> programs{
      {"dyslam", " -c vlp16.ini -o " + at("never")},
      {"dyslam-map",
       " --trajectory " + write("t.txt", "1 0 0 0 0 0 0 1\n") + " -o " + at("m.pcd")}};
  for (const auto& [program, rest] : programs)
  {
    expectRefusal(program, "-i " + at("none.rawlog") + rest, {"none.rawlog", "no such file"});
    expectRefusal(program, "-i " + at("empty") + rest, {"empty: is empty", "kitti2rawlog"});
    expectRefusal(program, "-i " + text + rest, {"text.rawlog: is not a rawlog", "kitti2rawlog"});
    expectRefusal(program, "-i " + noise + rest, {"noise.rawlog: is not a rawlog"});
    expectRefusal(program, "-i " + simplemap + rest,
                  {"map.rawlog", "it holds a mrpt::maps::CSimpleMap"});
    expectRefusal(program, "-i " + flat + rest,
                  {"flat.rawlog: has no 3D scans", "1 CObservation2DRangeScan", "3D LiDAR"});
  }
  expectRefusal("dyslam-map", "-i " + at("") + programs[1].second,
                {"is a folder", "a file is needed"});
  EXPECT_FALSE(fs::exists(at("never")));
  EXPECT_FALSE(fs::exists(at("m.pcd")));
}

TEST_F(BadInput, ATruncatedRawlogLeavesWhatCameBefore)
{
  const std::string whole = contentOf(at("good.rawlog"));
  const std::string cut = write("cut.rawlog", whole.substr(0, whole.size() * 6 / 10));
  std::size_t scans = 0;
  try
  {
    RawlogSource source(cut);
    for (; source.next(); ++scans)
    {
    }
  }
  catch (const std::exception&)
  {
  }
  ASSERT_GT(scans, 4U);
  ASSERT_LT(scans, test::recorded_scans);

  const Outcome outcome = run("dyslam", slam(cut, "cut") + " -v ERROR");
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.err.find("cut.rawlog: is cut short"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("results of the " + std::to_string(scans) + " scans"),
            std::string::npos)
      << outcome.err;
  EXPECT_EQ(posesIn("cut"), scans);
  EXPECT_EQ(run("dyslam-eval", "run " + at("cut")).code, 0);
  RawlogSource replay(at("cut") + "/replay.rawlog");
  std::size_t replayed = 0;
  for (; replay.next(); ++replayed)
  {
  }
  EXPECT_EQ(replayed, scans);

  const std::string map = at("cut.ply");
  expectRefusal("dyslam-map",
                "-q -i " + cut + " --trajectory " + at("cut") + "/trajectory_tum.txt -o " + map,
                {"is cut short", "map of the " + std::to_string(scans) + " scans"});
  EXPECT_EQ(run("dyslam-eval", "map --reference " + map + " --estimate " + map).code, 0);
  EXPECT_GT(fs::file_size(map), 1000U);
}

TEST_F(BadInput, PointsThatAreNoneAndAnEmptyScanAreSurvived)
{
  record("spoiled.rawlog",
         [](std::size_t i, Scan& scan)
         {
           if (i == 6)
           {
             scan.points.clear();
             scan.intensity.clear();
             scan.time.clear();
             scan.ring.clear();
             return;
           }
           const float nan = std::numeric_limits<float>::quiet_NaN();
           const float inf = std::numeric_limits<float>::infinity();
           for (std::size_t k = 0; k + 3 < scan.size(); k += 40)
           {
             scan.points[k] = Eigen::Vector3f(nan, 1, 1);
             scan.points[k + 1] = Eigen::Vector3f(1, -inf, inf);
             scan.points[k + 2].setZero();
           }
         });
  const Outcome outcome = run("dyslam", slam(at("spoiled.rawlog"), "spoiled") + " --labels");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("an empty scan (scan 6)"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("1 scan could not be registered; its motion"), std::string::npos)
      << outcome.out;
  EXPECT_EQ(posesIn("spoiled"), test::recorded_scans);
  const auto truth = readTum(at("spoiled") + "/reference_tum.txt");
  const auto found = readTum(at("spoiled") + "/trajectory_tum.txt");
  ASSERT_EQ(truth.size(), found.size());
  EXPECT_LT(
      (truth[truth.size() - 1].pose.translation() - found[found.size() - 1].pose.translation())
          .norm(),
      0.3);
  for (const char* file : {"map_static.ply", "trajectory_tum.txt", "graph.g2o"})
  {
    const std::string text = contentOf(at("spoiled") + "/" + file);
    EXPECT_GT(text.size(), 0U) << file;
    EXPECT_TRUE(std::string(file) == "map_static.ply" || text.find("nan") == std::string::npos)
        << file;
  }
}

TEST_F(BadInput, WarningsHaveNoEscapeCodes)
{
  const std::string name =
      "odd\x1b"
      "c.rawlog";
  record(name, [](std::size_t i, Scan& scan)
         { scan.stamp = 100.0 + 0.1 * static_cast<double>(i == 4 ? 3 : i); });
  std::string poses;
  for (std::size_t i = 0; i < test::recorded_scans; ++i)
  {
    poses += std::to_string(100.0 + 0.1 * static_cast<double>(i)) + " 0 0 0 0 0 0 1\n";
  }
  const std::string trajectory = write("odd/trajectory.txt", poses);
  const Outcome outcome = run("dyslam-map", "-q -i " + at(name) + " --trajectory " + trajectory +
                                                " -o " + at("odd/map.ply"));
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("warning: "), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("odd?c.rawlog"), std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.err.find('\x1b'), std::string::npos) << outcome.err;
}

TEST_F(BadInput, TimeStampsThatRepeatOrGoBack)
{
  record("stamps.rawlog",
         [](std::size_t i, Scan& scan)
         {
           scan.stamp = 100.0 + 0.1 * static_cast<double>(i);
           scan.stamp -= i == 4 ? 0.1 : 0.0;  // the stamp of the previous scan
           scan.stamp -= i == 8 ? 3.0 : 0.0;  // 3 s back
         });
  const Outcome outcome = run("dyslam", slam(at("stamps.rawlog"), "stamps"));
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("time stamp of the one before was dropped"), std::string::npos);
  EXPECT_NE(outcome.out.find("goes back was dropped"), std::string::npos) << outcome.out;
  EXPECT_EQ(posesIn("stamps"), test::recorded_scans - 2);

  {
    RawlogWriter writer(at("still.rawlog"));
    Scan scan;
    scan.stamp = 50;
    scan.points.assign(100, Eigen::Vector3f(5, 1, 0));
    for (int i = 0; i < 20; ++i)
    {
      writer.write(scan);
    }
    writer.close();
  }
  const Outcome still = run("dyslam", slam(at("still.rawlog"), "still") + " -v ERROR");
  EXPECT_EQ(still.code, 1);
  EXPECT_NE(still.err.find("still.rawlog: the time stamps stand still"), std::string::npos)
      << still.err;
  EXPECT_NE(still.err.find("give the file proper times"), std::string::npos) << still.err;
}
}  // namespace
}  // namespace dyslam
