// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace dyslam
{
/** A log of a training: the first column counts steps; columns of words tell rows apart (such as
 * the recording that was validated on). */
struct LearningLog
{
  struct Column
  {
    std::string name;
    std::vector<double> value;  //!< NaN where the cell holds no number
  };
  std::string name;
  std::vector<double> step;
  std::vector<std::string> series;  //!< of each row: its words; empty if the log has none
  std::vector<Column> columns;
};

/** Reads comma-separated text with a line of names. \param name of the file, for errors.
 * \throws UserError for a missing header, a row of another length or no rows. */
[[nodiscard]] LearningLog parseLearningLog(const std::string& text, const std::string& name);

/** One panel per column over the steps, one curve per series, as PNG bytes. Series of more than 60
 * rows are drawn faintly, with their running mean over a fiftieth of them on top.
 * \throws std::invalid_argument for a log without rows or columns. */
[[nodiscard]] std::vector<std::uint8_t> renderLearningCurves(const LearningLog& log);
}  // namespace dyslam
