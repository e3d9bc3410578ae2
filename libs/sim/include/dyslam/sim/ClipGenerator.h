// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/sim/Simulator.h>

#include <cstdint>
#include <memory>
#include <vector>

namespace dyslam::sim
{
struct ClipOptions : Options
{
  SimulatorOptions
      simulator;          //!< world, sensor and ranges; seed, traffic and speed are drawn per clip
  bool any_world = true;  //!< draw the kind of world too (urban most often)
  int scans = 2;          //!< in one clip
  int clips_per_world = 16;  //!< neighbours in index share a world, which saves its making
  double min_traffic = 0;    //!< bounds of the traffic drawn for each clip
  double max_traffic = 1;

  void describe(OptionsVisitor& visitor) override;
};

/** Endless labelled training data by number: clip(i) depends on the options and i alone.
 *
 * Thread-safe through copies: give each worker its own generator. Asking for indices in order is
 * fastest, for the last world is kept.
 */
class ClipGenerator
{
 public:
  explicit ClipGenerator(const ClipOptions& options, int threads = 1);

  /** `scans` consecutive scans with truth. */
  [[nodiscard]] std::vector<SimulatedScan> clip(std::uint64_t index) const;
  /** The first `scans` scans of the same drive, fewer or more than the options say. */
  [[nodiscard]] std::vector<SimulatedScan> clip(std::uint64_t index, int scans) const;
  /** The options of clip `index`. Their seed is that of its world, which neighbours share; the
   * drive through it has a seed of its own. */
  [[nodiscard]] SimulatorOptions clipOptions(std::uint64_t index) const;

 private:
  ClipOptions options_;
  int threads_;
  mutable std::shared_ptr<const World> world_;
  mutable std::uint64_t world_number_ = 0;
};
}  // namespace dyslam::sim
