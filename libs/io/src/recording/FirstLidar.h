// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <set>
#include <string>

#include "FurtherLidars.h"
#include "LabelPattern.h"

namespace dyslam
{
/** Decides which lidar of a recording is the first one: that whose label fits an option; without
 * it, the first in the file that is not selected as a further lidar. */
class FirstLidar
{
 public:
  /** \param labels regex; empty: any. \throws UserError if it is no regular expression. */
  explicit FirstLidar(const std::string& labels);

  /** Whether a lidar may be the first one. \param name its label */
  [[nodiscard]] bool mayBe(const std::string& name, const FurtherLidars& further) const;
  /** Whether a scan of the file is of the first lidar, which the first such scan determines.
   * \param name label of its lidar */
  [[nodiscard]] bool takes(const std::string& name, const FurtherLidars& further);
  /** Whether times and rings of the points may be of the first lidar's next scan: those of another
   * lidar must not take their place. \param name label of their scan */
  [[nodiscard]] bool mayOwnTimeRing(const std::string& name, const FurtherLidars& further) const;

  /** Label of the first lidar; empty before its first scan. */
  [[nodiscard]] std::string label() const { return label_.value_or(""); }
  /** Why no scan was of the first lidar, for an error; empty: there was none of any lidar. */
  [[nodiscard]] std::string reasonForNone(const FurtherLidars& further) const;

 private:
  LabelPattern wanted_;
  std::optional<std::string> label_;
  std::set<std::string> met_;  //!< labels of all lidars with scans
};
}  // namespace dyslam
