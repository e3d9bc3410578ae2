// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace dyslam
{
/** Products of the rows around a cell with a convolution's weights: sparse convolution.
 *
 * Half of the places around a cell are empty in a LiDAR scan seen from above. Only the others are
 * multiplied, position by position of the kernel, several cells at once for the weights in the
 * registers. Sums of a cell do not depend on the cells beside it.
 */
class OccupiedProducts
{
 public:
  /** \param rows features, `channels` of each cell \param weight `outputs` rows of `positions` x
   * `channels` \param positions of the kernel \param wide with AVX-512 if this processor has it:
   * the same sums, faster. `rows` must outlive this. */
  OccupiedProducts(const float* rows,
                   std::int64_t channels,
                   const float* weight,
                   std::int64_t positions,
                   std::int64_t outputs,
                   bool wide = true);

  /** Floats from one cell's sums to the next: outputs, rounded up to whole vectors. */
  [[nodiscard]] std::int64_t width() const { return width_; }
  /** Adds to the sums of `count` cells. \param table row at each position of the kernel around each
   * cell, -1 for none \param sums `count` x width() */
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
