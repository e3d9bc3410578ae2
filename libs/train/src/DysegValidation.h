// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/train/DysegData.h>
#include <dyslam/train/DysegScores.h>

#include <string>
#include <vector>

#include "DysegTrainerOptions.h"

namespace dyslam
{
struct DysegValidationSet
{
  std::string name;
  bool with_guess = false;  //!< the initial guess is the true ego-motion
  std::vector<DysegSample> samples;
};

/** Columns of the validation table. */
constexpr const char* dyseg_score_names =
    "set,iou,precision,recall,epe_static_m,epe_moving_m,own_motion_m,own_motion_rad";

/** The columns behind `set`, each after a comma; empty where there is nothing to evaluate, such as
 * the IoU of a set in which nothing moves or is called moving. */
[[nodiscard]] std::string scoreFields(const DysegScores& scores);

/** Checks the validation frames. \throws UserError if they are training frames, or the first is
 * after the last. */
void checkDysegValidation(const DysegTrainerOptions& options);

/** Fixed simulated scenes, and the frames of real runs that the options name. \throws UserError if
 * the runs do not exist. */
[[nodiscard]] std::vector<DysegValidationSet> makeDysegValidation(
    const DysegTrainerOptions& options);
}  // namespace dyslam
