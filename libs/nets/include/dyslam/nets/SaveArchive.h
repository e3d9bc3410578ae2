// SPDX-License-Identifier: BSD-3-Clause
// Includes torch: for nets, train and their tests only.
#pragma once

#include <torch/serialize.h>

#include <string>

namespace dyslam
{
/** Writes what an archive holds; an earlier file of the name stays until the new one is whole.
 * \throws UserError if it cannot be written. */
void saveArchive(torch::serialize::OutputArchive& archive, const std::string& path);
}  // namespace dyslam
