// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace dyslam
{
class RecordingNotes;

/** Time stamps of the scans of a recording: those that are used are each later than the one before.
 * Others are dropped, until they show that the clock was set back, which is compensated. */
class RecordingClock
{
 public:
  struct Verdict
  {
    bool accepted = false;
    double shift = 0;  //!< by which the clock was found set back at this scan; 0: it was not [s]
  };

  /** \param recording name of the recording, for messages */
  explicit RecordingClock(std::string recording) : recording_(std::move(recording)) {}

  /** Whether the next scan is used. \param stamp as recorded; none if it has no time [s]
   * \throws UserError if the stamps never go on. */
  [[nodiscard]] Verdict accept(std::optional<double> stamp,
                               std::size_t index,
                               RecordingNotes& notes);

  /** From the recording's stamps to the frames' [s]. */
  [[nodiscard]] double shift() const { return shift_; }
  /** Stamps of the first and last used scan, shifted [s]. */
  [[nodiscard]] const std::optional<double>& first() const { return first_; }
  [[nodiscard]] const std::optional<double>& last() const { return last_; }
  /** Number of scans that were not used. */
  [[nodiscard]] std::size_t dropped() const { return dropped_; }

 private:
  /** A scan that is not later than the last one used. \param stamp shifted [s] \return by how much
   * it and those dropped before it show that the clock was set back; nothing if they do not [s] */
  [[nodiscard]] std::optional<double> stepAt(double stamp);

  std::string recording_;
  std::optional<double> first_;
  std::optional<double> last_;
  double shift_ = 0;
  std::vector<double> gone_back_;  //!< stamps of scans dropped in a row, ascending
  std::size_t dropped_ = 0;
  std::size_t dropped_in_a_row_ = 0;
};
}  // namespace dyslam
