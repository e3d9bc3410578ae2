// SPDX-License-Identifier: BSD-3-Clause
#include "InputFiles.h"

#include <dyslam/core/Error.h>

#include <fstream>
#include <iterator>

namespace dyslam
{
std::string readWhole(const std::string& file, const std::string& advice)
{
  std::ifstream in(file, std::ios::binary);
  if (!in)
  {
    throw UserError(file + ": cannot be read; " + advice);
  }
  return {std::istreambuf_iterator<char>(in), {}};
}
}  // namespace dyslam
