// SPDX-License-Identifier: BSD-3-Clause
// Includes torch: for nets, train and their tests only.
#pragma once

#include <dyslam/nets/DysegNet.h>

#include <string>

namespace dyslam
{
/** A network and the grid it was trained with. */
struct DysegNetwork
{
  DysegNet net{nullptr};
  BevOptions grid;
};

/** Writes weights (half precision), shape and grid to one file. \throws UserError if it cannot be
 * written. */
void saveDyseg(const DysegNetwork& network, const std::string& file);
/** Reads a file of saveDyseg(). \throws UserError naming the file if it is missing, damaged or not
 * a DySeg network. */
[[nodiscard]] DysegNetwork loadDyseg(const std::string& file);
}  // namespace dyslam
