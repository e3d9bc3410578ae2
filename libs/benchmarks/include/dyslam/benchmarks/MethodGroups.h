// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace dyslam
{
/** Estimates of one method, one for each reference. */
struct MethodGroup
{
  /** What the paths of its estimates have in common, and not those of all groups; empty for a
   * single method. */
  std::string name;
  std::vector<std::size_t> estimates;  //!< their numbers
};

/** Groups of estimates over which a mean is of one method: from one repetition of a reference to
 * the next, as `a/00 a/01 b/00 b/01` of the references `00 01 00 01`. None if the groups would have
 * different references, or if the paths do not tell them apart.
 * \param files paths of the estimates \param references one for each estimate */
[[nodiscard]] std::vector<MethodGroup> methodGroups(const std::vector<std::string>& files,
                                                    const std::vector<std::string>& references);
}  // namespace dyslam
