// SPDX-License-Identifier: BSD-3-Clause
#include "RangeFlags.h"

namespace dyslam
{
std::vector<std::string> RangeFlags::assignments() const
{
  std::vector<std::string> assignments;
  const auto add = [&assignments](const std::string& key, const auto& value)
  {
    if (value)
    {
      assignments.push_back(key + "=" + std::to_string(*value));
    }
  };
  add("input.skip_first_n", skip_first_n);
  add("input.only_first_n", only_first_n);
  add("input.start", start);
  add("input.end", end);
  return assignments;
}
}  // namespace dyslam
