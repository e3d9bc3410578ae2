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

/** The scans before and after the labelled scan (the current one), some still earlier scans, and
 * the tracks of all of them. */
class ScanWindow
{
 public:
  /** \param scans number of scans that are kept before, and after, the current one \param history
   * number of scans before the window of which some are kept */
  ScanWindow(int scans, int history);

  /** Adds the next scan. \param kept parts of its frame that are kept for takeFrame() */
  void add(const Frame& frame, FrameParts kept);
  /** Whether there is a current scan. */
  [[nodiscard]] bool hasCurrent() const { return current_ < scans_.size(); }
  /** Whether all scans that are used after the current one have been added. */
  [[nodiscard]] bool isComplete() const { return scans_.size() - current_ > size_; }
  /** Moves the frame of the current scan out of the window; none if it was not kept. */
  [[nodiscard]] std::optional<Frame> takeFrame();
  /** The next scan becomes the current one; scans that are no longer used are dropped. */
  void advance();

  /** Number of the current scan, in the order of add(), from 0. */
  [[nodiscard]] std::size_t number() const { return added_ - (scans_.size() - current_); }
  /** The scans whose rays are evaluated for the current scan; earlier and later scans, each from
   * the nearest in time to the farthest. Valid until the window changes. */
  [[nodiscard]] std::vector<OtherScan> others() const;
  /** Lowest returns of the scans that show the ground for the current scan, itself included. Valid
   * until the window changes. */
  [[nodiscard]] std::vector<const LowestReturns*> lowestReturns() const;
  /** Whether a track is confirmed and dynamic at any time, before or after the current scan. */
  [[nodiscard]] bool isEverDynamic(int track) const { return dynamic_.contain(track); }
  /** Whether a track is reported at any time, before or after the current scan. */
  [[nodiscard]] bool isEverReported(int track) const { return reported_.contain(track); }

  void exchangeState(StateArchive& archive);

 private:
  /** One scan of the window. */
  struct WindowScan
  {
    WindowScan() = default;
    WindowScan(const Frame& given, FrameParts kept);

    std::optional<Frame> frame;  //!< none if it is not kept or was taken
    std::size_t index = 0;       //!< Frame::index
    Pose T_odom_vehicle = Pose::Identity();
    ScanVisibility rays;
    LowestReturns lowest;

    void exchangeState(StateArchive& archive);
  };

  /** One of the scans before the window. */
  struct EarlierScan
  {
    std::size_t number;  //!< number of the scan in the order of add(), from 0
    Pose T_odom_vehicle;
    ScanVisibility rays;
  };

  /** Tracks that once had a property, with the last Frame::index at which each was tracked. */
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
  std::size_t history_;       //!< number of scans before the window of which some are kept
  std::vector<int> offsets_;  //!< distances of the scans used, before and after the current one
  std::deque<WindowScan> scans_;
  std::deque<EarlierScan> earlier_;  //!< scans before the window that are used
  std::size_t current_ = 0;          //!< position of the current scan in `scans_`
  std::size_t added_ = 0;            //!< number of scans added so far
  LastingTracks dynamic_;            //!< tracks that have been dynamic
  LastingTracks reported_;           //!< tracks that have been reported
};
}  // namespace dyslam
