// SPDX-License-Identifier: BSD-3-Clause
// Lines that the programs print and that dyslam-batch finds in the log of a run: written and read
// here, so that both agree.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

namespace dyslam
{
/** The last line of a program that ends with an error: "dyslam: <message>". */
[[nodiscard]] std::string errorLine(const std::string& program, const std::string& message);

/** The message in the error line of that program; nothing for another line. */
[[nodiscard]] std::optional<std::string> messageOfErrorLine(const std::string& program,
                                                            const std::string& line);

/** Why a run ended early: "stopped on request after 3 scans".
 * \param when "on request after 3 scans" */
[[nodiscard]] std::string stopReason(const std::string& when);

/** Error message of a run that was stopped. \param input its recording \param reason stopReason()
 */
[[nodiscard]] std::string stoppedMessage(const std::string& input, const std::string& reason);

/** Whether an error line of that program is that of a stopped run on this recording. */
[[nodiscard]] bool isStoppedLine(const std::string& program,
                                 const std::string& input,
                                 const std::string& line);

/** Progress of long work, behind its name: " 45% 9 scans, 10.0/s, 0:01 left".
 * \param fraction of the work done; 1 at its end, 0 or below if unknown \param count units done
 * \param unit in the plural with an s \param seconds since the start */
[[nodiscard]] std::string progressText(double fraction,
                                       std::size_t count,
                                       const std::string& unit,
                                       double seconds);

/** Fraction of the work done by the last progressText() in a log, 0 to 1; 0 without. */
[[nodiscard]] double progressIn(const std::string& log);
}  // namespace dyslam
