// SPDX-License-Identifier: BSD-3-Clause
#include "SimulatorPairSource.h"

#include <dyslam/base/Error.h>
#include <dyslam/train/DataText.h>
#ifdef DYSLAM_HAVE_SIM
#include <dyslam/sim/ClipGenerator.h>
#endif

#include <algorithm>

namespace dyslam
{
#ifdef DYSLAM_HAVE_SIM
namespace
{
/** Neighbouring pairs share a world, which saves generating it. */
constexpr std::uint64_t pairs_per_world = 16;
constexpr int most_gap = 3;  // scans; simulating a scan between costs as much as one of the pair

struct Scene
{
  double share = 0;
  sim::WorldKind world = sim::WorldKind::urban;
  sim::SensorKind sensor = sim::SensorKind::hdl64e;
  int columns = 0;  //!< firings per revolution; 0: default of the sensor
  double min_traffic = 0;
  double max_traffic = 0;
};

Scene parseScene(const std::string& text)
{
  const std::vector<std::string> words = splitFields(text, ';');
  try
  {
    if (words.size() == 6)
    {
      const Scene scene = {numberOf(words[0]),
                           sim::worldKindFromString(words[1]),
                           sim::sensorKindFromString(words[2]),
                           wholeNumberOf(words[3]),
                           numberOf(words[4]),
                           numberOf(words[5])};
      if (scene.share > 0 && scene.columns >= 0 && scene.min_traffic >= 0 &&
          scene.max_traffic >= scene.min_traffic)
      {
        return scene;
      }
    }
  }
  catch (const std::logic_error&)  // no number
  {
  }
  throw UserError("[data] simulator_worlds: '" + text +
                  "' is not share;world;sensor;columns;least traffic;most traffic, with a share "
                  "above 0 and 0 columns for the sensor's own");
}

/** Takes points from the lidar frame of `from` to the lidar frame of `to`. */
Pose motionBetween(const sim::SimulatedScan& from, const sim::SimulatedScan& to)
{
  const Pose& T_vehicle_lidar = from.scan.T_vehicle_lidar;
  return T_vehicle_lidar.inverse() * to.T_map_vehicle.inverse() * from.T_map_vehicle *
         T_vehicle_lidar;
}

std::vector<PointLabel> pointLabels(const sim::SimulatedScan& scan)
{
  std::vector<PointLabel> labels;
  labels.reserve(scan.moving.size());
  for (const std::uint8_t moving : scan.moving)
  {
    labels.push_back(moving != 0 ? PointLabel::moving : PointLabel::still);
  }
  return labels;
}

class SimulatorPairSource : public PairSource
{
 public:
  SimulatorPairSource(const std::vector<std::string>& worlds,
                      const AugmentationOptions& augmentation,
                      int max_gap,
                      const NumberRange& seeds,
                      std::uint64_t seed)
      : augmentation_(augmentation), max_gap_(std::min(max_gap, most_gap)), seed_(seed)
  {
    // Simulated scans have moving objects already.
    augmentation_.bodies = 0;
    for (std::size_t i = 0; i < worlds.size(); ++i)
    {
      const Scene scene = parseScene(worlds[i]);
      shares_.push_back(scene.share);
      sim::ClipOptions options;
      options.any_world = false;
      options.clips_per_world = static_cast<int>(pairs_per_world);
      options.min_traffic = scene.min_traffic;
      options.max_traffic = scene.max_traffic;
      options.simulator.world = scene.world;
      options.simulator.sensor = scene.sensor;
      options.simulator.columns = scene.columns;
      options.simulator.seed = static_cast<int>(1000003 * (seed % 1000) + 7777 + i);
      options.least_seed = static_cast<int>(seeds.first);
      options.most_seed = static_cast<int>(seeds.last);
      clips_.emplace_back(options);
    }
  }

  [[nodiscard]] std::string name() const override { return "simulator"; }

  [[nodiscard]] TrainingPair pair(std::uint64_t index) const override
  {
    RandomDraws draws(seed_ ^ 0x51ULL, index);
    const int gap = draws.chance(0.6)
                        ? 1
                        : 1 + static_cast<int>(draws.below(static_cast<std::size_t>(max_gap_)));
    const std::vector<sim::SimulatedScan> clip = clips_[scene(index)].clip(index, gap + 1);
    const bool backwards = draws.chance(0.3);
    const sim::SimulatedScan& scan1 = backwards ? clip.front() : clip.back();
    const sim::SimulatedScan& scan2 = backwards ? clip.back() : clip.front();
    TrainingPair pair;
    pair.points1 = scan1.deskewed;
    pair.points2 = scan2.deskewed;
    pair.labels1 = pointLabels(scan1);
    pair.T_2_1 = motionBetween(scan1, scan2);
    augment(augmentation_, {}, draws, pair);
    return pair;
  }

 private:
  [[nodiscard]] std::size_t scene(std::uint64_t index) const
  {
    RandomDraws draws(seed_ ^ 0x5CE7EULL, index / pairs_per_world);
    return draws.byWeight(shares_);
  }

  AugmentationOptions augmentation_;
  int max_gap_;
  std::uint64_t seed_;
  std::vector<double> shares_;
  std::vector<sim::ClipGenerator> clips_;
};
}  // namespace

std::unique_ptr<PairSource> makeSimulatorPairSource(const std::vector<std::string>& worlds,
                                                    const AugmentationOptions& augmentation,
                                                    int max_gap,
                                                    const NumberRange& seeds,
                                                    std::uint64_t seed)
{
  if (worlds.empty())
  {
    throw UserError("[data] simulator_worlds: names none; do, or set simulator_weight to 0");
  }
  return std::make_unique<SimulatorPairSource>(worlds, augmentation, max_gap, seeds, seed);
}

Recording simulateRecording(const std::string& text, const DataSplits& splits)
{
  const std::vector<std::string> words = splitFields(text, ';');
  sim::SimulatorOptions options;
  int scans = 0;
  try
  {
    if (words.size() == 5)
    {
      options.world = sim::worldKindFromString(words[0]);
      options.sensor = sim::sensorKindFromString(words[1]);
      options.traffic = numberOf(words[2]);
      options.seed = wholeNumberOf(words[3]);
      scans = wholeNumberOf(words[4]);
    }
  }
  catch (const std::logic_error&)
  {
    scans = 0;
  }
  if (scans < 2)
  {
    throw UserError("[data] simulated_validation: '" + text +
                    "' is not world;sensor;traffic;seed;scans, with 2 scans or more");
  }
  splits.requireSeed(options.seed, Split::validation, "[data] simulated_validation");
  sim::Simulator simulator(options);
  Recording recording;
  recording.name = words[0] + " " + words[1] + " traffic " + words[2];
  for (int i = 0; i < scans; ++i)
  {
    sim::SimulatedScan scan = simulator.next();
    recording.labels.push_back(pointLabels(scan));
    recording.T_world_scan.push_back(scan.T_map_vehicle * scan.scan.T_vehicle_lidar);
    recording.scans.push_back(std::move(scan.deskewed));
  }
  return recording;
}
#else
std::unique_ptr<PairSource> makeSimulatorPairSource(const std::vector<std::string>&,
                                                    const AugmentationOptions&,
                                                    int,
                                                    const NumberRange&,
                                                    std::uint64_t)
{
  throw UserError("[data] simulator_weight: this build has no simulator; set it to 0");
}

Recording simulateRecording(const std::string&, const DataSplits&)
{
  throw UserError("[data] simulated_validation: this build has no simulator; leave it empty");
}
#endif
}  // namespace dyslam
