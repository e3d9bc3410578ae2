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
  std::vector<DysegSample> samples;
};

/** \throws UserError if validation frames are training frames, or their first is after their
 * last. */
void checkDysegValidation(const DysegTrainerOptions& options);

/** Simulated clips, and the frames of real runs that the options name. \throws UserError if they
 * are not there. */
[[nodiscard]] std::vector<DysegValidationSet> makeDysegValidation(
    const DysegTrainerOptions& options);
}  // namespace dyslam
