// SPDX-License-Identifier: BSD-3-Clause
#include "SimulatorPairSource.h"

#include <dyslam/core/Error.h>
#ifdef DYSLAM_HAVE_SIM
#include <dyslam/sim/ClipGenerator.h>
#endif

#include <algorithm>

namespace dyslam
{
#ifdef DYSLAM_HAVE_SIM
namespace
{
class SimulatorPairSource : public PairSource
{
 public:
  SimulatorPairSource(const AugmentationOptions& augmentation, int most_gap, std::uint64_t seed)
      : augmentation_(augmentation), seed_(seed), clips_(clipOptions(most_gap, seed))
  {
    // What the simulator shows needs no pasting.
    augmentation_.bodies = 0;
  }

  [[nodiscard]] std::string name() const override { return "simulator"; }

  [[nodiscard]] TrainingPair pair(std::uint64_t index) const override
  {
    RandomDraws draws(seed_ ^ 0x51ULL, index);
    const std::vector<sim::SimulatedScan> clip = clips_.clip(index);
    const std::size_t gap =
        draws.chance(0.6) ? 1 : 1 + draws.below(std::max<std::size_t>(clip.size() - 1, 1));
    std::size_t later = gap;
    std::size_t earlier = 0;
    if (draws.chance(0.3))
    {
      std::swap(later, earlier);
    }
    const sim::SimulatedScan& scan1 = clip[later];
    const sim::SimulatedScan& scan2 = clip[earlier];
    TrainingPair pair;
    pair.points1 = scan1.deskewed;
    pair.points2 = scan2.deskewed;
    pair.labels1.reserve(scan1.moving.size());
    for (const std::uint8_t moving : scan1.moving)
    {
      pair.labels1.push_back(moving != 0 ? PointLabel::moving : PointLabel::still);
    }
    const Pose T_vehicle_lidar = scan1.scan.T_vehicle_lidar;
    pair.T_2_1 = T_vehicle_lidar.inverse() * scan2.T_map_vehicle.inverse() * scan1.T_map_vehicle *
                 T_vehicle_lidar;
    augment(augmentation_, {}, draws, pair);
    return pair;
  }

 private:
  static sim::ClipOptions clipOptions(int most_gap, std::uint64_t seed)
  {
    sim::ClipOptions options;
    options.scans = std::min(most_gap, 3) + 1;
    options.simulator.seed = static_cast<int>(1000003 * (seed % 1000) + 7777);
    return options;
  }

  AugmentationOptions augmentation_;
  std::uint64_t seed_;
  sim::ClipGenerator clips_;
};
}  // namespace

std::unique_ptr<PairSource> makeSimulatorPairSource(const AugmentationOptions& augmentation,
                                                    int most_gap,
                                                    std::uint64_t seed)
{
  return std::make_unique<SimulatorPairSource>(augmentation, most_gap, seed);
}
#else
std::unique_ptr<PairSource> makeSimulatorPairSource(const AugmentationOptions&, int, std::uint64_t)
{
  throw UserError("[data] simulator_weight: this build has no simulator; set it to 0");
}
#endif
}  // namespace dyslam
