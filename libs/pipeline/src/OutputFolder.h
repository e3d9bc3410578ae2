// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "RunOutput.h"

namespace dyslam
{
/** Makes the folder where it is missing and removes what an earlier run left in it, so that
 * everything found there afterwards is of one run.
 *
 * \param names what runs write, removed from the last to the first; nothing else is removed.
 * \param input the recording to be replayed.
 * \throws UserError if the folder cannot be made, if `input` is one of the files to be removed, or
 * if a folder of numbered files holds any though no run was ever written here. */
void prepareOutputFolder(const std::string& folder,
                         const std::vector<OutputName>& names,
                         const std::string& input);
}  // namespace dyslam
