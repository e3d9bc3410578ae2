// SPDX-License-Identifier: BSD-3-Clause
// Includes torch. Tensors on the CPU as Eigen maps, for the hand-written layers.
#pragma once

#include <torch/types.h>

#include <Eigen/Core>

namespace dyslam
{
template <typename T>
using RowMajorMatrix = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/** A contiguous tensor of two dimensions; it must outlive the view. */
template <typename T>
[[nodiscard]] Eigen::Map<const RowMajorMatrix<T>> viewOf(const torch::Tensor& tensor)
{
  return {tensor.data_ptr<T>(), tensor.size(0), tensor.size(1)};
}

/** Whether the hand-written layers can read a tensor: float32 in the memory of the CPU. */
[[nodiscard]] inline bool onCpu(const torch::Tensor& tensor)
{
  return tensor.device().is_cpu() && tensor.scalar_type() == torch::kFloat;
}
}  // namespace dyslam
