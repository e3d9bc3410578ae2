// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/FrameCopy.h>

#include <cstddef>
#include <deque>
#include <map>
#include <optional>
#include <vector>

#include "GroundHeights.h"
#include "RayHistory.h"
#include "ScanVisibility.h"

namespace dyslam
{
class StateArchive;

/** The scans before and after the one that is decided (the current one), some of those before
 * these, and the tracks of all of them. */
class ScanWindow
{
 public:
  /** \param scans number of scans that are kept before, and after, the current one \param history
   * number of scans before these of which some are kept */
  ScanWindow(int scans, int history);

  /** Adds the next scan. \param kept of its frame, for takeFrame() */
  void add(const Frame& frame, FrameParts kept);
  /** Whether there is a current scan. */
  [[nodiscard]] bool hasCurrent() const { return current_ < scans_.size(); }
  /** Whether all scans that are used after the current one have been added. */
  [[nodiscard]] bool isComplete() const { return scans_.size() - current_ > size_; }
  /** The frame of the current scan, which is then kept no longer; none if it never was. */
  [[nodiscard]] std::optional<Frame> takeFrame();
  /** The next scan becomes the current one; those that are no longer used are dropped. */
  void advance();

  /** Number of the current scan, as they were added. */
  [[nodiscard]] std::size_t number() const { return added_ - (scans_.size() - current_); }
  /** The scans whose rays are evaluated for the current one: those before and those after it each
   * in order of their distance. Valid until the window changes. */
  [[nodiscard]] std::vector<OtherScan> others() const;
  /** Those that show the ground for the current one, which is one of them. Valid until the window
   * changes. */
  [[nodiscard]] std::vector<const LowestReturns*> lowestReturns() const;
  /** Whether a track is confirmed and dynamic at one time, before or after the current scan. */
  [[nodiscard]] bool isEverDynamic(int track) const { return dynamic_.contain(track); }
  /** Whether a track is reported at one time, before or after the current scan. */
  [[nodiscard]] bool isEverReported(int track) const { return reported_.contain(track); }

  void exchangeState(StateArchive& archive);

 private:
  /** One scan of the window. */
  struct WindowScan
  {
    WindowScan() = default;
    WindowScan(const Frame& given, FrameParts kept);

    std::optional<Frame> frame;  //!< none if it is not kept, and once it was taken
    std::size_t index = 0;       //!< Frame::index
    Pose T_odom_vehicle = Pose::Identity();
    ScanVisibility rays;
    LowestReturns lowest;

    void exchangeState(StateArchive& archive);
  };

  /** One of the scans before the window. */
  struct EarlierScan
  {
    std::size_t number;  //!< as they were added
    Pose T_odom_vehicle;
    ScanVisibility rays;
  };

  /** Tracks with a property that they keep: to the last Frame::index at which each was there. */
  class LastingTracks
  {
   public:
    void note(int track, bool has_property, std::size_t index);
    [[nodiscard]] bool contain(int track) const { return last_.count(track) != 0; }
    void forgetBefore(std::size_t index);
    void exchangeState(StateArchive& archive);

   private:
    std::map<int, std::size_t> last_;
  };

  void dropOldest();

  std::size_t size_;          //!< number of scans before, and after, the current one
  std::size_t history_;       //!< number of scans before these of which some are kept
  std::vector<int> offsets_;  //!< to the scans of the window that are used, before and after
  std::deque<WindowScan> scans_;
  std::deque<EarlierScan> earlier_;  //!< scans before the window that are used
  std::size_t current_ = 0;          //!< position of the current scan in `scans_`
  std::size_t added_ = 0;            //!< number of all scans added
  LastingTracks dynamic_;            //!< tracks that have been dynamic
  LastingTracks reported_;           //!< tracks that have been reported
};
}  // namespace dyslam
