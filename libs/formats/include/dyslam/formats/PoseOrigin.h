// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Options.h>

#include <string>

namespace dyslam
{
/** Source of the true poses of a recording. */
enum class PoseSource
{
  unknown,
  simulated,  //!< by the simulator, exact
  gnss_ins,   //!< GNSS and inertial unit: errors of centimetres from scan to scan
  given       //!< by the user or a data set, of unknown accuracy
};

struct PoseOrigin
{
  PoseSource source = PoseSource::unknown;
  std::string name;  //!< name of their file or topic; empty if unknown

  /** Whether errors relative to these poses are only those of the estimate. */
  [[nodiscard]] bool isExact() const { return source == PoseSource::simulated; }
  /** Text such as "GNSS/INS (oxts), not exact". */
  [[nodiscard]] std::string text() const;
  /** What an estimate is compared with where the errors of these poses can be as large as its own:
   * "GNSS/INS". Empty: differences to these poses count as errors. */
  [[nodiscard]] std::string differenceTo() const;
};
/** Name of a source in files and flags: "gnss_ins". */
[[nodiscard]] std::string toString(PoseSource source);
/** Source by its name; unknown for any other word. */
[[nodiscard]] PoseSource poseSourceFromString(const std::string& word);
/** Describes a field of options. */
void describePoseSource(OptionsVisitor& visitor,
                        const char* key,
                        PoseSource& source,
                        const char* help);
}  // namespace dyslam
