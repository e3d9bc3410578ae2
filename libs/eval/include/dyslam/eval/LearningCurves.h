// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace dyslam
{
/** CSV log of a training. The first column is the step; rows are grouped into series by the columns
 * of text (such as the validation recording). */
struct LearningLog
{
  struct Column
  {
    std::string name;
    std::vector<double> value;  //!< NaN for cells without a number
  };
  std::string name;
  std::vector<double> step;
  std::vector<std::string> series;  //!< of each row; empty without text columns
  std::vector<Column> columns;
};

/** Parses CSV with a header. \param name file name for error messages.
 * \throws UserError for a missing header, a row of different length or no rows. */
[[nodiscard]] LearningLog parseLearningLog(const std::string& text, const std::string& name);

/** PNG of one panel per column over the steps, with one curve per series. Series of more than 60
 * rows are drawn faintly, with their running mean over a fiftieth of the rows on top.
 * \throws std::invalid_argument for a log without rows or columns. */
[[nodiscard]] std::vector<std::uint8_t> renderLearningCurves(const LearningLog& log);
}  // namespace dyslam
