// SPDX-License-Identifier: BSD-3-Clause
#include "PredictionCommand.h"

#include <dyslam/base/Error.h>
#include <dyslam/benchmarks/JsonText.h>
#include <dyslam/benchmarks/KittiPrediction.h>

#include <iostream>
#include <memory>
#include <string>

#include "OutputFiles.h"

namespace dyslam
{
namespace
{
struct PredictionArguments
{
  std::string data;
  std::string boxes;
  std::string oxts;
  std::string calib;
  std::string detections;
  int track = -1;
  OutputFlags output;
};

void runPaperTables(const PredictionArguments& a)
{
  nlohmann::ordered_json json;
  for (const bool detections : {false, true})
  {
    const PaperPrediction result = predictPaperTargets(a.data, detections);
    std::cout << result.table4.toText() << "\n" << result.table5.toText() << "\n";
    json[result.from] = result.json;
    if (detections)
    {
      a.output.write(result.means, textOf(json));
    }
    else
    {
      std::cout << result.means.toText() << "\n";
    }
  }
}

void runPrediction(const PredictionArguments& a)
{
  if (!a.data.empty())
  {
    runPaperTables(a);
    return;
  }
  if (a.boxes.empty() || a.oxts.empty() || a.calib.empty() || a.track < 0)
  {
    throw UserError(
        "prediction: give --data DIR for the paper's targets, or --boxes, --oxts, --calib and "
        "--track for one");
  }
  const TargetPrediction result =
      predictTarget(readKittiTarget(a.boxes, a.oxts, a.calib, a.track, a.detections));
  std::cout << "constant velocity: " << TableCell(result.constant_velocity, 3).text << " m\n";
  a.output.write(result.table, result.json);
}
}  // namespace

Subcommand predictionCommand(CLI::App& app)
{
  const auto a = std::make_shared<PredictionArguments>();
  CLI::App* sub = app.add_subcommand(
      "prediction",
      "One-step errors of trajectory prediction by degree and window (KITTI tracking)");
  CLI::Option* data =
      sub->add_option("--data", a->data,
                      "KITTI tracking folder (label_02, oxts, calib, det_pointrcnn): the paper's "
                      "six targets, with its results")
          ->check(CLI::ExistingDirectory);
  sub->add_option("--boxes", a->boxes, "labels of one sequence (label_02/NNNN.txt)");
  sub->add_option("--oxts", a->oxts, "its GNSS/INS readings");
  sub->add_option("--calib", a->calib, "its calibration");
  sub->add_option("--track", a->track, "id of the target");
  sub->add_option("--detections", a->detections,
                  "predict from these detections (AB3DMOT's csv) instead of the labels");
  for (const char* of_one_target : {"--boxes", "--oxts", "--calib", "--track", "--detections"})
  {
    data->excludes(sub->get_option(of_one_target));
  }
  a->output.declare(*sub);
  return {sub, [a] { runPrediction(*a); }};
}
}  // namespace dyslam
