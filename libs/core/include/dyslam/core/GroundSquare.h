// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Quantile.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

namespace dyslam
{
// Local ground from the returns in squares of a horizontal grid. The grid is the caller's.

/** The lowest returns in one square: a low order statistic rather than the minimum is the ground,
 * because multipath echoes lie below the road. */
class GroundSquare
{
 public:
  /** \param z height of a return [m]; of +infinity and not a number only the count is kept */
  void add(float z)
  {
    ++count_;
    if (z < z_[2])
    {
      z_[2] = z;
      if (z_[2] < z_[1])
      {
        std::swap(z_[1], z_[2]);
      }
      if (z_[1] < z_[0])
      {
        std::swap(z_[0], z_[1]);
      }
    }
  }
  /** Number of returns. */
  [[nodiscard]] std::uint32_t count() const { return count_; }
  /** Height of the lowest return; infinity if there is none [m]. */
  [[nodiscard]] float lowest() const { return z_[0]; }
  /** Height of the third lowest return, of fewer the highest; infinity if there is none [m]. */
  [[nodiscard]] float thirdLowest() const
  {
    return z_[2] < none ? z_[2] : (z_[1] < none ? z_[1] : z_[0]);
  }

 private:
  static constexpr float none = std::numeric_limits<float>::infinity();

  std::array<float, 3> z_{none, none, none};  //!< of the three lowest returns, lowest first [m]
  std::uint32_t count_ = 0;                   //!< number of returns
};

/** Heights of the ground in a square and the eight around it, of those where it is known. */
class GroundAround
{
 public:
  /** \param height of the ground in one of the squares [m] */
  void add(float height) { heights_[count_++] = height; }

  /** Highest that the ground of the square in the middle can be: 0.3 m above the median of the
   * squares, so that a roof is no ground; infinity if none is known [m]. */
  [[nodiscard]] float highest()
  {
    constexpr float step = 0.3F;  // of the ground above the median [m]
    const auto end = heights_.begin() + static_cast<std::ptrdiff_t>(count_);
    return count_ == 0 ? std::numeric_limits<float>::infinity()
                       : upperMedian(heights_.begin(), end) + step;
  }

 private:
  std::array<float, 9> heights_{};
  std::size_t count_ = 0;
};
}  // namespace dyslam
