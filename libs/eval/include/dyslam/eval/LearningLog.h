// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace dyslam
{
/** CSV log of a training. The first column is the step; rows are grouped into series by the columns
 * of text and by those named recording, set and start. Columns without any entry are left out. */
struct LearningLog
{
  struct Column
  {
    std::string name;
    std::vector<double> value;  //!< one value per row; NaN for cells without a number
  };
  std::string name;
  std::vector<double> step;
  std::vector<std::string> series;  //!< series of each row; empty without text columns
  std::vector<Column> columns;
};

/** Parses CSV with a header. \param name file name for error messages.
 * \throws UserError for a missing header, a row of different length or no rows. */
[[nodiscard]] LearningLog parseLearningLog(const std::string& text, const std::string& name);
}  // namespace dyslam
