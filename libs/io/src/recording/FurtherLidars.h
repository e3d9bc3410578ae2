// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mrpt/obs/CObservation.h>

#include <cstddef>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "IntensityScaler.h"
#include "LabelPattern.h"
#include "MetScans.h"

namespace dyslam
{
/** Scans of further lidars that wait for the scan of the first lidar they are merged with. */
class FurtherLidars
{
 public:
  static constexpr std::size_t most_lidars = 16;  //!< largest number of lidars, with the first

  struct HeldScan
  {
    mrpt::obs::CObservation::Ptr observation;
    mrpt::obs::CObservation::Ptr time_ring;  //!< times and rings of its points; null: none
    std::size_t lidar = 1;                   //!< ScanPart::lidar, set by hold()
    double late_shift = 0;                   //!< of its stamp, as RecordedScan::late_shift [s]
    double stamp = 0;                        //!< of its frame [s]
  };

  /** \param labels regex; empty: there are none. \throws UserError if it is no regular expression.
   * \param merge whether scans are held \param intensity_scale as RawlogSourceOptions */
  FurtherLidars(const std::string& labels, bool merge, double intensity_scale);

  /** Whether the option selects a lidar. \param label label of another lidar than the first */
  [[nodiscard]] bool areNamed(const std::string& label) const;
  /** Whether scans are merged at all. */
  [[nodiscard]] bool areMerged() const { return merge_; }
  [[nodiscard]] const std::string& pattern() const { return labels_.pattern(); }
  /** Holds an observation that carries times and rings of the scan that follows.
   * \param label of that scan */
  void holdTimeRing(const std::string& label, const mrpt::obs::CObservation::Ptr& observation);
  /** The observation of holdTimeRing() for the next scan of a lidar, no longer held; null: none. */
  [[nodiscard]] mrpt::obs::CObservation::Ptr takeTimeRing(const std::string& label);
  /** Holds a scan with a time stamp. Those that wait for long without a scan of the first lidar
   * near them are dropped. \throws UserError for more than most_lidars. */
  void hold(HeldScan scan);
  /** The next scan of the first lidar with a good time stamp. Those nearer to one that is left out
   * than to any other are dropped. \param stamp of it [s] \param taken takeFor() follows for it */
  void metScan(double stamp, bool taken);
  /** Whether all lidars known so far have scans up to the middle between one of the first lidar
   * and that after it. \param stamp of it [s] */
  [[nodiscard]] bool areCompleteFor(double stamp) const;
  /** The scans that are nearest in time to one of the first lidar, by lidar and stamp, and late
   * ones that are nearer to one before; at most `farthest` from it. Others up to then are dropped.
   * \param stamp of it [s] */
  [[nodiscard]] std::vector<HeldScan> takeFor(double stamp);

  [[nodiscard]] IntensityScaler& intensityScaler(std::size_t lidar);
  /** Number of scans without a near scan of the first lidar so far. */
  [[nodiscard]] std::size_t dropped() const { return dropped_; }
  /** Reason why nothing is merged, for the user; empty if something was, or none selected. */
  [[nodiscard]] std::string reasonForNone() const;

 private:
  static constexpr double farthest = 0.15;       //!< largest time to the scan it is merged with [s]
  static constexpr double longest_wait = 1;      //!< dropped after a later scan of its lidar [s]
  static constexpr std::size_t most_held = 100;  //!< largest number of waiting scans of a lidar

  /** Whether a held scan may be merged with a known scan of the first lidar. */
  [[nodiscard]] bool isAwaited(const HeldScan& scan) const;
  void dropWaitingTooLong(const HeldScan& newest);

  LabelPattern labels_;
  bool merge_;
  double intensity_scale_;
  std::map<std::string, std::size_t> numbers_;  //!< numbers of the lidars by label
  std::map<std::size_t, double> latest_;        //!< stamp of the latest scan of each lidar [s]
  std::map<std::string, mrpt::obs::CObservation::Ptr> time_rings_;
  std::map<std::size_t, IntensityScaler> scalers_;
  std::deque<HeldScan> held_;
  MetScans first_;              //!< scans of the first lidar
  std::optional<double> last_;  //!< stamp of the last takeFor() [s]
  std::size_t dropped_ = 0;
  bool any_taken_ = false;
};
}  // namespace dyslam
