// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace dyslam
{
/** Name of the checkpoint in the folder of an unfinished run. */
constexpr const char* state_file_name = "resume.state";

/** Name of the rawlog, in the folder of a run, that another input is converted to. */
constexpr const char* converted_rawlog_name = "recording.rawlog";

/** Names of the files that a run wrote, by report.json in its folder; none without it. */
[[nodiscard]] std::vector<std::string> filesOfRun(const std::string& folder);
/** Whether a file is one of filesOfRun() its folder. */
[[nodiscard]] bool isFileOfRun(const std::string& file);

/** Path of the recording of a run: `input` or, if that is not there, the file of its name in the
 * folder of the run, if there is one. A converted recording is moved with that folder.
 * \param input as in report.json of the run */
[[nodiscard]] std::string recordingOfRun(const std::string& folder, const std::string& input);

/** Path of the static map of a run, map_static.pcd or map_static.ply; empty if it has neither. */
[[nodiscard]] std::string staticMapOfRun(const std::string& folder);
}  // namespace dyslam
