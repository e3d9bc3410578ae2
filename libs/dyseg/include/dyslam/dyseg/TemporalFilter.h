// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/dyseg/MovingSegmenter.h>

#include <cstdint>
#include <unordered_map>

namespace dyslam
{
struct TemporalFilterOptions : Options
{
  double cell_size = 0.4;         //!< along each side of a cell [m]
  double ground_clearance = 0.3;  //!< points this little above the lowest nearby say nothing [m]
  double decay = 0.8;             //!< of what a cell knows, per scan
  double share = 0.4;             //!< of a point's log-odds that its cell's past makes up
  double most = 4;                //!< log-odds of a cell, either way

  void describe(OptionsVisitor& visitor) override;
};

/** Gathers the answers of another segmenter over the last scans, where in the world they lie.
 *
 * Each cell of a grid fixed in the odometry frame keeps log-odds of moving, fading from scan to
 * scan: what stood there for some scans is hardly believed to move in one, and what creeps through
 * a cell for several is believed sooner. Cells that nobody saw before change nothing, so that a
 * mover on free ground is found at once. Needs poses, and so runs behind the odometry: what the
 * other segmenter knows of the motion and of looks in a run's first scans is not handed on, for it
 * would be a scan old.
 */
class TemporalFilter : public MovingSegmenter
{
 public:
  TemporalFilter(const TemporalFilterOptions& options, std::unique_ptr<MovingSegmenter> inner);

  [[nodiscard]] std::string name() const override { return inner_->name() + " + filter"; }
  [[nodiscard]] bool needsPose() const override { return true; }
  void segment(Frame& frame) override;
  void reset() override;

  /** Only the filter, on a frame that has probabilities already. */
  void apply(Frame& frame);

 private:
  struct Cell
  {
    float log_odds = 0;
    std::uint64_t scan = 0;  //!< last one that saw it
  };

  [[nodiscard]] std::uint64_t keyOf(const Eigen::Vector3f& point) const;
  void forgetOld();

  TemporalFilterOptions options_;
  std::unique_ptr<MovingSegmenter> inner_;
  std::unordered_map<std::uint64_t, Cell> cells_;
  std::uint64_t scan_ = 0;
};
}  // namespace dyslam
