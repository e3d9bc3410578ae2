// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace dyslam
{
/** The fields between the separators, without surrounding blanks; empty fields are kept. */
[[nodiscard]] std::vector<std::string> splitFields(const std::string& text, char separator);

/** splitFields() without empty fields. */
[[nodiscard]] std::vector<std::string> listItems(const std::string& text, char separator);

/** Parses a text that is a finite number and nothing else. \throws std::invalid_argument. */
[[nodiscard]] double numberOf(const std::string& text);
/** Parses a text that is an integer and nothing else. \throws std::invalid_argument or
 * std::out_of_range. */
[[nodiscard]] int wholeNumberOf(const std::string& text);

/** Prepares the CSV file of a training that is continued: removes rows after `last_step`, which the
 * training repeats, and a last row without a line end, which was not written to its end; a new file
 * gets the header. \param header names of the columns, the step first
 * \return step of the last row kept, -1 if there is none \throws UserError. */
long long beginLog(const std::string& file, const std::string& header, long long last_step);

/** Appends rows to a CSV file. \throws UserError if they cannot be written. */
void appendRows(const std::string& file, const std::vector<std::string>& rows);

/** The folder that a setting names; a leading $NAME is read from the environment.
 * \param field the setting, for the message \throws UserError if the variable is not set. */
[[nodiscard]] std::string dataFolder(const std::string& folder, const std::string& field);

/** The file of the weights that --start names: a file, or shipped ones ("dyseg"); empty for
 * nothing. \throws UserError, also for a folder, which may be a training of that name. */
[[nodiscard]] std::string startWeights(const std::string& start);

/** A file or folder that a setting names: relative to the folder of the data, or absolute. */
[[nodiscard]] std::string dataPath(const std::string& data, const std::string& name);
}  // namespace dyslam
