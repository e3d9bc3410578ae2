// SPDX-License-Identifier: BSD-3-Clause
// Georeferenced map of a recording with GNSS positions and a tilted lidar.
#include <dyslam/base/Angle.h>
#include <dyslam/base/Files.h>
#include <dyslam/formats/GeoreferenceFile.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/io/RawlogWriter.h>
#include <dyslam/mrpt/Geodesy.h>
#include <dyslam/sim/Simulator.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "RunProgram.h"

namespace dyslam
{
namespace
{
namespace fs = std::filesystem;

class GeoreferencedRun : public ::testing::Test
{
 protected:
  void SetUp() override
  {
    folder_ = fs::temp_directory_path() / ("dyslam_georeference_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
    sim::SimulatorOptions options;
    options.sensor = sim::SensorKind::vlp16;
    options.columns = 450;
    options.seed = 6;
    options.traffic = 0.2;
    options.ego_speed = 10;
    options.stops = false;
    options.mounting_pitch = 15 * radians_per_degree;
    sim::Simulator simulator(options, 1);
    RawlogWriter writer(at("drive.rawlog"));
    for (int i = 0; i < 100; ++i)
    {
      auto simulated = simulator.next();
      // The recording has no mounting of the lidar, so its vehicle frame is the lidar frame.
      const Pose T_enu_lidar = simulated.T_map_vehicle * simulated.scan.T_vehicle_lidar;
      simulated.scan.T_vehicle_lidar = Pose::Identity();
      if (i % 5 == 0)
      {
        GnssFix fix;
        fix.stamp = simulated.scan.stamp;
        fix.antenna = {-0.6, 0.3, 0.4};
        fix.position = fromEnu(T_enu_lidar * fix.antenna, origin_);
        fix.horizontal_sigma = fix.vertical_sigma = 0.05;
        writer.write(fix);
      }
      writer.write(simulated.scan, T_enu_lidar);
      truth_.push_back(simulated.scan.stamp, T_enu_lidar);
    }
    writer.close();
  }
  void TearDown() override { fs::remove_all(folder_); }

  [[nodiscard]] std::string at(const std::string& name) const { return (folder_ / name).string(); }
  [[nodiscard]] Outcome run(const std::string& program, const std::string& arguments) const
  {
    return runProgram(program, arguments, folder_.string());
  }

  fs::path folder_;
  GeodeticPosition origin_{-33.86, 151.21, 40};
  Trajectory truth_;  //!< true poses of the lidar, east-north-up of origin_
};
}  // namespace

TEST_F(GeoreferencedRun, TrajectoryAndMapAreInUtm)
{
  const Outcome made = run("dyslam", "-i " + at("drive.rawlog") + " -o " + at("out"));
  ASSERT_EQ(0, made.code) << made.err;
  EXPECT_NE(made.out.find("satellite receiver: "), std::string::npos) << made.out;
  EXPECT_NE(made.err.find("inclined"), std::string::npos) << "is not levelled: " << made.err;
  const Georeference found = readGeoreference(at("out/georeference.ini"));
  EXPECT_TRUE(found.fused);
  EXPECT_EQ(found.epsg, 32756);
  EXPECT_LT(found.horizontal_rmse, 0.1);
  const Trajectory of_map = readTum(at("out/trajectory_tum.txt"));
  const Trajectory utm = readTum(at("out/trajectory_utm.txt"));
  ASSERT_EQ(of_map.size(), truth_.size());
  ASSERT_EQ(utm.size(), truth_.size());
  for (std::size_t i = 0; i < truth_.size(); ++i)
  {
    const Pose& T_enu_lidar = truth_[i].pose;
    const Eigen::Vector3d on_earth =
        toEnu(fromEnu(found.T_enu_map * of_map[i].pose.translation(), found.origin), origin_);
    EXPECT_LT((on_earth - T_enu_lidar.translation()).norm(), 0.3);
    const UtmPosition expected = toUtm(fromEnu(T_enu_lidar.translation(), origin_));
    EXPECT_NEAR(utm[i].pose.translation().x(), expected.easting, 0.3);
    EXPECT_NEAR(utm[i].pose.translation().y(), expected.northing, 0.3);
    // The yaw differs by the angle between the meridian and the grid: 1 deg here.
    const Eigen::AngleAxisd apart(utm[i].pose.linear().transpose() * T_enu_lidar.linear());
    EXPECT_LT(apart.angle(), 2.5 * radians_per_degree);
  }

  const Outcome map = run("dyslam-map", "--run " + at("out") + " --trajectory " +
                                            at("out/trajectory_utm.txt") + " -o " + at("m.las"));
  ASSERT_EQ(0, map.code) << map.err;
  const std::string las = readWhole(at("m.las"));
  EXPECT_NE(las.substr(0, 2000).find("LASF_Projection"), std::string::npos);
  double east_of_map = 0;
  las.copy(reinterpret_cast<char*>(&east_of_map), sizeof east_of_map, 187);
  EXPECT_NEAR(east_of_map, utm[0].pose.translation().x(), 150);

  const Outcome other_zone =
      run("dyslam-map", "--run " + at("out") + " --trajectory " + at("out/trajectory_utm.txt") +
                            " --set map_export.epsg=32755 -o " + at("z.las"));
  EXPECT_EQ(1, other_zone.code);
  EXPECT_NE(other_zone.err.find("map_export.epsg = 32755: the coordinates are in 32756"),
            std::string::npos)
      << other_zone.err;

  const std::string in_map_frame =
      "--run " + at("out") + " -c " + at("m.effective.ini") + " -o " + at("n.las");
  const Outcome refused = run("dyslam-map", in_map_frame);
  EXPECT_EQ(1, refused.code);
  EXPECT_NE(refused.err.find("map_export.epsg = 32756: " + at("out/trajectory_tum.txt") +
                             " is in the map frame of its run"),
            std::string::npos)
      << refused.err;
  const Outcome placed =
      run("dyslam-map", in_map_frame + " --map-pose '455000 5428000 110 37 0 0'");
  EXPECT_EQ(0, placed.code) << placed.err;
  EXPECT_NE(readWhole(at("n.las")).find("LASF_Projection"), std::string::npos);
  const Outcome without = run("dyslam-map", in_map_frame + " --set map_export.epsg=0");
  EXPECT_EQ(0, without.code) << without.err;
  EXPECT_EQ(readWhole(at("n.las")).find("LASF_Projection"), std::string::npos);
}
}  // namespace dyslam
