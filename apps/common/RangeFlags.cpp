// SPDX-License-Identifier: BSD-3-Clause
#include "RangeFlags.h"

#include "Checks.h"

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

void declareRange(CLI::App& app, RangeFlags& range, const std::string& verb)
{
  app.add_option("--skip-first-n", range.skip_first_n, "scans to skip")->check(notNegative());
  app.add_option("--only-first-n", range.only_first_n, "scans to " + verb + " after those; 0: all")
      ->check(notNegative());
  app.add_option("--start", range.start, verb + " scans from this time on [s since the first scan]")
      ->check(notNegative());
  app.add_option("--end", range.end, verb + " scans before this time [s since the first scan]")
      ->check(positive());
}
}  // namespace dyslam
