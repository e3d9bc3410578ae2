// SPDX-License-Identifier: BSD-3-Clause
// Bounds on a real drive; needs DYSLAM_DATA.
#include "RealData.h"

#include <dyslam/formats/ScanFiles.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/odometry/Odometry.h>
#include <dyslam/odometry/Preprocessor.h>
#include <gtest/gtest.h>
#include <mrpt/system/CTimeLogger.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>

namespace dyslam
{
namespace
{
struct Bound
{
  const char* folder;
  const char* poses;
  std::size_t frames;
  double period;       //!< between scans [s]
  double translation;  //!< RMSE per frame [m]
  double rotation;     //!< RMSE per frame [deg]
};

class RealDrive : public testing::TestWithParam<Bound>
{
};

/** What `dyslam` runs with its default settings, without segmentation. */
TEST_P(RealDrive, DefaultOdometryStaysWithinBounds)
{
  DYSLAM_REQUIRE_DATA(GetParam().folder);
  const std::filesystem::path folder = *realDataFolder(GetParam().folder);
  const std::vector<Pose> reference = readKittiPoses((folder / GetParam().poses).string());
  const Config config;
  ConfigLoader loader(config);
  ThreadPool pool(2);
  mrpt::system::CTimeLogger times(false);
  const Preprocessor preprocessor(PreprocessOptions(), pool);
  Odometry odometry(loader, pool, times);
  double translation = 0;
  double rotation = 0;
  for (std::size_t i = 0; i < GetParam().frames; ++i)
  {
    std::array<char, 32> name{};
    std::snprintf(name.data(), name.size(), "%06zu.bin", i);
    Frame frame;
    frame.index = i;
    frame.scan = readBin((folder / "velodyne" / name.data()).string());
    frame.scan.stamp = GetParam().period * static_cast<double>(i);
    ASSERT_GT(frame.scan.size(), 1000U) << name.data();
    odometry.predict(frame);
    frame.cloud = preprocessor.prepare(frame.scan, frame.prior.T_previous_current, frame.dt);
    odometry.estimate(frame);
    odometry.integrate(frame);
    ASSERT_TRUE(frame.motion.converged()) << i << ": " << frame.motion.reason;
    if (i > 0)
    {
      const Pose error =
          (reference[i - 1].inverse() * reference[i]).inverse() * frame.motion.T_previous_current;
      translation += error.translation().squaredNorm();
      rotation += std::pow(rotationAngle(error) * 180 / M_PI, 2);
    }
  }
  const double n = static_cast<double>(GetParam().frames) - 1;
  std::printf("%s: RMSE per frame %.4f m, %.4f deg\n", GetParam().folder,
              std::sqrt(translation / n), std::sqrt(rotation / n));
  EXPECT_LT(std::sqrt(translation / n), GetParam().translation);
  EXPECT_LT(std::sqrt(rotation / n), GetParam().rotation);
}

INSTANTIATE_TEST_SUITE_P(
    Drives,
    RealDrive,
    testing::Values(Bound{"kitti_raw_2011_09_26_drive_0005", "poses_icp_deskewed_velo.txt", 110,
                          0.1034, 0.006, 0.016},
                    Bound{"sfnd_lidar_data_1", "poses_icp_deskewed_velo.txt", 22, 0.1034, 0.006,
                          0.041},
                    Bound{"vls128_run88", "poses_icp_frame_to_frame.txt", 64, 0.091, 0.012, 0.048}),
    [](const testing::TestParamInfo<Bound>& test_info)
    { return std::string(test_info.param.folder); });
}  // namespace
}  // namespace dyslam
