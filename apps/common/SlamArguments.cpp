// SPDX-License-Identifier: BSD-3-Clause
#include "SlamArguments.h"

#include <dyslam/base/Error.h>

#include <utility>

#include "Checks.h"
#include "OutputOptions.h"

namespace dyslam
{
void declareSlamArguments(CLI::App& app, SlamArguments& a)
{
  app.add_option("-c,--config", a.config,
                 "ini file, or the name of a shipped one (default: the shipped one that fits the "
                 "recording's sensor)");
  app.add_option("--set", a.assignments, "one setting, overrides the ini; repeatable")
      ->type_name("SECTION.KEY=VALUE")
      ->take_all()
      ->allow_extra_args(false);
  app.add_flag("--force", a.settings.force, "also replace files in --output that no run wrote");
  app.add_flag("--labels", a.settings.labels,
               "write labels/NNNNNN.label, moving and static points");
  app.add_flag("--probabilities", a.settings.probabilities,
               "write probabilities/NNNNNN.bin, the moving probability of each point (float32)");
  app.add_flag("--static-scans", a.settings.static_scans,
               "write the scans without moving points: static_scans/NNNNNN.bin and a rawlog");
  declareRange(app, a.range, "process");
  CLI::Option* prior_map = app.add_option(
      "--prior-map", a.prior_map,
      "localise the run in this static map: .pcd, .ply, or the output folder of a run; the results "
      "are in its frame");
  app.add_option(
         "--prior-start", a.prior_start,
         "rough pose at the first scan in the prior map (default: searched for in the whole "
         "map)")
      ->type_name("X Y Z YAW PITCH ROLL")
      ->needs(prior_map);
  app.add_option(
         "--passes", a.passes,
         "2: process the recording twice, with segmentation and odometry of the second pass "
         "without the points that the first one labelled moving (dense traffic); --resume goes on "
         "with the second pass, a run stopped or killed in the first one starts anew")
      ->check(CLI::IsMember({1, 2}))
      ->capture_default_str();
  addOutputFile(app, "--profile", a.settings.profile_csv, "CSV file for the times of every stage");
  app.add_flag_callback(
      "-q,--quiet", [&a] { a.verbosity = "ERROR"; }, "print errors only, as --verbosity ERROR");
  app.add_option("-v,--verbosity", a.verbosity, "what is printed")
      ->check(CLI::IsMember({"ERROR", "INFO"}))
      ->capture_default_str();
}

std::vector<std::string> assignmentsOf(const SlamArguments& a)
{
  std::vector<std::string> assignments = a.assignments;
  const std::vector<std::string> of_range = a.range.assignments();
  assignments.insert(assignments.end(), of_range.begin(), of_range.end());
  for (const auto& [key, value] :
       {std::pair("prior_map.file", a.prior_map), std::pair("prior_map.start", a.prior_start)})
  {
    if (!value.empty())
    {
      assignments.push_back(std::string(key) + "=" + value);
    }
  }
  return assignments;
}

void requireGiven(const std::string& rawlog)
{
  if (rawlog.empty())
  {
    throw UserError("--input is required; see --help");
  }
}
}  // namespace dyslam
