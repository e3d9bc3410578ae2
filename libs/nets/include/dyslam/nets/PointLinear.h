// SPDX-License-Identifier: BSD-3-Clause
// Includes torch: for nets, train and their tests only.
#pragma once

#include <torch/types.h>

namespace dyslam
{
/** leaky(x weight^T + bias) over points [..., in] -> [..., out].
 *
 * A fused pass over blocks of rows on the CPU, with the same result for any number of threads;
 * torch operations elsewhere. \param slope slope of the leaky ReLU; 1 for none. */
[[nodiscard]] torch::Tensor pointLinear(const torch::Tensor& x,
                                        const torch::Tensor& weight,
                                        const torch::Tensor& bias,
                                        double slope);
}  // namespace dyslam
