// SPDX-License-Identifier: BSD-3-Clause
// Includes torch: for nets, train and their tests only.
#pragma once

#include <torch/serialize.h>

#include <string>

namespace dyslam
{
/** Writes an archive atomically: an existing file is replaced only once the new one is complete.
 * \throws UserError if it cannot be written. */
void saveArchive(torch::serialize::OutputArchive& archive, const std::string& path);
}  // namespace dyslam
