// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace dyslam
{
/** Makes the folder where it is missing and removes what an earlier run left in it, so that
 * everything found there afterwards is of one run.
 *
 * Only files that a run writes are removed. \param input the recording to be replayed. \throws
 * UserError if the folder cannot be made, if `input` is one of the files to be removed, or if
 * labels/ or static_scans/ hold files though no run was ever written to the folder. */
void prepareOutputFolder(const std::string& folder, const std::string& input);
}  // namespace dyslam
