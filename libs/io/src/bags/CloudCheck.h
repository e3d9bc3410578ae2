// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Printable.h>
#include <dyslam/core/Scan.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "conversion/LengthFindings.h"

namespace dyslam
{
/** Recognises clouds of a topic that cannot be registered: without a point that is a number, or in
 * another unit than metres. */
class CloudCheck
{
 public:
  void add(const Scan& scan)
  {
    ++scans_;
    const bool has_point =
        std::any_of(scan.points.begin(), scan.points.end(),
                    [](const Eigen::Vector3f& point) { return point.allFinite(); });
    if (!has_point)
    {
      ++without_point_;
    }
    else if (!is_measured_)
    {
      is_measured_ = true;
      lengths_ = lengthsOf(scan);
    }
  }

  /** \param scale RecordingOptions::scale */
  [[nodiscard]] std::vector<std::string> warnings(double scale) const
  {
    std::vector<std::string> result;
    if (without_point_ > 0)
    {
      result.push_back(
          formatted("%zu of %s have no point with coordinates: they are empty, or all "
                    "coordinates are NaN",
                    without_point_, counted(scans_, "scan").c_str()));
    }
    if (const std::string warning = lengths_.warning(scale); !warning.empty())
    {
      result.push_back("the first scan: " + warning);
    }
    return result;
  }

 private:
  std::size_t scans_ = 0;
  std::size_t without_point_ = 0;
  bool is_measured_ = false;
  LengthFindings lengths_;  //!< of the first scan with points
};
}  // namespace dyslam
