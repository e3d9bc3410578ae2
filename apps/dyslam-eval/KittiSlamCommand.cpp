// SPDX-License-Identifier: BSD-3-Clause
#include "KittiSlamCommand.h"

#include <dyslam/core/Options.h>
#include <dyslam/core/SharedFiles.h>
#include <dyslam/eval/TrajectoryMetrics.h>

#include <array>
#include <cstdio>
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "KittiSlam.h"
#include "OutputFiles.h"

namespace dyslam
{
namespace
{
struct Arguments
{
  std::string data;
  std::string config = "kitti_mot.ini";
  std::string detector = "pointrcnn";
  std::vector<std::string> set;
  std::vector<std::string> sequences{"0004", "0007", "0008", "0010", "0015", "0018", "0019"};
  std::vector<std::string> odometries{"poor", "middle", "good"};
  std::vector<std::string> modes{"odometry", "segmot", "full"};
  int seeds = 10;
  double min_score = 0;
  std::string alignment = "se3";
  OutputFlags output;
};

constexpr double degree = M_PI / 180;
const std::array<OdometryNoise, 3> noises{{{"poor", 0.05, 0.005, 0.1 * degree},
                                           {"middle", 0.02, 0, 0.05 * degree},
                                           {"good", 0.005, 0, 0.015 * degree}}};

struct Settings
{
  TrackerOptions tracker;
  DetectionNoiseOptions noise;
  BackendConfig backend;
};

Settings settingsOf(const Arguments& a)
{
  Config config = Config::fromFile(findGivenOrShared(a.config, "config_files", ".ini"));
  config.set("backend.keyframe_distance=0");
  config.set("objects.window_keyframes=0");
  for (const std::string& assignment : a.set)
  {
    config.set(assignment);
  }
  ConfigLoader loader(config);
  Settings settings{loader.get<TrackerOptions>("tracker"),
                    loader.get<DetectionNoiseOptions>("detection_noise"),
                    {loader.get<BackendOptions>("backend"), LoopCloserOptions{},
                     loader.get<ObjectGraphOptions>("objects"),
                     loader.get<FactorGraphOptions>("solver")}};
  loader.requireAllUsed();
  return settings;
}

BackendMode modeOf(const std::string& name)
{
  return name == "odometry" ? BackendMode::odometry
         : name == "ego"    ? BackendMode::ego
         : name == "segmot" ? BackendMode::segmot
                            : BackendMode::full;
}

AbsoluteTrajectoryError errorOf(const KittiDrive& drive,
                                const std::vector<Pose>& estimate,
                                Alignment alignment)
{
  PosePairs pairs;
  pairs.stamps = drive.stamps;
  pairs.reference = drive.truth;
  pairs.estimate = estimate;
  return absoluteTrajectoryError(pairs, alignment);
}

void run(const Arguments& a)
{
  Settings settings = settingsOf(a);
  for (const std::string& name : a.sequences)
  {
    const KittiDrive drive = readKittiDrive(a.data, name, a.detector, a.min_score, settings.noise);
    for (const OdometryNoise& noise : noises)
    {
      if (std::find(a.odometries.begin(), a.odometries.end(), noise.name) == a.odometries.end())
      {
        continue;
      }
      std::map<std::string, std::pair<double, double>> sums;
      for (int seed = 0; seed < a.seeds; ++seed)
      {
        const auto odometry =
            noisyOdometry(drive.truth, noise, static_cast<std::uint32_t>(1000 + seed));
        const auto information = stepInformation(odometry, noise);
        for (const std::string& mode : a.modes)
        {
          settings.backend.backend.mode = modeOf(mode);
          const KittiSlamRun result =
              runKittiSlam(drive, odometry, information, settings.tracker, settings.backend);
          const AbsoluteTrajectoryError error = errorOf(drive, result.trajectory, alignmentFromString(a.alignment));
          sums[mode].first += error.translation.rmse / a.seeds;
          sums[mode].second += error.rotation_deg.rmse / a.seeds;
        }
      }
      std::printf("%s %-7s", name.c_str(), noise.name.c_str());
      for (const std::string& mode : a.modes)
      {
        std::printf("  %s %.4f m %.3f deg (%.3f)", mode.c_str(), sums[mode].first,
                    sums[mode].second, sums[mode].first / sums["odometry"].first);
      }
      std::printf("\n");
      std::fflush(stdout);
    }
  }
}
}  // namespace

Subcommand kittiSlamCommand(CLI::App& app)
{
  const auto a = std::make_shared<Arguments>();
  CLI::App* sub = app.add_subcommand(
      "kitti-slam",
      "Evaluates the factor graph of ego and objects on KITTI tracking with detections of others, "
      "next to the paper's Table 6");
  sub->add_option("--data", a->data, "folder with label_02, oxts, calib and det_pointrcnn")
      ->required()
      ->check(CLI::ExistingDirectory);
  sub->add_option("-c,--config", a->config, "ini with tracker and backend")->capture_default_str();
  sub->add_option("--set", a->set, "section.key=value, overrides the ini");
  sub->add_option("--detector", a->detector, "det_NAME of the data, or labels")
      ->capture_default_str();
  sub->add_option("--min-score", a->min_score, "of detections")->capture_default_str();
  sub->add_option("--sequences", a->sequences, "sequences")->capture_default_str();
  sub->add_option("--odometry", a->odometries, "poor, middle, good")->capture_default_str();
  sub->add_option("--modes", a->modes, "modes of the backend")->capture_default_str();
  sub->add_option("--seeds", a->seeds, "drawn odometries per sequence")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  sub->add_option("--align", a->alignment, "none, first or se3")->capture_default_str();
  a->output.declare(*sub);
  return {sub, [a] { run(*a); }};
}
}  // namespace dyslam
