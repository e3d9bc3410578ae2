// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/train/DysegData.h>
#include <dyslam/train/DysegTrainer.h>

#include <string>
#include <vector>

namespace dyslam
{
struct DysegValidationSet
{
  std::string name;
  bool with_guess = false;  //!< the ego-motion is searched around the true one
  std::vector<DysegSample> samples;
};

/** \throws UserError if validation frames are training frames, or their first is after their
 * last. */
void checkDysegValidation(const DysegTrainerOptions& options);

/** Fixed simulated scenes, and the frames of real runs that the options name. \throws UserError if
 * they are not there. */
[[nodiscard]] std::vector<DysegValidationSet> makeDysegValidation(
    const DysegTrainerOptions& options);
}  // namespace dyslam
