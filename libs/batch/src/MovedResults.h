// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

namespace dyslam::batch
{
/** Name of the log in the folder of each recording. */
constexpr const char* log_name = "log.txt";

/** Makes the files of a run name those of their own folder as they will be at `to`: the converted
 * recording in report.json, the labels of the first pass in effective.ini. */
void renameOwnFiles(const std::string& from, const std::string& to);

/** Moves results to their folder as a whole: those of an earlier run are replaced at the end, other
 * files stay. A kill or a power cut in between leaves the earlier folder, at worst as `to` with
 * ".earlier"; a full disk leaves both folders as they are. */
void moveResults(const std::filesystem::path& from, const std::filesystem::path& to);

/** Restores a folder that a killed moveResults() has left under its other name. */
void restoreEarlier(const std::filesystem::path& to);
}  // namespace dyslam::batch
