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
    double stamp = 0;      //!< [s]
    bool is_used = false;  //!< else it is left out, and the scans near it are as well
  };

  void add(double stamp, bool is_used);
  [[nodiscard]] bool empty() const { return scans_.empty(); }
  /** Of two equally near ones the later. \pre not empty() */
  [[nodiscard]] const Met& nearestTo(double stamp) const;
  /** The first one after a stamp; null if there is none yet. */
  [[nodiscard]] const Met* after(double stamp) const;

 private:
  static constexpr std::size_t most = 64;
  std::deque<Met> scans_;  //!< as they were met
};
}  // namespace dyslam
