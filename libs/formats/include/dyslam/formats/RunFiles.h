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
}  // namespace dyslam
