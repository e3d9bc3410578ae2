// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace dyslam
{
/** Times of the scans of a folder, a line each; empty lines are of lost scans, without a file.
 * \return [s] \throws UserError. */
[[nodiscard]] std::vector<double> readTimesOfScans(const std::string& file);

/** A file of times that lies with the scans of a folder. */
struct FoundTimes
{
  std::string file;            //!< empty: none that can be used
  std::vector<double> stamps;  //!< of each scan [s]
  std::string why_unused;      //!< why those found are not used; empty: none was found, or it is
};

/** Looks for `times.txt` or `timestamps.txt`, as KITTI names them, in the folder of the scans, else
 * in the one above, else for `times/NAME.txt` beside the latter, as of a sequence of KITTI
 * tracking. It is used if there is only one of them in that folder, with an ascending time for each
 * scan. \param scans their number */
[[nodiscard]] FoundTimes findTimes(const std::string& folder, std::size_t scans);
}  // namespace dyslam
