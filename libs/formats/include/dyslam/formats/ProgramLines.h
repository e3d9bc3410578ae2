// SPDX-License-Identifier: BSD-3-Clause
// Writing and parsing of the lines that programs print and dyslam-batch reads in the log of a run.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

namespace dyslam
{
/** Last line of a program that ends with an error: "dyslam: <message>". */
[[nodiscard]] std::string errorLine(const std::string& program, const std::string& message);

/** Message of the error line of a program; nothing for another line. */
[[nodiscard]] std::optional<std::string> messageOfErrorLine(const std::string& program,
                                                            const std::string& line);

/** Why a run ended early: "stopped on request after 3 scans".
 * \param when "on request after 3 scans" */
[[nodiscard]] std::string stopReason(const std::string& when);

/** Error message of a run that was stopped. \param input its recording \param reason stopReason()
 */
[[nodiscard]] std::string stoppedMessage(const std::string& input, const std::string& reason);

/** Whether a line is the error line of a stopped run of a program on a recording. */
[[nodiscard]] bool isStoppedLine(const std::string& program,
                                 const std::string& input,
                                 const std::string& line);

/** End of the error message of a run that has a checkpoint, but not all of its final files: how to
 * write them. \param folder of the results */
[[nodiscard]] std::string completeLaterAdvice(const std::string& folder);

/** Whether a line is the error line of a program with completeLaterAdvice(). */
[[nodiscard]] bool canBeCompletedLine(const std::string& program, const std::string& line);

// Parts of the work of a program that have a progress of their own.
constexpr const char* unpacking_part = "unpacking";
constexpr const char* conversion_part = "conversion";
constexpr const char* first_pass_part = "first pass";

/** Name before the progress of a part of the work: "dyslam, conversion". */
[[nodiscard]] std::string progressTitle(const std::string& program, const std::string& part);

/** Part of a work that was done before. */
struct EarlierWork
{
  double fraction = 0;    //!< of the whole work
  std::size_t count = 0;  //!< units done
};

/** Progress of long work, behind its name: " 45% 9 scans, 10.0/s, 0:01 left". Rates that would be
 * 0.0/s are left out.
 * \param fraction of the work done; 1 at its end, 0 or below if unknown \param count units done
 * \param unit in the plural with an s \param seconds since the start, or since `earlier` was done
 */
[[nodiscard]] std::string progressText(double fraction,
                                       std::size_t count,
                                       const std::string& unit,
                                       double seconds,
                                       const EarlierWork& earlier = {});

/** The last progressText() in a log. */
struct ProgressState
{
  std::string title;    //!< name before it, as of progressTitle()
  double fraction = 0;  //!< of the work done, 0 to 1; 0 if there is none in the log
};

[[nodiscard]] ProgressState lastProgressIn(const std::string& log);
}  // namespace dyslam
