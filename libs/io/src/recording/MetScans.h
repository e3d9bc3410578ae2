// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <deque>

namespace dyslam
{
/** The latest scans of the first lidar of a recording, to find the one nearest in time to a scan of
 * another lidar. */
class MetScans
{
 public:
  struct Met
  {
    double stamp = 0;      //!< stamp of the scan [s]
    bool is_used = false;  //!< false: it and the scans near it are left out
  };

  void add(double stamp, bool is_used);
  [[nodiscard]] bool empty() const { return scans_.empty(); }
  /** The nearest scan; of two equally near ones the later. \pre not empty() */
  [[nodiscard]] const Met& nearestTo(double stamp) const;
  /** The first scan after a stamp; null if there is none yet. */
  [[nodiscard]] const Met* after(double stamp) const;

 private:
  static constexpr std::size_t most = 64;
  std::deque<Met> scans_;  //!< in the order of the recording
};
}  // namespace dyslam
