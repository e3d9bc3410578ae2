// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/batch/Batch.h>

#include <string>
#include <vector>

namespace dyslam::batch
{
/** Number of recordings by result. */
struct Counts
{
  std::size_t done = 0;
  std::size_t unregistered = 0;
  std::size_t failed = 0;
  std::size_t open = 0;     //!< not run, or not to the end
  std::size_t skipped = 0;  //!< recordings with results that were done before
};

[[nodiscard]] Counts countsOf(const std::vector<BatchResult>& results);
/** Text such as "7 done (2 before), 1 failed". */
[[nodiscard]] std::string toText(const Counts& counts);

/** Writes `batch.json`, `index.html`, which links the reports, and, by dyslam-eval, `table.txt`,
 * `table.csv` and `table.json`, the errors of all runs.
 * \param evaluation path of dyslam-eval \returns the table as text, empty if no run has results.
 * \throws UserError, also if runs cannot be evaluated; the files have the others then. */
std::string summarise(const BatchSettings& settings,
                      const std::vector<BatchResult>& results,
                      const std::string& evaluation);

/** HTML of the page index.html. \param folder folder of the batch \param style content of the
 * <style> element */
[[nodiscard]] std::string indexPage(const std::vector<BatchResult>& results,
                                    const std::string& folder,
                                    const std::string& style);
}  // namespace dyslam::batch
