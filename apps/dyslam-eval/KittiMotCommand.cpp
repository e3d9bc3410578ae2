// SPDX-License-Identifier: BSD-3-Clause
#include "KittiMotCommand.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/Options.h>
#include <dyslam/base/SharedFiles.h>
#include <dyslam/benchmarks/KittiMot.h>

#include <iostream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "../common/Checks.h"
#include "../common/OutputOptions.h"
#include "OutputFiles.h"

namespace dyslam
{
namespace
{
struct KittiMotArguments
{
  std::string config = "kitti_mot.ini";
  std::string split = "validation";
  std::vector<std::string> sequences;
  std::vector<std::string> types{"Car", "Pedestrian", "Cyclist"};
  std::vector<std::string> set;
  KittiMotSetup setup;
  std::string tracks;
  double min_iou = 0.25;
  int repeats = 3;
  OutputFlags output;
};

/** Whether the detections are PointRCNN's, whole and as AB3DMOT used them. */
bool isAsPublished(const KittiMotArguments& a)
{
  return a.split == "validation" && a.sequences.empty() && a.min_iou == 0.25 &&
         a.setup.detections.empty() && !(a.setup.added_noise > 0) && a.setup.every <= 1;
}

KittiMotSetup setupOf(const KittiMotArguments& a)
{
  Config config =
      Config::fromFile(findGivenOrShared(a.config, "config_files", ".ini", "", "dyslam-eval"));
  config.requireFor("dyslam-eval");
  for (const std::string& assignment : a.set)
  {
    config.set(assignment);
  }
  KittiMotSetup setup = a.setup;
  (void)loadAll(config,
                [&setup](ConfigLoader& loader)
                {
                  setup.tracker = loader.get<TrackerOptions>("tracker");
                  setup.noise = loader.get<DetectionNoiseOptions>("detection_noise");
                });
  if (setup.detections.empty())
  {
    setup.detections = setup.data + "/det_pointrcnn";
  }
  return setup;
}

/** \throws UserError if the files of --tracks would replace files that are read. */
void requireTracksApart(const KittiMotArguments& a, const KittiMotSetup& setup)
{
  std::vector<std::string> read{setup.detections};
  for (const std::string& type : a.types)
  {
    read.push_back(setup.detections + "/" + type);
  }
  for (const char* part : {"/label_02", "/oxts", "/calib", "/times"})
  {
    read.push_back(setup.data + part);
  }
  for (const std::string& folder : read)
  {
    if (isSamePath(a.tracks, folder))
    {
      throw UserError(a.tracks + ": has the files that are read; choose another --tracks");
    }
  }
}

void evaluateKittiMot(const KittiMotArguments& a)
{
  requireDifferent("--sequences", a.sequences);
  requireDifferent("--class", a.types);
  const KittiMotSetup setup = setupOf(a);
  requireTracksApart(a, setup);
  const std::vector<std::string> names = !a.sequences.empty()      ? a.sequences
                                         : a.split == "validation" ? kittiMotValidation()
                                                                   : kittiMotTraining();
  std::vector<KittiMotRun> runs;
  NamedKittiMotScores classes;
  for (const std::string& type : a.types)
  {
    runs.push_back(fastestKittiMot(setup, names, type, a.repeats));
    const std::string warning = kittiMotWarning(setup, runs.back(), type);
    if (!warning.empty())
    {
      std::cerr << "warning: " << warning << '\n';
    }
    TrackRules rules = TrackRules::kitti(type);
    rules.min_iou = a.min_iou;
    classes.emplace_back(type, kittiMotScores(runs.back(), rules));
  }
  if (!a.tracks.empty())
  {
    writeKittiMot(a.tracks, setup.data, names, runs);
  }
  const std::string sequences = a.sequences.empty() ? a.split : "chosen";
  a.output.write(kittiMotTable(classes, sequences, isAsPublished(a)), kittiMotJson(classes));
}
}  // namespace

Subcommand kittiMotCommand(CLI::App& app)
{
  const auto a = std::make_shared<KittiMotArguments>();
  CLI::App* sub = app.add_subcommand(
      "kitti-mot",
      "Evaluates the tracker on KITTI tracking with given detections, next to AB3DMOT's figures");
  sub->add_option("--data", a->setup.data, "folder with label_02, oxts and calib")
      ->required()
      ->check(CLI::ExistingDirectory);
  sub->add_option("--detections", a->setup.detections,
                  "folder of detections (NNNN.txt, or such a folder for each class) as AB3DMOT's "
                  "csv or KITTI's tracking columns with a score; default det_pointrcnn in --data")
      ->check(CLI::ExistingDirectory);
  sub->add_option("-c,--config", a->config, "ini with the sections [tracker], [detection_noise]")
      ->capture_default_str();
  sub->add_option("--set", a->set, "one setting, overrides the ini")
      ->type_name("SECTION.KEY=VALUE");
  CLI::Option* split =
      sub->add_option("--split", a->split, "AB3DMOT's validation sequences, or the others")
          ->check(CLI::IsMember({"validation", "training"}))
          ->capture_default_str();
  sub->add_option("--sequences", a->sequences, "these sequences (0000 ...) instead of the split")
      ->excludes(split);
  sub->add_option("--class", a->types, "classes to track")
      ->check(CLI::IsMember({"Car", "Pedestrian", "Cyclist"}))
      ->capture_default_str();
  sub->add_option("--iou", a->min_iou, "3D overlap of a match")
      ->check(CLI::Range(0.01, 1.0))
      ->capture_default_str();
  sub->add_option("--repeats", a->repeats, "number of runs; the speed is that of the fastest")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  sub->add_option("--dt", a->setup.frame_time,
                  "time between scans of sequences without times/NNNN.txt, s")
      ->check(CLI::Range(0.001, 10.0))
      ->capture_default_str();
  sub->add_flag("--deskew,!--no-deskew", a->setup.deskew,
                "boxes and labels are of scans that are not deskewed, as KITTI's (default)");
  CLI::Option* noise =
      sub->add_option("--noise", a->setup.added_noise,
                      "standard deviation of noise added to x and y of the detections, m")
          ->check(CLI::Range(0.0, 10.0));
  sub->add_option("--seed", a->setup.seed, "seed of the added noise")
      ->needs(noise)
      ->capture_default_str();
  sub->add_option("--every", a->setup.every, "use and evaluate only every n-th frame")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  addOutputFolder(*sub, "--tracks", a->tracks,
                  "write KITTI result files to this folder (NNNN.txt, all classes)");
  a->output.declare(*sub);
  return {sub, [a] { evaluateKittiMot(*a); }};
}
}  // namespace dyslam
