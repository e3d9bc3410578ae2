// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace dyslam
{
/** `dyslam-train dyseg`: the moving-object segmentation network.
 *
 * \param words what follows `dyseg` on the command line. \return the exit code.
 * \throws UserError.
 */
int trainDysegCommand(const std::vector<std::string>& words);
}  // namespace dyslam
