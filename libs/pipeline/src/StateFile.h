// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace dyslam
{
/** Name of the state within the folder of a run that has not ended. */
constexpr const char* state_file_name = "resume.state";

/** CRC-32, of one piece after the other. \param sum of the pieces before */
[[nodiscard]] std::uint32_t checksum(std::string_view bytes, std::uint32_t sum = 0);

/** Writes parts of bytes, each with its length and checksum, as a PendingFile. \throws UserError */
void writeStateFile(const std::string& path, const std::vector<std::string_view>& parts);

/** The parts of such a file. No memory is taken for more than the file holds.
 * \throws UserError for one that is missing, damaged or of another version */
[[nodiscard]] std::vector<std::string> readStateFile(const std::string& path, std::size_t parts);
}  // namespace dyslam
