// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
/** Flags that select scans of a rawlog; those that are given replace the settings of [input]. */
struct RangeFlags
{
  std::optional<int> skip_first_n;
  std::optional<int> only_first_n;
  std::optional<double> start;  //!< [s since the first scan]
  std::optional<double> end;    //!< [s since the first scan]

  /** Those that are given, as "input.skip_first_n=3". */
  [[nodiscard]] std::vector<std::string> assignments() const;
};

/** Declares --skip-first-n, --only-first-n, --start and --end.
 * \param verb what the program does with the scans, for --help: "process" */
void declareRange(CLI::App& app, RangeFlags& range, const std::string& verb);
}  // namespace dyslam
