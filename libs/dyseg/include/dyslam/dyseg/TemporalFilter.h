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
  double ground_clearance = 0.3;  //!< lower above the lowest nearby, points stay as they are [m]
  double decay = 0.8;             //!< of a cell's log-odds, per scan
  double share = 0.4;             //!< weight of a cell's past log-odds in a point's
  double max_log_odds = 4;        //!< of a cell, either way

  void describe(OptionsVisitor& visitor) override;
};

/** Accumulates the moving probabilities of the last scans, where in the world they lie.
 *
 * Each cell of a grid fixed in the odometry frame keeps log-odds of moving, decaying from scan to
 * scan: what was static there for some scans does not count as moving after one, and what creeps
 * through a cell for several counts sooner. Cells that have no history change nothing, so that a
 * mover on free ground is found at once. A stage of its own: it runs once the pose is known, behind
 * any segmenter.
 */
class TemporalFilter
{
 public:
  explicit TemporalFilter(const TemporalFilterOptions& options);

  /** Reads Frame::cloud and T_odom_vehicle; changes Frame::moving_probability. A frame without
   * probabilities stays as it is. */
  void apply(Frame& frame);
  void reset();
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
