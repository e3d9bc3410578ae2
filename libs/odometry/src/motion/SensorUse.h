// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Printable.h>

#include <cstddef>
#include <string>
#include <vector>

namespace dyslam
{
/** How many motions between scans a sensor with samples has measured, and how well. */
struct SensorUse
{
  std::size_t motions = 0;         //!< number of motions between scans
  std::size_t covered = 0;         //!< number of motions with samples throughout
  std::size_t compared = 0;        //!< number of motions compared with those by the scans
  std::size_t contradictions = 0;  //!< number of compared motions with a contradiction
  std::size_t unused = 0;          //!< number of compared motions that were not used

  void count(bool is_covered)
  {
    ++motions;
    covered += is_covered ? 1 : 0;
  }
  void compare(bool contradicts, bool is_used)
  {
    ++compared;
    contradictions += contradicts ? 1 : 0;
    unused += is_used ? 0 : 1;
  }
  /** Adds warnings about samples that are missing and about contradictions.
   * \param sensor name \param remedy what to check; end of the sentence */
  void warn(const std::string& sensor,
            const std::string& remedy,
            std::vector<std::string>& warnings) const
  {
    constexpr std::size_t min_motions = 20;
    constexpr double max_contradictions = 0.2;  // largest share of contradictions
    constexpr double min_covered = 0.5;         // least share of motions with samples throughout
    if (motions >= min_motions &&
        static_cast<double>(covered) < min_covered * static_cast<double>(motions))
    {
      warnings.push_back("the " + sensor + " has samples throughout in only " +
                         std::to_string(covered) + " of " + counted(motions, "motion") +
                         "; check its clock and its rate (motion_sensors.max_gap)");
    }
    if (compared >= min_motions &&
        static_cast<double>(contradictions) > max_contradictions * static_cast<double>(compared))
    {
      warnings.push_back("the " + sensor + " contradicts the scans in " +
                         std::to_string(contradictions) + " of " + counted(compared, "motion") +
                         ", and was not used in " + std::to_string(unused) + "; check " + remedy);
    }
  }
};
}  // namespace dyslam
