// SPDX-License-Identifier: BSD-3-Clause
#include "OneRun.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/Words.h>
#include <dyslam/batch/ChildProcess.h>
#include <dyslam/formats/ProgramLines.h>
#include <dyslam/formats/RecordingKind.h>
#include <dyslam/formats/RunFiles.h>

#include <algorithm>
#include <csignal>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <system_error>
#include <vector>

#include "MovedResults.h"

namespace fs = std::filesystem;

namespace dyslam::batch
{
namespace
{
std::string lastLine(const std::string& text)
{
  const auto end = text.find_last_not_of(" \r\n");
  if (end == std::string::npos)
  {
    return "";
  }
  const auto begin = text.find_last_of('\n', end);
  return text.substr(begin == std::string::npos ? 0 : begin + 1, end - begin);
}

std::string tailOf(const std::string& path)
{
  constexpr std::streamoff wanted = 2048;
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  const std::streamoff size = file.tellg();
  file.seekg(std::max<std::streamoff>(0, size - wanted));
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/** Copies log and manifest of a run without results for the next batch and the user; earlier
 * results stay. */
void copyFailure(const fs::path& from, const fs::path& to, const Manifest& manifest)
{
  makeFolder(to.string(), "choose another --output");
  fs::copy_file(from / log_name, to / log_name, fs::copy_options::overwrite_existing);
  writeManifest(to.string(), manifest);
}

/** Requires that a folder is empty or belongs to a batch. \param option flag that names its parent
 * \throws UserError if the folder has files that no batch wrote. */
void requireOwnFolder(const std::string& folder, const std::string& option)
{
  if (fs::exists(folder) && !fs::is_empty(folder) && !fs::exists(fs::path(folder) / log_name))
  {
    throw UserError(folder + ": has files that no batch wrote; choose another " + option);
  }
}

/** Requires that a folder in --scratch, from which results are moved, is not within their folder,
 * nor that within it. \throws UserError. */
void requireApart(const std::string& folder, const std::string& final_folder)
{
  if (folder != final_folder && (isWithin(folder, final_folder) || isWithin(final_folder, folder)))
  {
    throw UserError(folder + " and " + final_folder +
                    ": one is within the other; choose another --scratch");
  }
}

bool hasResults(const ChildOutcome& outcome)
{
  return outcome.code == 0 || outcome.code == 2;
}

/** Whether dyslam converts the recording before it runs. */
bool isConverted(const std::string& recording)
{
  return recordingKind(recording) != RecordingKind::unknown;
}

/** The rawlog that a run reads. */
std::string rawlogOf(const std::string& recording, const std::string& folder)
{
  return isConverted(recording) ? (fs::path(folder) / run_files::recording).string() : recording;
}

/** Whether a run was stopped on its own, not by the batch: by a signal on which dyslam saves its
 * results, if it does not yet convert the recording, and ends. \param line last line of its log */
bool isStoppedAlone(const ChildOutcome& outcome,
                    const std::string& line,
                    const std::string& recording,
                    const std::string& folder)
{
  return outcome.signal == SIGINT || outcome.signal == SIGTERM || outcome.signal == SIGHUP ||
         (!hasResults(outcome) && (isStoppedLine(program_name, recording, line) ||
                                   isStoppedLine(program_name, rawlogOf(recording, folder), line)));
}

/** Sets state and figures of the manifest from the end of a run. \param folder folder of the run;
 * the last line of its log is the reason */
RunEnd recordOutcome(const ChildOutcome& outcome,
                     bool stopped,
                     const std::string& folder,
                     Manifest& m)
{
  const std::string log = (fs::path(folder) / log_name).string();
  m.seconds = outcome.seconds;
  m.peak_memory = outcome.peak_memory;
  m.reason.clear();
  if (stopped)
  {
    m.state = State::running;
    return RunEnd::stopped;
  }
  if (outcome.code == 0)
  {
    m.state = State::done;
  }
  else if (outcome.code == 2)
  {
    m.state = State::unregistered;
    m.reason = lastLine(tailOf(log));
  }
  else
  {
    m.state = State::failed;
    m.reason = outcome.signal != 0
                   ? std::string("ended by the signal ") + ::strsignal(outcome.signal)
                   : lastLine(tailOf(log));
  }
  const bool is_for_next_batch =
      isStoppedAlone(outcome, m.reason, m.work.input, folder) ||
      (m.state == State::failed && canBeCompletedLine(program_name, m.reason));
  m.interrupted = outcome.signal != 0 || is_for_next_batch;
  return is_for_next_batch ? RunEnd::stopped : m.interrupted ? RunEnd::killed : RunEnd::by_itself;
}

/** Whether the folder has a run of the same work that was stopped or killed, or could not write all
 * of its results, with a checkpoint. */
bool canResume(const std::string& folder, const Work& work)
{
  const auto known = readManifest(folder);
  const bool unfinished = known && (known->state == State::running || known->interrupted);
  return unfinished && isSame(known->work, work) && fs::exists(fs::path(folder) / run_files::state);
}
}  // namespace

std::string workFolder(const BatchSettings& settings, const Recording& recording)
{
  const std::string final_folder = folderOf(settings, recording);
  const std::string folder = settings.scratch.empty()
                                 ? final_folder
                                 : (fs::path(settings.scratch) / recording.name).string();
  return isSamePath(folder, final_folder) ? final_folder : folder;
}

std::vector<std::string> argumentsFor(const BatchSettings& settings, const Recording& recording)
{
  std::vector<std::string> words = settings.arguments;
  if (isConverted(recording.path))
  {
    words.insert(words.end(), settings.conversion.begin(), settings.conversion.end());
  }
  return words;
}

Work commonWorkFor(const BatchSettings& settings, const Recording& recording)
{
  Work work = settings.common;
  if (isConverted(recording.path) && !settings.conversion.empty())
  {
    appendWord(work.settings, joined(settings.conversion, " "), " ");
  }
  return work;
}

double shareOfRun(const std::string& log,
                  const std::string& recording,
                  const std::vector<std::string>& arguments)
{
  // Assumed shares of the time: they depend on recording and settings.
  constexpr double unpacked = 0.05;
  constexpr double converted = 0.15;
  const ProgressState state = lastProgressIn(tailOf(log));
  const auto within = [&state](double begin, double end)
  { return begin + state.fraction * (end - begin); };
  if (state.title == progressTitle(program_name, unpacking_part))
  {
    return within(0, unpacked);
  }
  if (state.title == progressTitle(program_name, conversion_part))
  {
    return within(unpacked, converted);
  }
  const double begin = isConverted(recording) && state.fraction > 0 ? converted : 0;
  const double middle = (begin + 1) / 2;
  if (state.title == progressTitle(program_name, first_pass_part))
  {
    return within(begin, middle);
  }
  const auto passes = std::find(arguments.begin(), arguments.end(), "--passes");
  const bool is_second = passes != arguments.end() && passes + 1 != arguments.end() &&
                         *(passes + 1) == "2" && state.fraction > 0;
  return within(is_second ? middle : begin, 1);
}

void recordFailure(const std::string& folder, Manifest& manifest)
{
  try
  {
    if (fs::exists(fs::path(folder) / log_name))
    {
      writeManifest(folder, manifest);
    }
  }
  catch (const std::exception& error)
  {
    if (manifest.reason.find(error.what()) == std::string::npos)
    {
      manifest.reason += std::string("; ") + error.what();
    }
  }
}

namespace
{
/** The command that runs the pipeline on a recording, or resumes its run in the folder. */
std::vector<std::string> commandFor(const BatchSettings& settings,
                                    const Recording& recording,
                                    const std::string& folder,
                                    bool resume)
{
  std::vector<std::string> words{settings.program};
  if (!resume || !isConverted(recording.path))
  {
    words.insert(words.end(), {"-i", recording.path});
  }
  words.insert(words.end(), {"-o", folder});
  if (resume)
  {
    words.emplace_back("--resume");
  }
  else
  {
    words.emplace_back("--force");
    const std::vector<std::string> given = argumentsFor(settings, recording);
    words.insert(words.end(), given.begin(), given.end());
  }
  return words;
}

/** Where a run works, and where its results end: another folder with --scratch. */
struct RunFolders
{
  std::string work;
  std::string results;

  [[nodiscard]] bool differ() const { return work != results; }
};

/** \throws UserError if one of the folders has files that no batch wrote, or cannot be made. */
RunFolders prepareFolders(const BatchSettings& settings, const Recording& recording)
{
  RunFolders folders{workFolder(settings, recording), folderOf(settings, recording)};
  requireApart(folders.work, folders.results);
  restoreEarlier(folders.results);
  requireOwnFolder(folders.results, "--output");
  const char* option = folders.differ() ? "--scratch" : "--output";
  requireOwnFolder(folders.work, option);
  makeFolder(folders.work, std::string("choose another ") + option);
  return folders;
}

/** Runs dyslam once, or resumes its run, and records in the manifest how that ended. */
RunEnd runAttempt(const BatchSettings& settings,
                  const Recording& recording,
                  const std::string& folder,
                  const std::vector<int>& cores,
                  const std::function<bool()>& stop,
                  Manifest& m)
{
  ++m.attempts;
  m.state = State::running;
  m.interrupted = false;
  const bool resume = canResume(folder, m.work);
  if (!resume)
  {
    // Otherwise, if this run is killed before its first checkpoint, that of other work is resumed.
    fs::remove(fs::path(folder) / run_files::state);
  }
  ChildCommand command;
  command.log = (fs::path(folder) / log_name).string();
  if (m.attempts == 1)
  {
    std::error_code ignored;
    fs::remove(command.log, ignored);
  }
  std::ofstream(command.log, std::ios::app) << "attempt " << m.attempts << '\n';
  writeManifest(folder, m);
  command.words = commandFor(settings, recording, folder, resume);
  command.cores = cores;
  bool stopped = false;
  const ChildOutcome outcome = runChild(command, [&] { return stopped = stopped || stop(); });
  stopped = stopped || (!hasResults(outcome) && stop());  // the signal may have reached both
  return recordOutcome(outcome, stopped, folder, m);
}

/** Writes the manifest of a run and moves its results, or copies why it failed, to their folder.
 * A run that the batch stopped stays where it is. */
void deliver(const RunFolders& folders, Manifest& m)
{
  if (m.hasResults())
  {
    if (folders.differ())
    {
      renameOwnFiles(folders.work, folders.results);
    }
    m.settings_checksum = checksumOfFile((fs::path(folders.work) / run_files::settings).string());
  }
  writeManifest(folders.work, m);
  if (folders.differ() && m.hasResults())
  {
    moveResults(folders.work, folders.results);
  }
  else if (folders.differ() && m.state != State::running)
  {
    copyFailure(folders.work, folders.results, m);
  }
}
}  // namespace

RunEnd runOne(const BatchSettings& settings,
              const std::vector<int>& cores,
              const std::function<bool()>& stop,
              BatchResult& result)
{
  const RunFolders folders = prepareFolders(settings, result.recording);
  Manifest& m = result.manifest;
  const auto known = readManifest(folders.work);
  if (folders.differ() && isDone(folders.work, m.work, known))  // could not be moved before
  {
    m = *known;
    moveResults(folders.work, folders.results);
    return RunEnd::by_itself;
  }
  const RunEnd end = runAttempt(settings, result.recording, folders.work, cores, stop, m);
  deliver(folders, m);
  return end;
}
}  // namespace dyslam::batch
