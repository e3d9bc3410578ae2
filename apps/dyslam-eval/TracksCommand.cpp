// SPDX-License-Identifier: BSD-3-Clause
#include "TracksCommand.h"

#include <dyslam/base/Error.h>
#include <dyslam/benchmarks/TrackComparison.h>

#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "../common/Checks.h"
#include "OutputFiles.h"

namespace dyslam
{
namespace
{
struct TracksArguments
{
  TrackSources sources;
  std::vector<std::string> types;
  TrackMatching matching;
  TrackSelection selection;
  OutputFlags output;
};

/** \throws UserError for options of a folder x.gt if the reference is a file. */
void requireEffect(const std::vector<const CLI::Option*>& of_folder, const std::string& reference)
{
  for (const CLI::Option* option : of_folder)
  {
    if (option->count() > 0 && !std::filesystem::is_directory(reference))
    {
      throw UserError(option->get_name() +
                      ": selects boxes of a folder x.gt; of a file, all boxes count; leave it out");
    }
  }
}

void runTracks(const TracksArguments& a)
{
  TrackSelection selection = a.selection;
  const TrackData truth = readReferenceTracks(a.sources, selection, printNote);
  if (!a.selection.view && selection.view && *selection.view < 360)
  {
    std::cout << "true boxes are from camera images: those within " << *selection.view
              << " degrees ahead are evaluated (--view)\n";
  }
  const TrackData estimate = readEstimatedTracks(a.sources, truth, selection);
  const std::string warning = boxFrameWarning(a.sources, truth, estimate);
  if (!warning.empty())
  {
    std::cerr << "warning: " << warning << '\n';
  }
  TrackSequence sequence = sequenceOf(a.sources, truth, estimate);
  if (selection.first_frame > 0 && sequence.frames == 0)
  {
    throw UserError("--first-frame " + std::to_string(selection.first_frame) +
                    ": no box of either side is in this frame or later");
  }
  if (const auto range = keepProcessedFrames(a.sources, sequence))
  {
    std::cout << "frames " << range->first << '-' << range->last << " of " << sequence.frames
              << '\n';
  }
  const TrackReport report =
      evaluateTracks(a.sources, a.matching, sequence, trackClasses(a.sources, sequence, a.types),
                     truth.speeds, estimate.speeds);
  a.output.write(report.metrics, report.json);
  std::cout << "\n" << report.errors.toText();
}
}  // namespace

Subcommand tracksCommand(CLI::App& app)
{
  const auto a = std::make_shared<TracksArguments>();
  CLI::App* sub = app.add_subcommand(
      "tracks", "Evaluates tracked objects: CLEAR-MOT, HOTA, AB3DMOT's averages");
  sub->add_option("--reference", a->sources.reference,
                  "true tracks: a recording's ground truth (folder x.gt; slow, distant and "
                  "sparsely observed "
                  "boxes are ignored), or a file of tracks, all of which count")
      ->required()
      ->check(CLI::ExistingPath);
  sub->add_option("--estimate", a->sources.estimate, "estimated tracks: a run's folder, or a file")
      ->required()
      ->check(CLI::ExistingPath);
  sub->add_option("--calib", a->sources.calib,
                  "calibration of KITTI files in the camera frame; the image "
                  "rules of its benchmark apply");
  sub->add_option("--class", a->types,
                  "classes to evaluate; all of the reference by default (with a folder: Car, Van, "
                  "Truck and Bus are Vehicle)");
  CLI::Option* iou = sub->add_option("--iou", a->matching.min_iou, "least 3D IoU of a match")
                         ->check(CLI::Range(0.01, 1.0))
                         ->capture_default_str();
  sub->add_option(
         "--distance", a->matching.max_distance,
         "match by the horizontal distance of the centres up to this instead of the IoU, m")
      ->check(CLI::Range(0.01, 100.0))
      ->excludes(iou);
  const std::vector<const CLI::Option*> of_folder{
      sub->add_option("--min-points", a->selection.min_points,
                      "folder x.gt: true boxes with fewer points are ignored")
          ->check(notNegative())
          ->capture_default_str(),
      sub->add_option("--min-speed", a->selection.min_speed,
                      "folder x.gt: slower true boxes are ignored, m/s")
          ->check(notNegative())
          ->capture_default_str(),
      sub->add_option("--max-range", a->selection.max_range,
                      "folder x.gt: more distant boxes are ignored, m")
          ->check(positive())
          ->capture_default_str(),
      sub->add_option("--view", a->selection.view,
                      "folder x.gt: evaluated horizontal field of view, centred ahead, degrees; by "
                      "default 81 where the true boxes are from KITTI's camera images, else 360")
          ->check(CLI::Range(1.0, 360.0)),
      sub->add_option("--first-frame", a->selection.first_frame,
                      "folder x.gt: earlier frames are removed")
          ->check(notNegative())
          ->capture_default_str(),
      sub->add_option("--instance-offset", a->selection.instance_offset,
                      "folder x.gt: instance in the labels minus track id; by default 0 or 1, with "
                      "which more boxes have points")};
  a->output.declare(*sub);
  return {sub, [a, of_folder]
          {
            requireEffect(of_folder, a->sources.reference);
            runTracks(*a);
          }};
}
}  // namespace dyslam
