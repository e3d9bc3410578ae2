// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/PendingFile.h>
#include <dyslam/base/SharedFiles.h>
#include <dyslam/batch/ChildProcess.h>
#include <dyslam/batch/Summary.h>
#include <dyslam/formats/ProgramLines.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

namespace fs = std::filesystem;

namespace dyslam::batch
{
namespace
{
using Json = nlohmann::ordered_json;

/** The style sheet of a run's page, so that both look alike. */
std::string reportStyle()
{
  const std::string page = readWhole(findGivenOrShared("page.html", "report", ".html"));
  const std::string open = "<style>";
  const auto begin = page.find(open);
  const auto end = page.find("</style>", begin);
  if (begin == std::string::npos || end == std::string::npos)
  {
    throw UserError(
        "report/page.html: has no style; DYSLAM_SHARE must be the share/dyslam of this "
        "version");
  }
  return page.substr(begin + open.size(), end - begin - open.size());
}

void writeJson(const std::string& path, const std::vector<BatchResult>& results)
{
  Json json;
  json["recordings"] = Json::array();
  for (const BatchResult& r : results)
  {
    json["recordings"].push_back({{"name", r.recording.name},
                                  {"input", r.recording.path},
                                  {"bytes", r.recording.bytes},
                                  {"state", toString(r.manifest.state)},
                                  {"reason", r.manifest.reason},
                                  {"attempts", r.manifest.attempts},
                                  {"seconds", r.manifest.seconds},
                                  {"peak_memory_bytes", r.manifest.peak_memory}});
  }
  writeWhole(path, json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

/** Runs dyslam-eval on the results. \returns the first of its tables \throws UserError if runs
 * could not be evaluated; the table has the others then. */
std::string evaluate(const BatchSettings& settings,
                     const std::vector<BatchResult>& results,
                     const std::string& evaluation)
{
  const fs::path folder = settings.output;
  ChildCommand command;
  command.words = {evaluation, "run"};
  for (const BatchResult& r : results)
  {
    if (r.manifest.hasResults())
    {
      command.words.push_back(folderOf(settings, r.recording));
    }
  }
  const bool nothing = command.words.size() == 2;
  for (const char* file : {"table.txt", "table.csv", "table.json", "table.log"})
  {
    fs::remove(folder / file);
  }
  if (nothing)
  {
    return "";
  }
  command.words.insert(command.words.end(), {"--csv", (folder / "table.csv").string(), "--json",
                                             (folder / "table.json").string()});
  command.log = (folder / "table.log").string();
  const ChildOutcome outcome = runChild(command);
  const bool has_table = fs::exists(folder / "table.json");  // of the runs that can be read
  std::string table;
  std::istringstream lines(has_table ? readWhole(command.log) : "");
  for (std::string line; std::getline(lines, line);)
  {
    const bool is_about_files =
        line.rfind("note: ", 0) == 0 || messageOfErrorLine("dyslam-eval", line).has_value();
    table += is_about_files ? "" : line + "\n";
  }
  if (has_table)
  {
    writeWhole((folder / "table.txt").string(), table);
  }
  if (outcome.code != 0)
  {
    throw UserError(command.log + ": dyslam-eval could not evaluate " +
                    (has_table ? "some of the runs" : "the runs") + "; it says why");
  }
  fs::remove(command.log);
  return table.substr(0, table.find("\n\n") + 1);
}
}  // namespace

Counts countsOf(const std::vector<BatchResult>& results)
{
  Counts counts;
  for (const BatchResult& r : results)
  {
    counts.skipped += r.skipped ? 1U : 0U;
    switch (r.manifest.state)
    {
      case State::done:
        ++counts.done;
        break;
      case State::unregistered:
        ++counts.unregistered;
        break;
      case State::failed:
        ++counts.failed;
        break;
      default:
        ++counts.open;
    }
  }
  return counts;
}

std::string toText(const Counts& counts)
{
  std::string text = std::to_string(counts.done) + " done";
  const auto add = [&text](std::size_t number, const std::string& what)
  { text += number > 0 ? ", " + std::to_string(number) + " " + what : ""; };
  add(counts.unregistered, "mostly unregistered");
  add(counts.failed, "failed");
  add(counts.open, "not run to the end");
  return text + (counts.skipped > 0 ? " (" + std::to_string(counts.skipped) + " before)" : "");
}

std::string summarise(const BatchSettings& settings,
                      const std::vector<BatchResult>& results,
                      const std::string& evaluation)
{
  const fs::path folder = settings.output;
  writeJson((folder / "batch.json").string(), results);
  std::string table;
  std::string failure;
  try
  {
    table = evaluate(settings, results, evaluation);
  }
  catch (const UserError& error)
  {
    failure = error.what();
  }
  const std::string absolute = fs::absolute(folder).lexically_normal().string();
  writeWhole((folder / "index.html").string(), indexPage(results, absolute, reportStyle()));
  if (!failure.empty())
  {
    throw UserError(failure);
  }
  return table;
}
}  // namespace dyslam::batch
