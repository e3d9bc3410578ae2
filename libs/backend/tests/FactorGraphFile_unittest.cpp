// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/FactorGraphFile.h>
#include <dyslam/backend/factors/GnssFactor.h>
#include <dyslam/backend/factors/GravityFactor.h>
#include <dyslam/backend/factors/LocalisationFactor.h>
#include <dyslam/backend/factors/ObjectMotionFactor.h>
#include <dyslam/backend/factors/ObservationFactor.h>
#include <dyslam/backend/factors/SmoothMotionFactor.h>
#include <dyslam/base/Error.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <stdexcept>

#include "NoisyDrive.h"

namespace dyslam
{
namespace
{
namespace fs = std::filesystem;

class FactorGraphFile : public ::testing::Test
{
 protected:
  void SetUp() override
  {
    folder_ = fs::path(::testing::TempDir()) /
              ::testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  [[nodiscard]] std::string file(const std::string& name) const { return folder_ / name; }
  [[nodiscard]] static std::string contentOf(const std::string& path)
  {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  [[nodiscard]] std::string write(const std::string& content) const
  {
    std::ofstream(file("graph.txt"), std::ios::binary) << content;
    return file("graph.txt");
  }
  [[nodiscard]] std::string errorOf(const std::string& content) const
  {
    try
    {
      (void)readFactorGraph(write(content));
    }
    catch (const UserError& error)
    {
      return error.what();
    }
    return "no error";
  }

  fs::path folder_;
};

/** A drive with a variable and a factor of every kind. */
FactorGraph everyKind()
{
  test::NoisyDrive drive(1);
  FactorGraph graph = drive.graph(drive.threeTrueLoops());
  const auto pose = [&] { return drive.noisy(Pose::Identity(), 10, 1); };
  graph.addPose(Key::staticObject(4), pose());
  graph.addPose(Key::staticObject(4, 2), pose());
  graph.addPose(Key::georeference(), pose());
  graph.add(std::make_unique<GnssFactor>(12, Eigen::Vector3d(120.25, -3.5, 4),
                                         Eigen::Vector3d(0.5, 0, 1.25),
                                         test::randomInformation(drive.rng)));
  graph.addPose(Key::vertical(), pose());
  graph.addVector(Key::accelerometerBias(), 0.1 * Vector6::Ones());
  graph.add(std::make_unique<GravityFactor>(3, Eigen::Vector3d(0.1, -0.2, 9.7),
                                            test::randomInformation(drive.rng)));
  graph.addPose(Key::priorMap(), Pose::Identity());
  graph.setFixed(Key::priorMap(), true);
  graph.add(std::make_unique<LocalisationFactor>(4, pose(), test::randomInformation(drive.rng)));
  graph.addPose(Key::objectPose(7, 3), pose());
  graph.addPose(Key::objectPose(7, 5), pose());
  graph.addPose(Key::objectPose(7, 6), pose());
  graph.addVector(Key::objectVelocity(7, 5), logSE3(pose()));
  graph.addVector(Key::objectVelocity(7, 6), logSE3(pose()));
  graph.setFixed(Key::objectPose(7, 3), true);
  for (const Key& key : {Key::staticObject(4), Key::staticObject(4, 2), Key::objectPose(7, 5)})
  {
    graph.add(
        std::make_unique<ObservationFactor>(2, key, pose(), test::randomInformation(drive.rng)));
  }
  graph.add(std::make_unique<ObjectMotionFactor>(7, 3, 5, 0.1 + 1e-9,
                                                 test::randomInformation(drive.rng)));
  graph.add(std::make_unique<ObjectMotionFactor>(7, 5, 6, 0.3, test::randomInformation(drive.rng)));
  graph.add(std::make_unique<SmoothMotionFactor>(7, 5, 6, test::randomInformation(drive.rng)));
  return graph;
}

TEST_F(FactorGraphFile, WrittenReadAndWrittenIsTheSame)
{
  FactorGraph graph = everyKind();
  graph.leaveOut(graph.usedLoops().at(1));
  writeFactorGraph(graph, file("a.txt"));
  EXPECT_FALSE(fs::exists(file("a.txt.tmp")));
  std::vector<std::string> warnings;
  FactorGraph copy = readFactorGraph(file("a.txt"), warnings);
  EXPECT_TRUE(warnings.empty()) << warnings.front();
  writeFactorGraph(copy, file("b.txt"));
  EXPECT_EQ(contentOf(file("a.txt")), contentOf(file("b.txt")));
  EXPECT_TRUE(isFactorGraphFile(file("a.txt")));

  ASSERT_EQ(copy.variables().size(), graph.variables().size());
  for (const auto& [key, variable] : graph.variables())
  {
    EXPECT_EQ(copy.variables().at(key).block, variable.block) << toString(key);
    EXPECT_EQ(copy.variables().at(key).fixed, variable.fixed) << toString(key);
  }
  const auto ids = graph.factorIds();
  const auto copied = copy.factorIds();
  ASSERT_EQ(copied.size(), ids.size());
  std::set<std::string> kinds;
  for (std::size_t i = 0; i < ids.size(); ++i)
  {
    kinds.insert(graph.factor(ids[i]).type().name);
    EXPECT_EQ(&copy.factor(copied[i]).type(), &graph.factor(ids[i]).type());
    EXPECT_EQ(copy.factor(copied[i]).keys(), graph.factor(ids[i]).keys());
    EXPECT_EQ(copy.factor(copied[i]).information(), graph.factor(ids[i]).information());
    EXPECT_EQ(copy.whitenedResidual(copied[i]), graph.whitenedResidual(ids[i]));
    EXPECT_EQ(copy.isLeftOut(copied[i]), graph.isLeftOut(ids[i]));
  }
  EXPECT_EQ(copy.leftOutLoops().size(), 1U);
  EXPECT_EQ(kinds.size(), 8U);
  const double chi2 = graph.optimise({}).final_chi2;
  EXPECT_EQ(copy.optimise({}).final_chi2, chi2);
}

TEST_F(FactorGraphFile, LoopsThatAreLeftOutAreMarked)
{
  test::NoisyDrive drive(1);
  std::vector<test::LoopMeasurement> loops = drive.threeTrueLoops();
  loops.push_back(drive.trueLoop(40, 190));
  loops.back().T_from_to.translation().x() += 10;
  FactorGraph graph = drive.graph(loops);
  EXPECT_EQ(graph.usedLoops().size(), 4U);
  (void)graph.optimise({});
  ASSERT_EQ(graph.usedLoops().size(), 3U);
  EXPECT_EQ(graph.leftOutLoops().size(), 1U);
  writeFactorGraph(graph, file("graph.txt"));
  const std::string text = contentOf(file("graph.txt"));
  EXPECT_NE(text.find("\nLEFT_OUT_LOOP 40 190 "), std::string::npos);
  EXPECT_EQ(text.find("\nLOOP 40 190 "), std::string::npos);
  EXPECT_NE(text.find("\nLOOP 70 221 "), std::string::npos);
  EXPECT_THROW(graph.leaveOut(graph.factorIds().front()), std::invalid_argument) << "odometry";
}

TEST_F(FactorGraphFile, EmptyGraph)
{
  writeFactorGraph(FactorGraph(), file("empty.txt"));
  EXPECT_EQ(contentOf(file("empty.txt")), "DYSLAM_FACTOR_GRAPH 1\n");
  EXPECT_TRUE(readFactorGraph(file("empty.txt")).variables().empty());
}

TEST_F(FactorGraphFile, UnusableFactorsAreReportedAndLeftOut)
{
  const std::string header =
      "DYSLAM_FACTOR_GRAPH 1\nEGO 0 0 0 0 0 0 0 1\nFIX EGO 0\nEGO 1 1 0 0 0 0 0 1\n"
      "# a comment\n\n";
  const std::string motion = "1 0 0 2 0 1 0 0 0 0 1 0 ";
  const std::string unit = "1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 1\n";
  const std::string singular = "1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 0\n";
  std::vector<std::string> warnings;
  FactorGraph graph = readFactorGraph(
      write(header + "ODOMETRY 0 1 " + motion + unit + "LOOP 0 1 " + motion + singular +
            "LOOP 0 1 1 0 0 nan 0 1 0 0 0 0 1 0 " + unit + "LOOP 0 9 " + motion + unit +
            "LOOP 1 1 " + motion + unit + "LOOP 0 1 2 0 0 2 0 1 0 0 0 0 1 0 " + unit +
            "OBSERVATION 0 EGO 1 " + motion + unit + "OBJECT_MOTION 4 0 1 -1 " + unit),
      warnings);
  EXPECT_EQ(graph.factorCount(), 1U);
  ASSERT_EQ(warnings.size(), 7U);
  const char* parts[] = {":8: left out: factor x0 -> x1: its information is not positive definite",
                         ":9: left out: has numbers that are not finite",
                         ":10: left out: factor of kind loop: its variable x9 is not in the graph",
                         ":11: left out: factor x1 -> x1: connects a variable to itself",
                         ":12: left out: its measurement is no rotation",
                         ":13: left out: observation of x1: not an object's pose",
                         ":14: left out: motion of l4@1: its time step must be above 0"};
  for (std::size_t i = 0; i < warnings.size(); ++i)
  {
    EXPECT_EQ(warnings[i].find(file("graph.txt") + parts[i]), 0U) << warnings[i];
  }
  EXPECT_TRUE(graph.optimise({}).converged);
  EXPECT_NEAR(graph.pose(Key::ego(1)).translation().x(), 2, 1e-6);

  EXPECT_EQ(errorOf(header + "LOOP 0 1 " + motion + singular),
            file("graph.txt") +
                ":7: factor x0 -> x1: its information is not positive definite; correct or remove "
                "the line")
      << "without a list of warnings";
}

TEST_F(FactorGraphFile, DamagedFilesAreNamed)
{
  const std::string header = "DYSLAM_FACTOR_GRAPH 1\n";
  const std::pair<std::string, const char*> cases[] = {
      {"", "graph.txt: is no factor graph; its first line must be 'DYSLAM_FACTOR_GRAPH 1'"},
      {"VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\n", "graph.txt: is no factor graph"},
      {"DYSLAM_FACTOR_GRAPH 2\n", "graph.txt:1: version 2 is not known"},
      {header + "EGO 0 0 0 0 0 0 0\n", "graph.txt:2: ends after 8 fields"},
      {header + "EGO 0 0 0 0 0 0 0 1 5\n", "graph.txt:2: has 10 fields, needs 9"},
      {header + "EGO 0 0 0 x 0 0 0 1\n", "graph.txt:2: 'x' is not a number"},
      {header + "EGO 0 0 0 nan 0 0 0 1\n", "graph.txt:2: 'nan' is not a finite number"},
      {header + "EGO -1 0 0 0 0 0 0 1\n", "graph.txt:2: '-1' must be 0 or more"},
      {header + "EGO 0 0 0 0 0 0 0 2\n", "graph.txt:2: the quaternion of x0 is not of unit length"},
      {header + "EGO 0 0 0 0 0 0 0 1\nEGO 0 0 0 0 0 0 0 1\n", "graph.txt:3: x0 is there twice"},
      {header + "FIX EGO 3\n", "graph.txt:2: fixes x3, which no line before gives a value"},
      {header + "FIX TREE 3\n", "graph.txt:2: 'TREE' is no kind of variable"},
      {header + "BEACON 3\n", "graph.txt:2: 'BEACON' is no kind of variable or factor"},
      {header + "LOOP 0 1 1 0 0\n", "graph.txt:2: ends after 6 fields"}};
  for (const auto& [content, expected] : cases)
  {
    const std::string error = errorOf(content);
    EXPECT_NE(error.find(expected), std::string::npos) << error;
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  }
  EXPECT_THROW((void)readFactorGraph(file("missing.txt")), UserError);
  EXPECT_THROW(writeFactorGraph(FactorGraph(), file("no/such/folder.txt")), UserError);
}
}  // namespace
}  // namespace dyslam
