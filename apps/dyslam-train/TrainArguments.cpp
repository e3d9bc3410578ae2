// SPDX-License-Identifier: BSD-3-Clause
#include "TrainArguments.h"

#include <dyslam/core/Error.h>
#include <dyslam/core/SharedFiles.h>

#include <csignal>
#include <sstream>

namespace dyslam
{
namespace
{
/** The SHARE of --blend. */
double shareOf(const std::string& text)
{
  std::istringstream in(text);
  double share = 0;
  if (!(in >> share) || !in.eof() || share < 0 || share > 1)
  {
    throw UserError("--blend: '" + text + "' is not a share between 0 and 1");
  }
  return share;
}

void checkTogether(const TrainArguments& a, const std::string& help)
{
  const bool judges_a_file = a.validate_only && !a.start.empty();
  if (a.config.empty() || (a.output.empty() && !judges_a_file))
  {
    throw UserError("--config and --output are needed; see " + help);
  }
  if (!a.blend.empty() && a.start.empty())
  {
    throw UserError("--blend: needs --start, the weights to blend with");
  }
  if (a.resume && !a.start.empty())
  {
    throw UserError("--start: not together with --resume, which has weights already");
  }
  if (a.validate_only && (a.resume || !a.blend.empty()))
  {
    throw UserError("--validate: only judges; not together with --resume or --blend");
  }
}

volatile std::sig_atomic_t stop_requested = 0;

void noteSignal(int /*number*/)
{
  stop_requested = 1;
}
}  // namespace

Config TrainArguments::loadConfig() const
{
  Config loaded = Config::fromFile(findGivenOrShared(config, "config_files", ".ini"));
  for (const std::string& assignment : assignments)
  {
    loaded.set(assignment);
  }
  return loaded;
}

TrainArguments parseTrainArguments(const std::string& network,
                                   const std::vector<std::string>& words)
{
  const std::string help = "dyslam-train " + network + " --help";
  TrainArguments a;
  for (std::size_t i = 0; i < words.size(); ++i)
  {
    const std::string& word = words[i];
    const auto value = [&]() -> const std::string&
    {
      if (i + 1 >= words.size())
      {
        throw UserError(word + ": a value is missing; see " + help);
      }
      return words[++i];
    };
    if (word == "-c" || word == "--config")
    {
      a.config = value();
    }
    else if (word == "-o" || word == "--output")
    {
      a.output = value();
    }
    else if (word == "--start")
    {
      a.start = value();
    }
    else if (word == "--blend")
    {
      a.blend = value();
      a.blend_share = shareOf(value());
    }
    else if (word == "--set")
    {
      a.assignments.push_back(value());
    }
    else if (word == "--resume")
    {
      a.resume = true;
    }
    else if (word == "--validate")
    {
      a.validate_only = true;
    }
    else if (word == "--device" && network == "dylo")
    {
      a.device = value();
    }
    else if (word == "--mask-csv" && network == "dylo")
    {
      a.mask_folder = value();
    }
    else
    {
      throw UserError(word + ": unknown option; see " + help);
    }
  }
  checkTogether(a, help);
  return a;
}

bool stopRequested()
{
  static const bool listening = []
  {
    struct sigaction action = {};
    action.sa_handler = noteSignal;
    action.sa_flags = static_cast<int>(SA_RESETHAND);  // a second one ends the program at once
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
    return true;
  }();
  return listening && stop_requested != 0;
}
}  // namespace dyslam
