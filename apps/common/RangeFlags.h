// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "Checks.h"

namespace dyslam
{
/** Flags that select scans of a rawlog; those that are given replace the settings of [input].
 * Programs without settings declare the flags for a ScanRange. */
struct RangeFlags
{
  std::optional<int> skip_first_n;
  std::optional<int> only_first_n;
  std::optional<double> start;  //!< [s since the first scan]
  std::optional<double> end;    //!< [s since the first scan]

  /** Those that are given, as "input.skip_first_n=3". */
  [[nodiscard]] std::vector<std::string> assignments() const;

  /** Sets those that are given. \tparam Range ScanRange, or options that are one */
  template <typename Range>
  void applyTo(Range& range) const
  {
    range.skip_first_n = skip_first_n.value_or(range.skip_first_n);
    range.only_first_n = only_first_n.value_or(range.only_first_n);
    range.start = start.value_or(range.start);
    range.end = end.value_or(range.end);
  }
};

/** Declares --skip-first-n and --only-first-n. \tparam Range RangeFlags, ScanRange, or options that
 * are one \param verb what the program does with the scans, for --help: "process" */
template <typename Range>
std::vector<CLI::Option*> declareScanCount(CLI::App& app, Range& range, const std::string& verb)
{
  return {
      app.add_option("--skip-first-n", range.skip_first_n, "scans to skip")->check(notNegative()),
      app.add_option("--only-first-n", range.only_first_n,
                     "scans to " + verb + " after those; 0: all")
          ->check(notNegative())};
}

/** declareScanCount() with --start and --end. */
template <typename Range>
void declareRange(CLI::App& app, Range& range, const std::string& verb)
{
  declareScanCount(app, range, verb);
  app.add_option("--start", range.start, verb + " scans from this time on [s since the first scan]")
      ->check(notNegative());
  app.add_option("--end", range.end, verb + " scans before this time [s since the first scan]")
      ->check(positive());
}
}  // namespace dyslam
