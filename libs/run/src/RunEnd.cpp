// SPDX-License-Identifier: BSD-3-Clause
#include "RunEnd.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Printable.h>
#include <dyslam/base/Words.h>
#include <dyslam/formats/ProgramLines.h>
#include <dyslam/run/RunSlam.h>

#include <vector>

namespace dyslam
{
namespace
{
/** Message for the user with advice. \return empty if the run did not end early */
std::string messageOf(const EarlyEnd& end, std::size_t frames, const SlamRunSettings& settings)
{
  const std::string& folder = settings.output_folder;
  std::string what;
  if (end.is_stopped)
  {
    what = stoppedMessage(settings.rawlog, earlyEndReason(end, frames)) +
           ", whose results are in " + folder;
    what += hasCheckpoint(folder) ? "; continue with: dyslam --resume -o " + shellWord(folder) : "";
  }
  else if (!end.damage.empty())
  {
    what =
        end.damage + "; results of the " + counted(frames, "scan") + " before it are in " + folder;
  }
  return what;
}

/** Appends what could not be written. The advice that follows must be in the printed line, which is
 * cut at its end, so after a full disk only the first failures are named. */
void appendFailures(const std::vector<std::string>& failures, std::string& what)
{
  constexpr std::size_t long_enough = 200;  // letters
  std::size_t named = 0;
  while (named < failures.size() && (named == 0 || what.size() < long_enough))
  {
    appendWord(what, failures[named], "; ");
    ++named;
  }
  if (named < failures.size())
  {
    what += "; " + counted(failures.size() - named, "more result") + " could not be written";
  }
}
}  // namespace

std::string earlyEndReason(const EarlyEnd& end, std::size_t frames)
{
  const std::string stopped =
      end.is_stopped ? stopReason("on request after " + counted(frames, "scan")) : "";
  return stopped + (stopped.empty() || end.damage.empty() ? "" : "; ") + end.damage;
}

void requireComplete(const EarlyEnd& end,
                     const RunResults& results,
                     const SlamRunSettings& settings)
{
  std::string what = messageOf(end, results.report.frames, settings);
  appendFailures(results.failures, what);
  if (!results.failures.empty())
  {
    what += "; the other results are in " + settings.output_folder;
    if (!end.is_stopped && hasCheckpoint(settings.output_folder))
    {
      what += "; " + completeLaterAdvice(settings.output_folder);
    }
  }
  if (!what.empty())
  {
    throw UserError(what);
  }
}
}  // namespace dyslam
