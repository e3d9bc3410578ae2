// SPDX-License-Identifier: BSD-3-Clause
// Includes torch: for nets, train and their tests only.
#pragma once

#include <dyslam/nets/DyloNetwork.h>

#include <string>

namespace dyslam
{
/** Writes the weights and the network options to one file. \throws UserError if it cannot be
 * written. */
void saveDylo(DyloNetwork& network, const std::string& path);

/** Whether the file was written by saveDylo(). */
[[nodiscard]] bool isDyloModel(const std::string& path);

/** Reads a network from a file of saveDylo(). \throws UserError if the file is missing, is not a
 * DyLO model or is damaged. */
[[nodiscard]] DyloNetwork loadDylo(const std::string& path);
}  // namespace dyslam
