// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Options.h>

#include <string>

namespace dyslam
{
/** Where the true poses of a recording are from. */
enum class PoseSource
{
  unknown,
  simulated,  //!< exact
  gnss_ins,   //!< satellites and inertial unit: off by centimetres from scan to scan
  given       //!< by the user or a data set, of unknown accuracy
};

struct PoseOrigin
{
  PoseSource source = PoseSource::unknown;
  std::string name;  //!< of their file or topic; empty if unknown

  /** Errors against these poses are those of the estimate alone. */
  [[nodiscard]] bool isExact() const { return source == PoseSource::simulated; }
  /** "GNSS/INS (oxts), not exact" */
  [[nodiscard]] std::string text() const;
};
/** The word of a file or a flag: "gnss_ins". */
[[nodiscard]] std::string toString(PoseSource source);
/** Its reverse; unknown for any other word. */
[[nodiscard]] PoseSource poseSourceFromString(const std::string& word);
/** A field of options. */
void describePoseSource(OptionsVisitor& visitor,
                        const char* key,
                        PoseSource& source,
                        const char* help);
}  // namespace dyslam
