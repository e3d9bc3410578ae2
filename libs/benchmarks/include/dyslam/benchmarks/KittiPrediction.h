// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/benchmarks/KittiTracking.h>
#include <dyslam/eval/Table.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace dyslam
{
/** One-step prediction errors for the paper's Tables 4 and 5, next to the paper's figures. */
struct PaperPrediction
{
  std::string from;  //!< "labels" or "PointRCNN detections"
  Table table4;      //!< errors of target 10/0 by degree and window
  Table table5;      //!< errors of the six targets
  Table means;       //!< mean errors of the six targets by degree and window
  nlohmann::ordered_json json;
};
/** \param data folder with label_02, oxts, calib and det_pointrcnn \throws UserError for files that
 * cannot be read. */
[[nodiscard]] PaperPrediction predictPaperTargets(const std::string& data, bool from_detections);

/** One-step prediction errors for one target. */
struct TargetPrediction
{
  Table table;                              //!< errors by degree and window
  std::optional<double> constant_velocity;  //!< RMSE [m]; nothing if the target is too short
  std::string json;
};
[[nodiscard]] TargetPrediction predictTarget(const KittiTarget& target);
}  // namespace dyslam
