// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace dyslam
{
/** Files of an input that is no rawlog, in the output folder. */
struct ConvertedFiles
{
  explicit ConvertedFiles(const std::string& output);

  /** Writes what the rawlog is made of. \param program converter for the same conversion
   * \param part RecordingOrigin::part \throws UserError if it cannot be written. */
  void writeOrigin(const std::string& input,
                   const std::string& program,
                   const std::vector<std::string>& warnings,
                   const std::string& part = "") const;
  /** Whether a rerun may replace the rawlog: it was converted from a recording. Packets of a lidar
   * on the network exist nowhere else. */
  [[nodiscard]] bool canBeMadeAgain() const;

  std::string folder;
  std::string rawlog;
  std::string origin;  //!< says what the rawlog is made of
};
}  // namespace dyslam
