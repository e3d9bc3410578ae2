// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Options.h>

#include <cstddef>
#include <optional>
#include <string>

namespace dyslam
{
/** Part of a recording that is used: by the number of the scans and by the time since the first
 * scan of the recording. */
struct ScanRange
{
  int skip_first_n = 0;  //!< number of scans to skip
  int only_first_n = 0;  //!< number of scans to use after the skipped ones; 0: all
  double start = 0;      //!< time of the first scan to use [s]
  double end = 0;        //!< time from which scans are not used [s]; 0: no limit

  void describeRange(OptionsVisitor& visitor);
  /** Whether it leaves no scan out. */
  [[nodiscard]] bool isAll() const;
  /** The limits as flags: "--start 20 --only-first-n 5"; empty for all scans. */
  [[nodiscard]] std::string flags() const;
};

/** Applies a ScanRange to the scans of a recording, one after the other. */
class ScanSelection
{
 public:
  /** \param every_n every n-th scan after the skipped ones is used \throws UserError if the end is
   * not after the start. */
  explicit ScanSelection(const ScanRange& range, int every_n = 1);

  /** Whether a scan is used; only_first_n is left to the caller. Once the start is reached, scans
   * with earlier stamps are used, too: a clock may be set back.
   * \param index number of the scan in the recording, from 0 \param stamp stamp of the scan [s] */
  [[nodiscard]] bool takes(std::size_t index, double stamp);
  /** Whether no later scan is used. */
  [[nodiscard]] bool isPastEnd() const { return past_end_; }

  /** Fraction of the scans to use that were met, 0 to 1. To be called from the first one on.
   * \param read fraction of the recording that was read \param used number of scans used so far */
  [[nodiscard]] double progress(double read, std::size_t used);

  /** Why no scan was used, for an error: the limits, and what the recording has. \param scans their
   * number in the recording \param duration from the first to the last one [s] */
  [[nodiscard]] std::string reasonForNone(std::size_t scans, double duration) const;

 private:
  ScanRange range_;
  std::size_t every_n_;
  std::optional<double> first_stamp_;
  double time_ = 0;                    //!< of the last scan, since the first [s]
  std::optional<double> begin_;        //!< that of the first scan used [s]
  std::optional<double> passed_over_;  //!< fraction of the recording before the first scan used
  bool past_start_ = false;
  bool past_end_ = false;
};
}  // namespace dyslam
