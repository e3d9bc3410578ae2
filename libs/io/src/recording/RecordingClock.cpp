// SPDX-License-Identifier: BSD-3-Clause
#include "RecordingClock.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Printable.h>

#include "RecordingNotes.h"

namespace dyslam
{
namespace
{
constexpr std::size_t max_dropped_in_a_row = 10;
constexpr std::size_t scans_after_step = 4;  //!< regular scans that show a clock set back
}  // namespace

RecordingClock::Verdict RecordingClock::accept(std::optional<double> stamp,
                                               std::size_t index,
                                               RecordingNotes& notes)
{
  Verdict verdict;
  if (stamp && last_ && *stamp + shift_ <= *last_)
  {
    if (const auto step = stepAt(*stamp + shift_))
    {
      verdict.shift = *step;
      shift_ += *step;
      const std::string text = formatted(
          "the clock of the recording was set back; stamps from there on are %.3f s "
          "later than recorded",
          shift_);
      notes.add(text, index);
      verdict.accepted = true;
    }
  }
  else
  {
    verdict.accepted = stamp.has_value();
  }
  if (verdict.accepted)
  {
    last_ = *stamp + shift_;
    first_ = first_ ? first_ : last_;
    dropped_in_a_row_ = 0;
    gone_back_.clear();
    return verdict;
  }
  ++dropped_;
  ++dropped_in_a_row_;
  notes.add(!stamp                      ? "a scan without a time stamp was dropped"
            : *stamp + shift_ == *last_ ? "a scan with the time stamp of the one before was dropped"
                                        : "a scan whose time stamp goes back was dropped",
            index);
  if (dropped_in_a_row_ > max_dropped_in_a_row)
  {
    throw UserError(recording_ + ": the time stamps stand still or run backwards from scan " +
                    std::to_string(index - max_dropped_in_a_row) +
                    " on; give the file proper times (rawlog-edit, or convert with --dt)");
  }
  return verdict;
}

std::optional<double> RecordingClock::stepAt(double stamp)
{
  if (!gone_back_.empty() && stamp <= gone_back_.back())
  {
    gone_back_.clear();
  }
  gone_back_.push_back(stamp);
  const std::size_t n = gone_back_.size();
  if (n < scans_after_step)
  {
    return std::nullopt;
  }
  const double period = (stamp - gone_back_.front()) / static_cast<double>(n - 1);
  return *last_ + static_cast<double>(n) * period - stamp;
}
}  // namespace dyslam
