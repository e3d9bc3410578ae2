// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Options.h>

#include <cstddef>
#include <optional>

namespace dyslam
{
/** Part of a recording that is used: by the number of the scans, and by their time since the first
 * scan of the recording. */
struct ScanRange
{
  int skip_first_n = 0;  //!< scans to skip
  int only_first_n = 0;  //!< scans to use after those; 0: all
  double start = 0;      //!< earlier scans are skipped [s]
  double end = 0;        //!< scans from here on are left out [s]; 0: none

  void describeRange(OptionsVisitor& visitor);
};

/** Applies a ScanRange to the scans of a recording, one after the other. */
class ScanSelection
{
 public:
  /** \param every_n of the scans behind those skipped, every n-th is used. \throws UserError if the
   * end is not after the start. */
  explicit ScanSelection(const ScanRange& range, int every_n = 1);

  /** Whether a scan is used; only_first_n is left to the caller.
   * \param index among the scans of the recording, from 0 \param stamp not before that of the last
   * call [s] */
  [[nodiscard]] bool takes(std::size_t index, double stamp);
  /** No later scan is used. */
  [[nodiscard]] bool isPastEnd() const { return past_end_; }

 private:
  ScanRange range_;
  std::size_t every_n_;
  std::optional<double> first_stamp_;
  bool past_end_ = false;
};
}  // namespace dyslam
