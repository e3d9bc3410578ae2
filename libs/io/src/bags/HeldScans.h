// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Scan.h>

#include <cstddef>
#include <deque>
#include <map>
#include <optional>

#include "BagMotion.h"
#include "conversion/ScanSink.h"

namespace dyslam
{
/** Scans of a bag on their way to the sink. Each waits until samples of the other sensors that are
 * as new have been received, so that those up to its stamp stand before it. Scans that are out of
 * order, as of a driver with several threads, are sorted by their stamps: each waits for the next
 * ones of its lidar. */
class HeldScans
{
 public:
  static constexpr std::size_t most = 20;    //!< largest number of waiting scans of a lidar
  static constexpr double longest_wait = 1;  //!< longest wait, by the recording times [s]

  static constexpr std::size_t look_ahead = 3;  //!< scans of its lidar that a scan waits for
  static constexpr double longest_back = 1;  //!< the stamps of others go back, as a clock does [s]

  struct Entry
  {
    Scan scan;
    std::size_t lidar = 0;  //!< from 1: a further lidar, with label and T_vehicle_lidar
    std::optional<Pose> T_world_lidar;
    double recorded = 0;  //!< recording time, UNIX time [s]
    double progress = 0;  //!< fraction of the bag that was read
  };

  /** \param is_live scans wait for no later ones, and stay in the order in which they came */
  HeldScans(ScanSink& sink, const BagMotion& motion, bool is_live)
      : sink_(sink), motion_(motion), look_ahead_(is_live ? 0 : look_ahead)
  {
  }

  void hold(Entry entry);
  /** Passes on the scans that need not wait any longer.
   * \param recorded time of the latest message [s]
   * \return false once the sink takes no more. \throws UserError if the disk is full. */
  bool passOn(double recorded);
  /** Passes on all that the sink takes. \throws UserError if the disk is full. */
  void passOnAll();

  /** Number of scans that came after one with a later stamp, and were put before it. */
  [[nodiscard]] std::size_t sorted() const { return sorted_; }
  /** Number of scans written without a true pose. */
  [[nodiscard]] std::size_t withoutPose() const { return without_pose_; }

 private:
  [[nodiscard]] bool mustWait(const Entry& entry, double recorded) const;
  void passOnFirst();

  ScanSink& sink_;
  const BagMotion& motion_;
  std::size_t look_ahead_;
  std::deque<Entry> waiting_;
  std::map<std::size_t, std::size_t> waiting_of_;  //!< number of waiting scans by lidar
  bool takes_more_ = true;
  std::size_t sorted_ = 0;
  std::size_t without_pose_ = 0;
};
}  // namespace dyslam
