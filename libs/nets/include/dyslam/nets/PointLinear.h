// SPDX-License-Identifier: BSD-3-Clause
// Includes torch: for nets, train and their tests only.
#pragma once

#include <torch/types.h>

namespace dyslam
{
/** leaky(x weight^T + bias): a 1x1 convolution over points [..., in] -> [..., out].
 *
 * On a CPU one fused pass over blocks of rows, the same result for any number of threads; elsewhere
 * torch's own. `slope` is that of the leaky rectifier; 1 leaves it out. */
[[nodiscard]] torch::Tensor pointLinear(const torch::Tensor& x,
                                        const torch::Tensor& weight,
                                        const torch::Tensor& bias,
                                        double slope);
}  // namespace dyslam
