// SPDX-License-Identifier: BSD-3-Clause
// Includes torch: for nets, train and their tests only.
#pragma once

#include <torch/types.h>

#include <string>

namespace dyslam
{
/** The torch device of that name. \param name cpu or cuda \param setting where the name is from,
 * for the message, such as "--device" \throws UserError for another name, or if CUDA is not
 * available. */
[[nodiscard]] torch::Device deviceNamed(const std::string& name, const std::string& setting);
}  // namespace dyslam
