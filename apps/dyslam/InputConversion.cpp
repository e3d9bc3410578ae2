// SPDX-License-Identifier: BSD-3-Clause
#include "InputConversion.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/Printable.h>
#include <dyslam/formats/ProgramLines.h>
#include <dyslam/io/OptionError.h>
#include <dyslam/io/RawlogSource.h>
#include <dyslam/run/FolderLock.h>
#include <dyslam/run/GivenSettings.h>
#include <dyslam/run/KnownSettings.h>

#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "../common/Checks.h"
#include "../common/ConversionReport.h"
#include "../common/Progress.h"
#include "../common/SlamProgram.h"
#include "ConvertedFiles.h"

namespace dyslam
{
namespace fs = std::filesystem;

namespace
{
/** \throws UserError if a run would write among the scans that it reads. */
void requireApart(const std::string& input, const std::string& output)
{
  if (fs::is_directory(input) && isWithin(input, output))
  {
    throw UserError(input + ": a run writes and removes files in --output, where this folder is; " +
                    "choose another --output");
  }
}

/** An error of a converter, in the words of a user of dyslam. */
std::string inDyslam(const UserError& error, const std::string& input, const std::string& program)
{
  const std::string message = error.what();
  const auto* advice = dynamic_cast<const OptionError*>(&error);
  if (advice == nullptr || RecordingOptions::hasFlag(advice->flag()))
  {
    return message;
  }
  const std::string command = program + " -i " + shellWord(input) + " " + advice->flag();
  return message + (advice->flag() == "--list" ? " (" + command + ")"
                                               : " (an option of the converter: " + command +
                                                     " ... -o x.rawlog, then dyslam -i x.rawlog)");
}

/** The part of the recording that a run uses. It is converted, and all of that is then used. */
ScanRange takeRange(const GivenSettings& given, SlamArguments& a)
{
  const Config merged = given.merged();
  const ScanRange range = ConfigLoader(merged).get<RawlogSourceOptions>("input");
  a.range = {};
  if (!range.isAll())
  {
    for (const char* key : {"skip_first_n", "only_first_n", "start", "end"})
    {
      a.assignments.push_back("input." + std::string(key) + "=0");
    }
  }
  return range;
}

/** Size of a recording [bytes]: of a file, or of all files in a folder. */
std::uintmax_t sizeOf(const std::string& input)
{
  std::error_code ignored;
  if (!fs::is_directory(input, ignored))
  {
    const std::uintmax_t size = fs::file_size(input, ignored);
    return ignored ? 0 : size;
  }
  std::uintmax_t sum = 0;
  for (fs::recursive_directory_iterator entry(input, ignored), end; !ignored && entry != end;
       entry.increment(ignored))
  {
    std::error_code no_file;
    const std::uintmax_t size = entry->is_regular_file(no_file) ? entry->file_size(no_file) : 0;
    sum += no_file ? 0 : size;
  }
  return sum;
}

/** Warns if the disk may be too small for the rawlog, which is about as large as the recording. */
void warnOfLittleSpace(const std::string& input, const std::string& folder)
{
  constexpr double gigabyte = 1e9;
  std::error_code error;
  const std::uintmax_t free = fs::space(folder, error).available;
  const std::uintmax_t needed = sizeOf(input);
  if (!error && free < needed)
  {
    printAbove(
        formatted("warning: the conversion may need %.3g GB, the size of %s; the disk of %s "
                  "has %.3g GB free (--only-first-n converts a part)",
                  static_cast<double>(needed) / gigabyte, input.c_str(), folder.c_str(),
                  static_cast<double>(free) / gigabyte));
  }
}

/** Converts, and leaves the files so that a rerun may replace them. \return warnings about the
 * recording \throws UserError. */
std::vector<std::string> convertTo(const ConvertedFiles& files,
                                   const RecordingConverter& converter,
                                   const RecordingOptions& options,
                                   const ScanRange& range,
                                   const SlamArguments& a)
{
  const std::string& input = a.settings.rawlog;
  const bool is_new = !fs::exists(files.rawlog);
  try
  {
    const ConversionResult result = convertWithProgress(
        progressTitle("dyslam", conversion_part), input, files.rawlog, a.quiet(),
        [&](const ConversionProgress& progress)
        {
          return converter.convert(files.rawlog, options, progress,
                                   unpackWithProgress("dyslam", input, a.quiet()), range);
        });
    files.writeOrigin(input, converter.program(), result.warnings, range.flags());
    if (!a.quiet())
    {
      report(result, files.rawlog);
      if (range.isAll())
      {
        std::printf(
            "%s stays: -i %s saves the conversion next time; %s converts with more options\n",
            files.rawlog.c_str(), shellWord(files.rawlog).c_str(), converter.program().c_str());
      }
      else
      {
        std::printf("%s has only this part of the recording (%s)\n", files.rawlog.c_str(),
                    range.flags().c_str());
      }
      std::fflush(stdout);
    }
    return result.warnings;
  }
  catch (const UserError& error)
  {
    if (is_new && fs::exists(files.rawlog))  // with the scans before the error
    {
      files.writeOrigin(input, converter.program(),
                        {std::string("it ended with an error: ") + error.what()}, range.flags());
    }
    throw UserError(inDyslam(error, input, converter.program()));
  }
}
}  // namespace

void completeSettings(SlamArguments& a, const RecordingOptions& options)
{
  const GivenSettings given = readGivenSettings(a.config, assignmentsOf(a));
  requireValidSettings(given);
  if (!options.further_topics.empty() && !given.merged().has("input", "further_lidars"))
  {
    a.assignments.push_back("input.further_lidars=" + options.furtherLidars());
  }
}

void convertInput(SlamArguments& a, const RecordingOptions& options)
{
  const std::string input = a.settings.rawlog;
  const std::string flag = options.givenFlag();
  const auto refuse = [&flag](const std::string& reason)
  { throw UserError(flag + ": is for an input that is converted; " + reason + "; leave it out"); };
  if (a.resume && !flag.empty())
  {
    refuse("a resumed run reads what was converted");
  }
  if (input.empty())
  {
    return;  // an error of its own, but for --resume
  }
  const RecordingConverter converter(input);
  const ConvertedFiles files(a.settings.output_folder);
  if (!flag.empty() && !converter.isNeeded())
  {
    refuse(input + " is not");
  }
  if (!converter.isNeeded())
  {
    repeatConversionWarnings(a);
    return;
  }
  if (a.resume)
  {
    throw UserError(input + ": --resume reads the rawlog of the run, such as " + files.rawlog +
                    "; leave out --input");
  }
  requireNoUnfinishedRun(a.settings);
  requireApart(input, files.folder);
  completeSettings(a, options);  // not only after a conversion, which may take long
  const ScanRange range = takeRange(readGivenSettings(a.config, assignmentsOf(a)), a);
  const bool is_new_folder = !fs::exists(files.folder);
  makeFolder(files.folder, "choose another --output");
  try
  {
    const FolderLock lock(files.folder);
    requireNewRecording(files.rawlog, a.settings.force || files.canBeMadeAgain());
    if (range.isAll() && !a.quiet())
    {
      warnOfLittleSpace(input, files.folder);
    }
    a.settings.warnings = convertTo(files, converter, options, range, a);
  }
  catch (...)
  {
    std::error_code ignored;
    if (is_new_folder)
    {
      fs::remove(files.folder, ignored);  // only if it is empty
    }
    throw;
  }
  a.settings.rawlog = files.rawlog;
}
}  // namespace dyslam
