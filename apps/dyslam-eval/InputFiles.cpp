// SPDX-License-Identifier: BSD-3-Clause
#include "InputFiles.h"

#include <dyslam/core/Error.h>

#include <fstream>
#include <sstream>

namespace dyslam
{
std::string readWhole(const std::string& file, const std::string& advice)
{
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  if (!in || !(text << in.rdbuf()))
  {
    throw UserError(file + ": cannot be read; " + advice);
  }
  return text.str();
}
}  // namespace dyslam
