// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace dyslam
{
/** Calibration of probabilities: a fraction p of the points with probability p should be moving.
 *
 * Guo, Pleiss, Sun, Weinberger: On calibration of modern neural networks, 2017. */
class CalibrationEvaluator
{
 public:
  /** Points of one range of probabilities. */
  struct Bin
  {
    double from = 0;         //!< least probability
    double to = 0;           //!< largest probability
    std::size_t points = 0;  //!< number of points
    double probability = 0;  //!< mean of the points, in [0, 1]
    double moving = 0;       //!< share of the points that move, in [0, 1]
  };

  /** Adds a scan. Points with an unlabelled reference or a probability that is not a number are
   * ignored. \param reference labels, as for SegmentationEvaluator \param probability in [0, 1]
   * \throws std::invalid_argument if the arrays differ in length. */
  void add(const std::vector<std::uint32_t>& reference, const std::vector<float>& probability);

  [[nodiscard]] std::vector<Bin> bins() const;
  [[nodiscard]] std::size_t points() const { return points_; }
  /** Expected calibration error: mean over all points of |probability - share| of their bin. */
  [[nodiscard]] double expectedError() const;
  /** Mean squared difference of probability and truth (Brier score); less is better. */
  [[nodiscard]] double brierScore() const;

 private:
  static constexpr std::size_t bin_count = 10;
  struct Sums
  {
    std::size_t points = 0;
    std::size_t moving = 0;
    double probability = 0;
  };

  std::array<Sums, bin_count> sums_{};
  std::size_t points_ = 0;
  double squares_ = 0;
};
}  // namespace dyslam
