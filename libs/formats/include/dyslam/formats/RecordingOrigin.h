// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
/** What the rawlog of a run was converted from: `recording.ini` beside it. */
struct RecordingOrigin
{
  std::string input;                  //!< path of the recording that was converted
  std::string converter;              //!< program with its options for the same conversion
  std::vector<std::string> warnings;  //!< of the conversion
  std::string part;                   //!< as flags: "--only-first-n 5"; empty: all of it
};

/** \param folder of the run \return `recording.ini` in it */
[[nodiscard]] std::string recordingOriginFile(const std::string& folder);
/** \throws UserError if the file cannot be written. */
void writeRecordingOrigin(const RecordingOrigin& origin, const std::string& folder);
/** The origin of a rawlog; nothing if it is not the converted one of a run, and if the file is
 * missing or cannot be read. */
[[nodiscard]] std::optional<RecordingOrigin> originOfRecording(const std::string& rawlog);
}  // namespace dyslam
