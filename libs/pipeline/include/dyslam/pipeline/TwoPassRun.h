// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/pipeline/RunSettings.h>
#include <dyslam/pipeline/SlamRun.h>

#include <functional>
#include <string>
#include <vector>

namespace dyslam
{
/** A run on a rawlog in one pass or two, as a user asks for it. */
struct RunRequest
{
  SlamRunSettings settings;              //!< but for those that are chosen: setSettings()
  std::string config;                    //!< as for readGivenSettings()
  std::vector<std::string> assignments;  //!< as for readGivenSettings()
  bool resume = false;                   //!< resume a run that was stopped or killed
  int passes = 1;                        //!< over the recording: 1 or 2
};

enum class Pass
{
  only,
  first,   //!< of two: labels the moving points
  second,  //!< of two: without these points
  resumed  //!< the rest of the only pass, or of the second one
};

/** Runs one pass. \param settings with config \param chosen how that was chosen; null for a run
 * that is resumed, whose settings are those of its checkpoint. */
using PassRunner = std::function<SlamRunReport(
    Pass pass, const SlamRunSettings& settings, const RunSettings* chosen)>;

struct PassesReport
{
  Pass pass = Pass::only;  //!< the last one; `first` if that has failed, so that no other followed
  SlamRunReport report;    //!< of it
  /** Those of the report that were not known before that pass. */
  std::vector<std::string> new_warnings;
};

/** Chooses the settings of each pass and runs it.
 *
 * The labels of the first of two passes are moved to `first_pass/labels` in the output folder, and
 * read by the second (`dyseg.labels`), whose warnings include those of the first. Warnings of the
 * first pass also go to `warn` of the settings at its end.
 * \throws UserError for bad settings, for an unfinished run in the output folder that is neither
 *   resumed nor replaced, if `stop` of the settings is true between the passes, and those of
 *   `run`. */
[[nodiscard]] PassesReport runInPasses(const RunRequest& request, const PassRunner& run);

/** \throws UserError if the folder has the checkpoint of a run that was stopped or killed, unless
 * it may be replaced (`force`). */
void requireNoUnfinishedRun(const SlamRunSettings& settings);
}  // namespace dyslam
