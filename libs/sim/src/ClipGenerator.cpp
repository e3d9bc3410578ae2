// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/sim/ClipGenerator.h>

#include <algorithm>
#include <mutex>

#include "Random.h"

namespace dyslam::sim
{
void ClipOptions::describe(OptionsVisitor& visitor)
{
  simulator.describe(visitor);
  visitor.flag("any_world", any_world,
               "draw the kind of world for each clip, most often urban, never downtown or indoor");
  visitor.integer("scans", scans, 1, 1000, "consecutive scans in a clip");
  visitor.integer("clips_per_world", clips_per_world, 1, 100000,
                  "consecutive clips that share a world");
  visitor.real("min_traffic", min_traffic, 0, 1, "lower bound of the traffic drawn for each clip");
  visitor.real("max_traffic", max_traffic, 0, 1, "upper bound of the traffic drawn for each clip");
  visitor.integer("least_seed", least_seed, 0, 2147483647, "lower bound of the worlds' seeds");
  visitor.integer("most_seed", most_seed, 0, 2147483647, "upper bound of the worlds' seeds");
}

/** The world used last. */
struct ClipGenerator::WorldCache
{
  std::mutex mutex;
  std::shared_ptr<const World> world;
  std::uint64_t number = 0;
};

ClipGenerator::ClipGenerator(const ClipOptions& options, int threads)
    : options_(options), threads_(threads), cache_(std::make_shared<WorldCache>())
{
  validate(options, "clips");
  if (options.max_traffic < options.min_traffic)
  {
    throw UserError("[clips] max_traffic: is below min_traffic");
  }
  if (options.most_seed < options.least_seed)
  {
    throw UserError("[clips] most_seed: is below least_seed");
  }
}

SimulatorOptions ClipGenerator::clipOptions(std::uint64_t index) const
{
  const std::uint64_t world_number = index / static_cast<std::uint64_t>(options_.clips_per_world);
  const std::uint64_t base = combine(static_cast<std::uint64_t>(options_.simulator.seed), 0xC11B);
  Rng world_rng(combine(base, world_number));
  Rng clip_rng(combine(combine(base, world_number), index + 1));
  SimulatorOptions o = options_.simulator;
  if (options_.any_world)
  {
    const double u = world_rng.uniform();
    o.world = u < 0.5    ? WorldKind::urban
              : u < 0.72 ? WorldKind::campus
              : u < 0.92 ? WorldKind::highway
              : u < 0.96 ? WorldKind::tunnel
                         : WorldKind::field;
    o.reverse = o.reverse && o.world != WorldKind::highway && o.world != WorldKind::tunnel;
  }
  // The seed determines the world; traffic, start and speed differ between clips.
  const std::int64_t seeds = std::int64_t{options_.most_seed} - options_.least_seed + 1;
  o.seed = static_cast<int>(options_.least_seed +
                            static_cast<std::int64_t>(world_rng.bits() >> 34) % seeds);
  o.traffic_seed = static_cast<int>(combine(static_cast<std::uint64_t>(o.seed), index) >> 34);
  o.traffic = clip_rng.uniform(options_.min_traffic, options_.max_traffic);
  o.start_fraction = clip_rng.uniform();
  o.start_time = std::min(o.start_time, 3.0) + clip_rng.uniform(0, 4);
  if (options_.simulator.ego_speed <= 0)
  {
    switch (o.world)
    {
      case WorldKind::urban:
        o.ego_speed = clip_rng.uniform(4, 15);
        break;
      case WorldKind::highway:
        o.ego_speed = clip_rng.uniform(15, 32);
        break;
      case WorldKind::tunnel:
        o.ego_speed = clip_rng.uniform(10, 25);
        break;
      case WorldKind::campus:
        o.ego = clip_rng.chance(0.3) ? EgoKind::handheld : EgoKind::robot;
        o.wheels = o.wheels && o.ego == EgoKind::robot;
        o.ego_speed = clip_rng.uniform(0.5, 3);
        break;
      case WorldKind::field:
        o.ego_speed = clip_rng.uniform(1, 8);
        break;
      case WorldKind::downtown:
        o.ego_speed = clip_rng.uniform(3, 13);
        break;
      case WorldKind::indoor:
        o.ego = clip_rng.chance(0.4) ? EgoKind::handheld : EgoKind::robot;
        o.wheels = o.wheels && o.ego == EgoKind::robot;
        o.ego_speed = clip_rng.uniform(0.5, 1.6);
        break;
    }
  }
  return o;
}

std::shared_ptr<const World> ClipGenerator::worldOf(std::uint64_t index,
                                                    const SimulatorOptions& options) const
{
  const std::uint64_t number = index / static_cast<std::uint64_t>(options_.clips_per_world);
  const std::lock_guard<std::mutex> lock(cache_->mutex);
  if (!cache_->world || cache_->number != number)
  {
    cache_->world = makeWorld(options);
    cache_->number = number;
  }
  return cache_->world;
}

std::vector<SimulatedScan> ClipGenerator::clip(std::uint64_t index) const
{
  return clip(index, options_.scans);
}

std::vector<SimulatedScan> ClipGenerator::clip(std::uint64_t index, int count) const
{
  const SimulatorOptions options = clipOptions(index);
  Simulator simulator(worldOf(index, options), options, threads_);
  std::vector<SimulatedScan> scans;
  for (int i = 0; i < count; ++i)
  {
    scans.push_back(simulator.next());
  }
  return scans;
}
}  // namespace dyslam::sim
