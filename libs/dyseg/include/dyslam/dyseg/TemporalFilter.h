// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>
#include <dyslam/core/Options.h>

#include <cstdint>
#include <unordered_map>

namespace dyslam
{
class StateArchive;

struct TemporalFilterOptions : Options
{
  double cell_size = 0.4;         //!< side of a cell [m]
  double ground_clearance = 0.3;  //!< points lower above the lowest nearby are unchanged [m]
  double decay = 0.8;             //!< factor on a cell's log-odds per scan
  double share = 0.4;             //!< weight of a cell's past log-odds in those of its points
  double max_log_odds = 4;        //!< limit of a cell's log-odds, positive and negative

  void describe(OptionsVisitor& visitor) override;
};

/** Accumulates the moving probabilities of the last scans in the odometry frame.
 *
 * Each cell of a grid fixed in the odometry frame keeps log-odds of moving, decaying from scan to
 * scan: a cell that was static for some scans does not become moving after one, and an object that
 * moves slowly through a cell is detected sooner. Cells without history change nothing, so that an
 * object that moves on free ground is detected at once. A separate stage: it runs once the pose is
 * known, after any segmenter.
 */
class TemporalFilter
{
 public:
  explicit TemporalFilter(const TemporalFilterOptions& options);

  /** Reads Frame::cloud and T_odom_vehicle; changes Frame::moving_probability. A frame without
   * probabilities stays as it is. */
  void apply(Frame& frame);
  /** What is kept from frame to frame. */
  void exchangeState(StateArchive& archive);

 private:
  struct Cell
  {
    float log_odds = 0;
    std::uint64_t scan = 0;  //!< last one that saw it
  };

  [[nodiscard]] std::uint64_t keyOf(const Eigen::Vector3f& point) const;
  void forgetOld();

  TemporalFilterOptions options_;
  std::unordered_map<std::uint64_t, Cell> cells_;
  std::uint64_t scan_ = 0;
};
}  // namespace dyslam
