// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/batch/Recordings.h>

#include <vector>

#include "Arguments.h"

namespace dyslam::batch
{
/** Submits the batch as jobs of Slurm, and says so on stdout. \throws UserError. */
void submitToSlurm(const Arguments& a, const std::vector<Recording>& recordings);
}  // namespace dyslam::batch
