// SPDX-License-Identifier: BSD-3-Clause
// Includes torch: for nets, train and their tests only.
#pragma once

#include <dyslam/nets/DyloNetwork.h>

#include <string>

namespace dyslam
{
/** Weights and shape in one file. \throws UserError if it cannot be written. */
void saveDylo(DyloNetwork& network, const std::string& path);

/** True for a file that saveDylo() wrote. */
[[nodiscard]] bool isDyloModel(const std::string& path);

/** \throws UserError if the file is missing, is no DyLO model or does not fit its own shape. */
[[nodiscard]] DyloNetwork loadDylo(const std::string& path);
}  // namespace dyslam
