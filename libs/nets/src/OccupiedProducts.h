// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace dyslam
{
/** Products of the rows around a cell with a convolution's weights: sparse convolution.
 *
 * About half of the cells around an occupied cell are empty in a LiDAR scan seen from above. Only
 * the occupied ones are multiplied, position by position of the kernel, several cells at once for
 * the weights in the registers. The sums of a cell do not depend on the cells beside it.
 */
class OccupiedProducts
{
 public:
  /** \param rows features, `channels` per cell; must outlive this object \param weight `outputs`
   * rows of `positions` x `channels` \param positions number of positions of the kernel \param wide
   * use AVX-512 if this processor has it: the same sums, faster */
  OccupiedProducts(const float* rows,
                   std::int64_t channels,
                   const float* weight,
                   std::int64_t positions,
                   std::int64_t outputs,
                   bool wide = true);

  /** Number of floats per cell in `sums`: the outputs, rounded up to whole vectors. */
  [[nodiscard]] std::int64_t width() const { return width_; }
  /** Adds the products of `count` cells to their sums. \param table row at each position of the
   * kernel around each cell, -1 for none \param[in,out] sums `count` x width() */
  void addTo(const std::int32_t* table, std::int64_t count, float* sums) const;

 private:
  struct Kernel;
  static const Kernel& kernelFor(bool wide);

  const Kernel& kernel_;
  const float* rows_;
  std::int64_t channels_;
  std::int64_t positions_;
  std::int64_t width_;
  std::vector<float> weight_;  // positions x channels x width
};
}  // namespace dyslam
