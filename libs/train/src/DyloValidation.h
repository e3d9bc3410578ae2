// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/nets/DyloNetwork.h>
#include <dyslam/train/Recordings.h>

#include <string>
#include <vector>

namespace dyslam
{
/** Errors of relative motions between consecutive scans. */
struct MotionErrors
{
  double translation_rmse = 0;  //!< m
  double translation_mean = 0;  //!< m
  double rotation_rmse_deg = 0;
  double rotation_mean_deg = 0;
  double forward_ratio = 0;  //!< summed estimated over summed true motion along x
};

[[nodiscard]] MotionErrors motionErrors(const std::vector<Pose>& estimates,
                                        const std::vector<Pose>& truths);

struct ValidationRow
{
  std::string recording;
  MotionErrors network;          //!< started from standing still
  MotionErrors predicted_start;  //!< started from its own motion of the step before
  MotionErrors zero_motion, constant_velocity;
  std::vector<double> stage_translation_rmse;  //!< m
  double milliseconds = 0;                     //!< encode one scan and match, mean
};

[[nodiscard]] std::vector<ValidationRow> validateDylo(DyloNetwork& network,
                                                      const std::vector<Recording>& recordings,
                                                      torch::Device device);
[[nodiscard]] std::string validationTable(const std::vector<ValidationRow>& rows);
}  // namespace dyslam
