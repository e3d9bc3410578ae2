// SPDX-License-Identifier: BSD-3-Clause
// A lidar that is tilted on its vehicle, in a recording that does not state the tilt.
#include <dyslam/base/Angle.h>
#include <dyslam/core/GroundPlane.h>
#include <dyslam/core/Trajectory.h>
#include <dyslam/formats/KittiFiles.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/io/RawlogSource.h>
#include <dyslam/io/RawlogWriter.h>
#include <dyslam/sim/Simulator.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "RunProgram.h"

namespace fs = std::filesystem;

namespace dyslam
{
namespace
{
constexpr double tilt = 20 * radians_per_degree;

class TiltedLidar : public ::testing::Test
{
 protected:
  static void SetUpTestSuite()
  {
    folder_ = fs::temp_directory_path() / ("dyslam_levelling_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
    sim::SimulatorOptions options;
    options.sensor = sim::SensorKind::vlp16;
    options.columns = 450;
    options.seed = 6;
    options.traffic = 0.2;
    options.mounting_roll = -0.2 * tilt;
    options.mounting_pitch = tilt;
    sim::Simulator simulator(options, 1);
    RawlogWriter writer(at("tilted.rawlog"));
    for (int i = 0; i < 25; ++i)
    {
      auto simulated = simulator.next();
      // The recording has no mounting of the lidar, so its vehicle frame is the lidar frame.
      const Pose T_map_lidar = simulated.T_map_vehicle * simulated.scan.T_vehicle_lidar;
      simulated.scan.T_vehicle_lidar = Pose::Identity();
      writer.write(simulated.scan, T_map_lidar);
      truth_.push_back(simulated.scan.stamp, T_map_lidar);
    }
    writer.close();
    levelled_ = run("dyslam", "-i " + at("tilted.rawlog") + " -o " + at("levelled") +
                                  " --labels --static-scans");
    kept_ = run("dyslam", "-i " + at("tilted.rawlog") + " -o " + at("kept") +
                              " --labels --set input.level=false");
  }
  static void TearDownTestSuite() { fs::remove_all(folder_); }

  static std::string at(const std::string& name) { return (folder_ / name).string(); }
  static Outcome run(const std::string& program, const std::string& arguments)
  {
    return runProgram(program, arguments, folder_.string());
  }

  /** Angle between the ground and the z axis of a map around its origin [deg]; 90 if there is none.
   */
  static double inclinationOf(const std::string& map)
  {
    const auto ground = findGroundPlane(readCloud(at(map)).points);
    return ground ? ground->inclination() * degrees_per_radian : 90;
  }

  /** Compares the motions from the first to the last scan. */
  static void expectSameMotion(const Trajectory& truth, const Trajectory& estimate)
  {
    ASSERT_EQ(25U, truth.size());
    ASSERT_EQ(truth.size(), estimate.size());
    const Pose moved = truth[0].pose.inverse() * truth[24].pose;
    const Pose found = estimate[0].pose.inverse() * estimate[24].pose;
    EXPECT_GT(moved.translation().norm(), 2);
    EXPECT_LT((moved.inverse() * found).translation().norm(), 0.2);
  }

  static Trajectory truth_;  //!< true poses of the recorded vehicle
  static fs::path folder_;
  static Outcome levelled_;
  static Outcome kept_;
};
Trajectory TiltedLidar::truth_;
fs::path TiltedLidar::folder_;
Outcome TiltedLidar::levelled_;
Outcome TiltedLidar::kept_;

TEST_F(TiltedLidar, IsLevelled)
{
  ASSERT_EQ(0, levelled_.code) << levelled_.err;
  EXPECT_NE((levelled_.out + levelled_.err).find("note: the ground is inclined by "),
            std::string::npos)
      << levelled_.out << levelled_.err;
  EXPECT_LT(inclinationOf("levelled/map_static.ply"), 1.5);
  const Trajectory truth = readTum(at("levelled/reference_tum.txt"));
  expectSameMotion(truth, readTum(at("levelled/trajectory_tum.txt")));
  // The poses are those of the recording's vehicle frame, in a level map.
  const double pitch = yawPitchRoll(readTum(at("levelled/trajectory_tum.txt"))[0].pose).y();
  EXPECT_NEAR(tilt, pitch, 3 * radians_per_degree);
}

TEST_F(TiltedLidar, HasStaticScansOfTheRecordedVehicle)
{
  RawlogSource source(at("levelled/static_scans.rawlog"));
  for (std::size_t i = 0; i < truth_.size(); ++i)
  {
    const auto frame = source.next();
    ASSERT_TRUE(frame);
    EXPECT_TRUE(frame->scan.T_vehicle_lidar.isApprox(Pose::Identity(), 1e-6));
    ASSERT_TRUE(frame->T_world_vehicle_truth);
    EXPECT_TRUE(frame->T_world_vehicle_truth->isApprox(truth_[i].pose, 1e-6));
  }
}

/** Programs that read the recording without levelling use the poses without conversion. */
TEST_F(TiltedLidar, HasPosesOfTheRecordedVehicle)
{
  expectSameMotion(truth_, readTum(at("levelled/trajectory_tum.txt")));
  fs::create_directories(at("elsewhere"));
  fs::copy_file(at("levelled/trajectory_tum.txt"), at("elsewhere/poses_tum.txt"));
  const std::string along = " --trajectory " + at("elsewhere/poses_tum.txt");
  const Outcome exported =
      run("rawlog2kitti", "-i " + at("tilted.rawlog") + along + " -o " + at("kitti"));
  ASSERT_EQ(0, exported.code) << exported.err;
  Trajectory lidar;
  for (const Pose& pose :
       posesOfMountedSensor(readKittiPoses(at("kitti/sequences/00/poses.txt")),
                            readKittiCalib(at("kitti/sequences/00/calib.txt")).T_cam_velo))
  {
    lidar.push_back(static_cast<double>(lidar.size()), pose);
  }
  expectSameMotion(truth_, lidar);
  const Outcome mapped =
      run("dyslam-map", "-i " + at("tilted.rawlog") + along + " -o " + at("again.ply"));
  ASSERT_EQ(0, mapped.code) << mapped.err;
  EXPECT_NE(mapped.err.find("note: the ground is inclined"), std::string::npos) << mapped.err;
  EXPECT_LT(inclinationOf("again.ply"), 1.5);
}

TEST_F(TiltedLidar, IsAWarningWithoutLevelling)
{
  ASSERT_EQ(0, kept_.code) << kept_.err;
  EXPECT_NE((kept_.out + kept_.err).find("warning: the ground is inclined by "), std::string::npos)
      << kept_.out << kept_.err;
  EXPECT_GT(inclinationOf("kept/map_static.ply"), 15);
}

/** The map is level also with settings that do not contain the levelling rotation. */
TEST_F(TiltedLidar, HasALevelMapAlongItsTrajectory)
{
  for (const std::string& arguments :
       {"--run " + at("levelled"),
        "-i " + at("tilted.rawlog") + " --trajectory " + at("levelled/trajectory_tum.txt"),
        "-i " + at("tilted.rawlog") + " -c vlp16.ini --trajectory " +
            at("levelled/trajectory_tum.txt")})
  {
    const Outcome outcome = run("dyslam-map", arguments + " -o " + at("again.ply"));
    ASSERT_EQ(0, outcome.code) << outcome.err;
    EXPECT_LT(inclinationOf("again.ply"), 1.5) << arguments;
  }
}

/** Trajectories of both vehicle frames are evaluated with the scans of the recording. */
TEST_F(TiltedLidar, IsComparedByTheSharpnessOfTheMap)
{
  const Outcome outcome =
      run("dyslam-eval", "map --self " + at("tilted.rawlog") + " --estimate " +
                             at("levelled/trajectory_tum.txt") + " " +
                             at("kept/trajectory_tum.txt") + " --json " + at("self.json"));
  ASSERT_EQ(0, outcome.code) << outcome.err;
  const auto json = nlohmann::json::parse(std::ifstream(at("self.json")));
  const double levelled = json["trajectories"][0]["mean_plane_variance_m2"].get<double>();
  const double kept = json["trajectories"][1]["mean_plane_variance_m2"].get<double>();
  EXPECT_GT(levelled, 0);
  EXPECT_NEAR(1, levelled / kept, 0.2) << levelled << " " << kept;
}
}  // namespace
}  // namespace dyslam
