// SPDX-License-Identifier: BSD-3-Clause
#include "TrainArguments.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/SharedFiles.h>
#include <dyslam/train/TrainDylo.h>
#include <dyslam/train/TrainDyseg.h>

#include <algorithm>

#include "../common/Checks.h"
#include "../common/OutputOptions.h"
#include "../common/StopSignals.h"

namespace dyslam
{
namespace
{
/** The options of both networks. */
void declareCommon(CLI::App& app, TrainArguments& a)
{
  app.add_option("-c,--config", a.config, "ini file, or the name of a shipped one")->required();
  addOutputFolder(app, "-o,--output", a.output,
                  "folder for the results; one that holds a training is not overwritten");
  app.add_flag("--resume", a.resume, "resume the training in --output from its last checkpoint");
  app.add_option("--start", a.start,
                 "initial weights: from another training, or the name of shipped ones");
  app.add_flag("--validate", a.validate_only,
               "only print the validation table of --start, or of the training in --output");
  app.add_option("--device", a.device, "cpu or cuda")->capture_default_str();
  app.add_option("--set", a.assignments, "one setting, overrides the ini; repeatable")
      ->type_name("SECTION.KEY=VALUE")
      ->take_all()
      ->allow_extra_args(false);
}

bool anySectionHas(const Config& config, const std::string& key)
{
  const std::vector<std::string> sections = config.sectionNames();
  return std::any_of(sections.begin(), sections.end(),
                     [&](const std::string& section) { return config.has(section, key); });
}

/** \throws UserError for a setting that only the training of the other network has. */
void requireNoneOfTheOther(const Config& config, const std::string& network)
{
  const bool is_dylo = network == "dylo";
  const Config own = is_dylo ? dyloTrainDefaults() : dysegTrainDefaults();
  const Config other = is_dylo ? dysegTrainDefaults() : dyloTrainDefaults();
  for (const std::string& section : config.sectionNames())
  {
    for (const auto& [key, value] : config.section(section))
    {
      if (other.has(section, key) && !anySectionHas(own, key))
      {
        throw UserError(value.origin + ": [" + section + "] " + key +
                        " is a setting of dyslam-train " + (is_dylo ? "dyseg" : "dylo") +
                        ", not of dyslam-train " + network);
      }
    }
  }
}
}  // namespace

Config TrainArguments::loadConfig(const std::string& network) const
{
  const std::string program = "dyslam-train " + network;
  Config loaded = Config::fromFile(findGivenOrShared(config, "config_files", ".ini", "", program));
  loaded.requireFor(program);
  for (const std::string& assignment : assignments)
  {
    loaded.set(assignment);
  }
  requireNoneOfTheOther(loaded, network);
  loaded.requireSectionsFor(program);
  return loaded;
}

void TrainArguments::requireConsistent() const
{
  const bool evaluates_a_file = validate_only && !start.empty();
  if (output.empty() && !evaluates_a_file)
  {
    throw UserError("--output: is needed, a folder for the results");
  }
  if (resume && !start.empty())
  {
    throw UserError("--start: not together with --resume, which has weights already");
  }
  if (validate_only && resume)
  {
    throw UserError("--validate: only prints; not together with --resume");
  }
}

CLI::App& declareDylo(CLI::App& app, TrainArguments& arguments)
{
  CLI::App& parser = *app.add_subcommand("dylo", "trains the LiDAR odometry network");
  declareCommon(parser, arguments);
  addOutputFolder(
      parser, "--mask-csv", arguments.mask_folder,
      "folder for a validation scan's points with their static confidence, per recording");
  parser.footer(
      "Writes dylo.safetensors (the weights), checkpoint.safetensors (to continue from), log.csv, "
      "validation.csv and\n"
      "effective.ini. --start takes a checkpoint.safetensors, or of a dylo.safetensors the layers "
      "that the network of\n"
      "the config has too. Ctrl-C ends a training after a last checkpoint.");
  return parser;
}

CLI::App& declareDyseg(CLI::App& app, TrainArguments& arguments)
{
  CLI::App& parser = *app.add_subcommand("dyseg", "trains the moving-object segmentation network");
  declareCommon(parser, arguments);
  parser.footer(
      "Writes dyseg.safetensors (the weights), checkpoint.safetensors (to continue from), "
      "train.csv, validation.csv and\n"
      "effective.ini. --start takes a dyseg.safetensors of the same [grid]. Ctrl-C ends a training "
      "after a last checkpoint.");
  return parser;
}

bool stopRequested()
{
  static const bool listening = []
  {
    stopOnSignals();
    return true;
  }();
  return listening && stop_asked;
}
}  // namespace dyslam
