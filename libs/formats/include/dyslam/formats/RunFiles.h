// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace dyslam
{
/** Name of the checkpoint within the folder of a run that has not ended. */
constexpr const char* state_file_name = "resume.state";

/** Name of the recording that a run makes of an input that is no rawlog, in its folder. */
constexpr const char* converted_rawlog_name = "recording.rawlog";

/** Names of the files that the run in a folder wrote, by its report.json; none without one. */
[[nodiscard]] std::vector<std::string> filesOfRun(const std::string& folder);
}  // namespace dyslam
