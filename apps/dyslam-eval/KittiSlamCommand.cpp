// SPDX-License-Identifier: BSD-3-Clause
#include "KittiSlamCommand.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Options.h>
#include <dyslam/base/SharedFiles.h>
#include <dyslam/benchmarks/KittiSlamErrors.h>

#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "../common/Checks.h"
#include "../common/OutputOptions.h"
#include "OutputFiles.h"

namespace dyslam
{
namespace
{
struct KittiSlamArguments
{
  KittiSlamArguments()
  {
    setup.detector = "pointrcnn";
    setup.sequences = kittiSlamPaperSequences();
    setup.odometries = {"poor", "middle", "good", "visual"};
    setup.modes = {"odometry", "segmot", "full"};
  }
  std::string config = "kitti_mot.ini";
  std::vector<std::string> set;
  std::string alignment = "se3";
  KittiSlamSetup setup;
  OutputFlags output;
};

KittiSlamSetup setupOf(const KittiSlamArguments& a)
{
  requireDifferent("--modes", a.setup.modes);
  requireDifferent("--odometry", a.setup.odometries);
  requireDifferent("--sequences", a.setup.sequences);
  Config config =
      Config::fromFile(findGivenOrShared(a.config, "config_files", ".ini", "", "dyslam-eval"));
  config.requireFor("dyslam-eval");
  config.set("backend.keyframe_distance=0");
  config.set("objects.window_keyframes=0");
  for (const std::string& assignment : a.set)
  {
    config.set(assignment);
  }
  KittiSlamSetup setup = a.setup;
  setup.alignment = alignmentFromString(a.alignment);
  (void)loadAll(config,
                [&setup](ConfigLoader& loader)
                {
                  setup.tracker = loader.get<TrackerOptions>("tracker");
                  setup.noise = loader.get<DetectionNoiseOptions>("detection_noise");
                  setup.backend = {loader.get<BackendOptions>("backend"),
                                   LoopCloserOptions{},
                                   loader.get<ObjectGraphOptions>("objects"),
                                   loader.get<FactorGraphOptions>("solver"),
                                   GnssOptions{},
                                   GravityOptions{},
                                   PriorMapOptions{}};
                });
  return setup;
}

void runKittiSlam(const KittiSlamArguments& a)
{
  const KittiSlamReport report = evaluateKittiSlam(setupOf(a));
  a.output.write(report.table, report.json);
  if (report.objects.rows() > 0)
  {
    std::cout << report.objects.toText();
  }
}
}  // namespace

Subcommand kittiSlamCommand(CLI::App& app)
{
  const auto a = std::make_shared<KittiSlamArguments>();
  CLI::App* sub = app.add_subcommand(
      "kitti-slam",
      "Evaluates the factor graph of ego and objects on KITTI tracking with given detections, "
      "next to the paper's Table 6");
  sub->add_option("--data", a->setup.data,
                  "folder with label_02, oxts, calib, orbslam3_cam0, det_NAME")
      ->required()
      ->check(CLI::ExistingDirectory);
  sub->add_option("-c,--config", a->config, "ini with tracker and backend")->capture_default_str();
  sub->add_option("--set", a->set, "one setting, overrides the ini")
      ->type_name("SECTION.KEY=VALUE");
  sub->add_option("--detector", a->setup.detector, "det_NAME of the data, or labels")
      ->capture_default_str();
  sub->add_option("--min-score", a->setup.min_score, "of detections")->capture_default_str();
  sub->add_option("--sequences", a->setup.sequences, "sequences")->capture_default_str();
  sub->add_option("--odometry", a->setup.odometries,
                  "drawn ones (sigma per step: poor 0.05 m + 0.5 %, 0.1 deg; middle 0.02 m, 0.05 "
                  "deg; good 0.005 m, 0.015 deg), or the visual one of the data")
      ->check(CLI::IsMember({"poor", "middle", "good", "visual"}))
      ->capture_default_str();
  sub->add_option("--modes", a->setup.modes, "modes of the backend; ratios are to the first")
      ->check(CLI::IsMember({"odometry", "ego", "segmot", "full"}))
      ->capture_default_str();
  sub->add_option("--seeds", a->setup.seeds, "drawn odometries per sequence")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  sub->add_option("--align", a->alignment, "of estimate and truth")
      ->check(CLI::IsMember({"none", "first", "se3"}))
      ->capture_default_str();
  addOutputFolder(*sub, "--speeds", a->setup.speeds,
                  "folder for speeds of vehicles, by tracker and graph; dyslam-eval speeds "
                  "--series reads them (first seed, last mode)");
  a->output.declare(*sub);
  return {sub, [a] { runKittiSlam(*a); }};
}
}  // namespace dyslam
