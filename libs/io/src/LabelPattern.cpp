// SPDX-License-Identifier: BSD-3-Clause
#include "LabelPattern.h"

#include <dyslam/core/Error.h>

#include <cstddef>

namespace dyslam
{
namespace
{
constexpr std::size_t longest_label = 256;  //!< std::regex goes a call deeper with each character
}  // namespace

LabelPattern::LabelPattern(const std::string& option, const std::string& pattern)
    : option_(option), pattern_(pattern)
{
  if (pattern.size() > longest_label)
  {
    throw UserError(option + " is longer than " + std::to_string(longest_label) + " characters");
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
  return pattern_.empty() || (label.size() <= longest_label && std::regex_match(label, compiled_));
}
}  // namespace dyslam
