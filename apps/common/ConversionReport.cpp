// SPDX-License-Identifier: BSD-3-Clause
#include "ConversionReport.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Printable.h>
#include <dyslam/base/Words.h>
#include <dyslam/formats/ProgramLines.h>

#include <cstddef>
#include <cstdint>
#include <iostream>
#include <memory>
#include <string>

#include "Checks.h"
#include "Progress.h"
#include "StopSignals.h"

namespace dyslam
{
namespace
{
/** What was converted besides the scans: "12 poses (from poses.txt), 1 box"; empty without. */
std::string truthOf(const ConversionResult& result)
{
  std::string truth;
  if (result.poses > 0)
  {
    truth = counted(result.poses, "pose") +
            (result.pose_source.empty() ? "" : " (from " + result.pose_source + ")");
  }
  if (result.label_files > 0)
  {
    appendWord(truth, counted(result.label_files, "label file"));
  }
  if (result.boxes > 0)
  {
    appendWord(truth, std::to_string(result.boxes) + (result.boxes == 1 ? " box" : " boxes"));
  }
  return truth;
}
}  // namespace

void report(const ConversionResult& result, const std::string& output, bool are_true)
{
  for (const std::string& note : result.notes)
  {
    std::cerr << printable(note) << '\n';
  }
  for (const std::string& warning : result.warnings)
  {
    std::cerr << "warning: " << printable(warning) << '\n';
  }
  std::cout << output << ": " << counted(result.scans, "scan") << ", "
            << counted(result.points, "point");
  if (const std::string truth = truthOf(result); !truth.empty())
  {
    std::cout << "; ";
    if (are_true)
    {
      std::cout << "truth" << (result.ground_truth.empty() ? "" : " in " + result.ground_truth)
                << ": ";
    }
    std::cout << truth;
  }
  std::cout << '\n';
}

ConversionResult convertWithProgress(
    const std::string& program,
    const std::string& input,
    const std::string& output,
    bool quiet,
    const std::function<ConversionResult(const ConversionProgress&)>& convert)
{
  stopOnSignals();
  Progress progress(program, "scans", quiet);
  ConversionResult result = convert(
      [&progress, &input, &output](double fraction, std::size_t scans)
      {
        progress.update(fraction, scans);
        if (stop_asked)
        {
          const std::string when = "after " + counted(scans, "scan");
          throw UserError(
              stoppedMessage(input, stopReason(when) + "; " + output + " was not written"));
        }
      });
  progress.finish(result.scans);
  return result;
}

BagUnpackingProgress unpackWithProgress(const std::string& program,
                                        const std::string& input,
                                        bool quiet)
{
  return [program, input, quiet,
          progress = std::shared_ptr<Progress>()](const BagUnpacking& state) mutable
  {
    if (!progress)
    {
      stopOnSignals();
      if (!quiet)
      {
        std::cerr << program << ": " << printable(state.bag) << ": is unpacked to "
                  << printable(state.folder) << '\n';
      }
      progress =
          std::make_shared<Progress>(progressTitle(program, unpacking_part), "megabytes", quiet);
    }
    if (stop_asked)
    {
      throw UserError(stoppedMessage(input, stopReason("while it was unpacked")));
    }
    constexpr std::uint64_t megabyte = 1000000;
    const auto megabytes = static_cast<std::size_t>(state.bytes / megabyte);
    progress->update(state.fraction, megabytes);
    if (state.is_done)
    {
      progress->finish(megabytes);
      progress.reset();
    }
  };
}

void runConversion(const std::string& program,
                   const std::string& input,
                   const std::string& output,
                   bool force,
                   bool quiet,
                   const std::function<ConversionResult(const ConversionProgress&)>& convert)
{
  requireNewRecording(output, force);
  report(convertWithProgress(program, input, output, quiet, convert), output);
}
}  // namespace dyslam
