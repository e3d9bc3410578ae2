// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/eval/TrajectoryMetrics.h>

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "../common/Checks.h"

namespace dyslam
{
/** Options of the trajectory metrics: --align and --lengths. */
struct MetricFlags
{
  std::string align = "se3";
  TrajectoryMetricsOptions lengths;  //!< without the alignment

  void declare(CLI::App& app)
  {
    app.add_option("--align", align, "alignment for absolute errors: none, first or se3")
        ->check(CLI::IsMember({"none", "first", "se3"}))
        ->capture_default_str();
    app.add_option("--lengths", lengths.lengths,
                   "segment lengths of t_rel and r_rel [m], separated by commas")
        ->delimiter(',')
        ->allow_extra_args(false)
        ->check(positive())
        ->default_str("100,200,...,800");
  }
  /** \throws UserError for a length given twice, whose segments would count double. */
  [[nodiscard]] TrajectoryMetricsOptions options() const
  {
    std::vector<std::string> words;
    for (const double length : lengths.lengths)
    {
      words.push_back(CLI::detail::to_string(length));
    }
    requireDifferent("--lengths", words);
    TrajectoryMetricsOptions all = lengths;
    all.alignment = alignmentFromString(align);
    return all;
  }
};
}  // namespace dyslam
