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
  /** World, sensor and ranges. Seeds, traffic and start are drawn for each clip, and the speed if
   * it is 0; then also whether the ego on a campus is a robot or hand-held (without wheels). */
  SimulatorOptions simulator;
  bool any_world = true;     //!< draw the kind of world as well, urban most often, downtown never
  int scans = 2;             //!< consecutive scans in a clip
  int clips_per_world = 16;  //!< consecutive clips share a world, which saves time
  double min_traffic = 0;    //!< least traffic density drawn for a clip
  double max_traffic = 1;    //!< largest traffic density drawn for a clip
  int least_seed = 0;        //!< least seed drawn for a world
  int most_seed = (1 << 30) - 1;  //!< largest; of more than 2^30 seeds the first are drawn

  void describe(OptionsVisitor& visitor) override;
};

/** Labelled training data by index: clip(i) depends on the options and on i alone.
 *
 * Threads may draw clips at the same time. Indices in ascending order are fastest, because the last
 * world is cached.
 */
class ClipGenerator
{
 public:
  /** \param threads of a clip; 0 for the number of cores. \throws UserError for options out of
   * range. */
  explicit ClipGenerator(const ClipOptions& options, int threads = 1);

  /** `scans` consecutive scans with ground truth. */
  [[nodiscard]] std::vector<SimulatedScan> clip(std::uint64_t index) const;
  /** The first `scans` scans of clip `index`, independent of ClipOptions::scans. */
  [[nodiscard]] std::vector<SimulatedScan> clip(std::uint64_t index, int scans) const;
  /** The options of clip `index`. `seed` is the seed of the world, which consecutive clips share;
   * `traffic_seed` determines trajectory and traffic. */
  [[nodiscard]] SimulatorOptions clipOptions(std::uint64_t index) const;

 private:
  struct WorldCache;
  [[nodiscard]] std::shared_ptr<const World> worldOf(std::uint64_t index,
                                                     const SimulatorOptions& options) const;

  ClipOptions options_;
  int threads_;
  std::shared_ptr<WorldCache> cache_;  //!< shared with copies
};
}  // namespace dyslam::sim
