// SPDX-License-Identifier: BSD-3-Clause
#include "LabelPattern.h"

#include <dyslam/base/Error.h>

namespace dyslam
{
LabelPattern::LabelPattern(const std::string& option, const std::string& pattern)
    : option_(option), pattern_(pattern)
{
  // std::regex goes a call deeper with each character.
  if (pattern.size() > longest)
  {
    throw UserError(option + " is longer than " + std::to_string(longest) + " characters");
  }
  try
  {
    compiled_ = pattern;
  }
  catch (const std::regex_error&)
  {
    throw UserError(option + " = " + pattern + " is not a regular expression");
  }
}

bool LabelPattern::fits(const std::string& label) const
{
  return pattern_.empty() || (label.size() <= longest && std::regex_match(label, compiled_));
}

std::string patternFor(const std::string& label)
{
  std::string pattern;
  for (const char c : label)
  {
    pattern += std::string("\\^$.|?*+()[]{}").find(c) == std::string::npos ? "" : "\\";
    pattern += c;
  }
  return pattern;
}
}  // namespace dyslam
