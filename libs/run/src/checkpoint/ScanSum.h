// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>

#include <cstddef>
#include <cstdint>

namespace dyslam
{
/** Running checksum of the scans of a recording. */
class ScanSum
{
 public:
  void add(const Frame& frame);
  [[nodiscard]] std::size_t scans() const { return scans_; }
  [[nodiscard]] std::uint32_t sum() const { return sum_; }

 private:
  std::size_t scans_ = 0;
  std::uint32_t sum_ = 0;
};
}  // namespace dyslam
