// SPDX-License-Identifier: BSD-3-Clause
#include "AppMain.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Version.h>
#include <dyslam/base/Words.h>
#include <dyslam/formats/ProgramLines.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <exception>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <iostream>
#include <new>
#include <sstream>
#include <string>
#include <vector>

#include "OutputOptions.h"

namespace dyslam
{
namespace
{
/** First line of an error text that says something. MRPT's exceptions open with lines such as
 * "==== MRPT exception ====" and have the message behind a label. */
std::string firstMeaningfulLine(const std::string& text)
{
  std::istringstream lines(text);
  std::string first;
  for (std::string line; std::getline(lines, line);)
  {
    const auto begin = line.find_first_not_of(" \t=\r");
    if (begin == std::string::npos || line.find("MRPT exception") != std::string::npos)
    {
      continue;
    }
    for (const std::string label : {"Message:", "message:", "Msg:"})
    {
      const auto at = line.find(label);
      if (at != std::string::npos)
      {
        const auto message = line.find_first_not_of(" \t", at + label.size());
        return message == std::string::npos ? line.substr(begin) : line.substr(message);
      }
    }
    if (first.empty())
    {
      first = trimmed(line.substr(begin));
    }
  }
  return first.empty() ? "unknown error" : first;
}

/** Error message where a subcommand is needed and none was chosen. \param rest words that the
 * parser did not understand */
std::string missingCommand(const CLI::App& app, const std::vector<std::string>& rest)
{
  std::vector<std::string> known;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
  {
    known.push_back(command->get_name());
  }
  if (rest.empty())
  {
    return "a command is needed (one of: " + joined(known) + ")";
  }
  const std::string& word = rest.front();
  return word.rfind('-', 0) == 0
             ? word + ": not expected before the command (one of: " + joined(known) + ")"
             : unknownWord("command", word, known);
}

/** The converters that have an option which the programs that convert on the way lack; empty if
 * none has. */
std::string convertersWith(const std::string& option)
{
  const auto isOneOf = [&](std::initializer_list<const char*> options)
  { return std::find(options.begin(), options.end(), option) != options.end(); };
  const bool of_both =
      isOneOf({"--times", "--poses", "--pose-source", "--every", "--external-storage"});
  const bool of_scans = isOneOf(
      {"--by-number", "--imu-pose", "--keep-partial", "--list", "--truth-frame", "--truth-topic"});
  const bool of_kitti = isOneOf({"--boxes", "--calib", "--gnss", "--kind", "--no-truth", "--oxts",
                                 "--pose-frame", "--sequence"});
  return of_both    ? "scans2rawlog and kitti2rawlog have"
         : of_scans ? "scans2rawlog has"
         : of_kitti ? "kitti2rawlog has"
                    : "";
}

/** Error message for an option that the command does not have. */
std::string unknownOption(const CLI::App& command, const std::string& word)
{
  const bool converts_on_the_way = command.get_option_no_throw("--sensor-pose") != nullptr &&
                                   command.get_option_no_throw("--every") == nullptr;
  const std::string converters = convertersWith(word.substr(0, word.find('=')));
  if (converts_on_the_way && !converters.empty())
  {
    return "unknown option '" + word + "'; " + converters +
           " it: convert the recording to a rawlog first";
  }
  std::vector<std::string> known;
  for (const CLI::Option* option : command.get_options())
  {
    if (option->get_name() != "--help" && option->get_name() != "--version")
    {
      known.push_back(option->get_name());
    }
  }
  return unknownWord("option", word, known);
}

/** Whether a word of the command line is a number, also a negative one. */
bool isNumber(const std::string& word)
{
  double value = 0;
  return CLI::detail::lexical_cast(word, value);
}

/** Calls visit(option) for every option that was given, of the program and of its subcommand. */
void forGivenOptions(const CLI::App& app, const std::function<void(const CLI::Option&)>& visit)
{
  for (const CLI::Option* option : app.get_options())
  {
    if (option->count() > 0)
    {
      visit(*option);
    }
  }
  for (const CLI::App* command : app.get_subcommands())
  {
    forGivenOptions(*command, visit);
  }
}

/** Error message for a value that is no number of the option's type; empty if all are. */
std::string wrongNumber(const CLI::App& app)
{
  std::string message;
  forGivenOptions(app,
                  [&](const CLI::Option& option)
                  {
                    const std::string type = option.get_type_name();
                    const bool whole = type.rfind("INT", 0) == 0 || type.rfind("UINT", 0) == 0;
                    if (!whole && type.rfind("FLOAT", 0) != 0)
                    {
                      return;
                    }
                    for (const std::string& word : option.results())
                    {
                      double value = 0;
                      const bool number = CLI::detail::lexical_cast(word, value);
                      if (!number || std::isnan(value))
                      {
                        message = option.get_name() + " " + word + ": is not a number";
                      }
                      else if (whole && value != std::floor(value))
                      {
                        message = option.get_name() + " " + word + ": is not a whole number";
                      }
                    }
                  });
  return message;
}

/** The option of a pose that was given, whose six numbers are one word; empty if there is none. */
std::string givenPoseOption(const CLI::App& command)
{
  for (const char* name :
       {"--sensor-pose", "--imu-pose", "--further-sensor", "--reference-body", "--map-pose"})
  {
    const CLI::Option* option = command.get_option_no_throw(name);
    if (option != nullptr && option->count() > 0)
    {
      return name;
    }
  }
  return "";
}

/** Whether a word is a setting, `section.key=value`, behind that of a --set. */
bool isSecondSetting(const CLI::App& command, const std::string& word)
{
  const CLI::Option* option = command.get_option_no_throw("--set");
  const auto dot = word.find('.');
  return option != nullptr && option->count() > 0 && dot != std::string::npos &&
         word.find('=', dot) != std::string::npos;
}

/** What the user did wrong, where the parser failed with `error`. */
std::string parseErrorMessage(const CLI::App& app, const CLI::ParseError& error)
{
  const std::vector<std::string> rest = app.remaining(true);
  const auto chosen = app.get_subcommands();
  if (chosen.empty() && app.get_require_subcommand_min() > 0)
  {
    return missingCommand(app, rest);
  }
  const CLI::App& command = chosen.empty() ? app : *chosen.front();
  // CLI11 names a missing option first, even if it is missing because of a mistyped one.
  for (const std::string& word : rest)
  {
    if (word.size() > 1 && word[0] == '-' && !isNumber(word))
    {
      return unknownOption(command, word);
    }
  }
  const std::string pose = givenPoseOption(command);
  if (!rest.empty() && isNumber(rest.front()) && !pose.empty())
  {
    return rest.front() + ": not expected; the six numbers of " + pose +
           " stand in quotes: 'x y z yaw pitch roll'";
  }
  if (!rest.empty() && isSecondSetting(command, rest.front()))
  {
    return rest.front() + ": not expected; each setting has a --set of its own";
  }
  if (!rest.empty() && command.get_option_no_throw("--input") != nullptr)
  {
    return rest.front() + ": not expected; the recording is given with --input";
  }
  const std::string number =
      dynamic_cast<const CLI::ConversionError*>(&error) != nullptr ? wrongNumber(app) : "";
  return number.empty() ? firstMeaningfulLine(error.what()) : number;
}
}  // namespace

int runApp(int argc,
           char** argv,
           const std::function<void(CLI::App&)>& declare,
           const std::function<void()>& run)
{
  std::string name = argc > 0 ? argv[0] : "dyslam";
  name = name.substr(name.find_last_of('/') + 1);
  const auto fail = [&name](const std::string& message)
  {
    std::cout.flush();
    std::cerr << errorLine(name, message) << std::endl;
    return 1;
  };
  // A file beyond `ulimit -f` is then an error of its writer, as on a full disk, and ends no
  // program.
  std::signal(SIGXFSZ, SIG_IGN);
  CLI::App app;
  app.name(name);
  app.set_version_flag("--version", std::string(DYSLAM_VERSION));
  try
  {
    declare(app);
    app.parse(argc, argv);
    if (const std::string number = wrongNumber(app); !number.empty())
    {
      return fail(number + " (see " + name + " --help)");  // NaN is within all of CLI11's ranges
    }
    requireOutputsApart(app);
    run();
    std::cout.flush();
    return std::cout.good() ? 0 : fail("cannot write to standard output");
  }
  catch (const CLI::ParseError& error)
  {
    if (error.get_exit_code() == 0)
    {
      app.exit(error);
      return 0;
    }
    return fail(parseErrorMessage(app, error) + " (see " + name + " --help)");
  }
  catch (const UnusableResult& result)
  {
    fail(result.what());
    return 2;
  }
  catch (const std::bad_alloc&)
  {
    return fail("out of memory");
  }
  catch (const std::filesystem::filesystem_error& error)
  {
    return fail(error.path1().string() + ": " + error.code().message());
  }
  catch (const std::exception& error)
  {
    return fail(firstMeaningfulLine(error.what()));
  }
  catch (...)
  {
    return fail("unknown error");
  }
}
}  // namespace dyslam
