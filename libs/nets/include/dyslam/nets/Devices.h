// SPDX-License-Identifier: BSD-3-Clause
// Includes torch: for nets, train and their tests only.
#pragma once

#include <torch/types.h>

#include <string>

namespace dyslam
{
/** The device of a setting. \param name cpu or cuda \param setting for the message, as "--device".
 * \throws UserError for another name, or where there is no CUDA. */
[[nodiscard]] torch::Device deviceNamed(const std::string& name, const std::string& setting);
}  // namespace dyslam
