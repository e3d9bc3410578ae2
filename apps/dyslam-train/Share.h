// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Error.h>

#include <sstream>
#include <string>

namespace dyslam
{
/** The SHARE of --blend. \throws UserError for what is no number in [0, 1]. */
inline double shareOf(const std::string& text)
{
  std::istringstream in(text);
  double share = 0;
  if (!(in >> share) || !in.eof() || share < 0 || share > 1)
  {
    throw UserError("--blend: '" + text + "' is not a share between 0 and 1");
  }
  return share;
}

/** What --start goes together with. \throws UserError. */
inline void checkStart(const std::string& start, bool resume, const std::string& blend)
{
  if (!blend.empty() && start.empty())
  {
    throw UserError("--blend: needs --start, the weights to blend with");
  }
  if (resume && !start.empty())
  {
    throw UserError("--start: not together with --resume, which has weights already");
  }
}
}  // namespace dyslam
