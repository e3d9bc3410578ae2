// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Scan.h>

#include <Eigen/Core>
#include <cstddef>

namespace dyslam
{
/** Recognises scans that are only sectors of a revolution, as some drivers publish them: narrow
 * ones that together look into all directions. */
class SectorCheck
{
 public:
  void add(const Scan& scan)
  {
    constexpr std::size_t enough = 100;  // scans: a revolution of single packets
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    std::size_t returns = 0;
    for (std::size_t i = 0; scans_ < enough && i < scan.size(); ++i)
    {
      if (isReturn(scan.points[i]))
      {
        sum += scan.points[i].head<2>().cast<double>().stableNormalized();
        ++returns;
      }
    }
    if (returns > 0)
    {
      const Eigen::Vector2d mean = sum / static_cast<double>(returns);
      narrowness_ += mean.norm();
      direction_ += mean;
      ++scans_;
    }
  }

  [[nodiscard]] bool areSectors() const
  {
    constexpr std::size_t fewest = 5;
    constexpr double narrow = 0.8;     // mean of the directions of a third of a revolution: 0.83
    constexpr double one_sided = 0.4;  // mean of all directions
    const auto scans = static_cast<double>(scans_);
    return scans_ >= fewest && narrowness_ > narrow * scans &&
           direction_.norm() < one_sided * scans;
  }

 private:
  std::size_t scans_ = 0;
  double narrowness_ = 0;  //!< sum of the lengths of the scans' mean directions
  Eigen::Vector2d direction_ = Eigen::Vector2d::Zero();  //!< sum of these directions
};
}  // namespace dyslam
