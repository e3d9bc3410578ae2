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

/** Calls `use`; its errors get the setting, and the item of its list, in front. */
template <typename Use>
auto namingItem(const std::string& field, const std::string& item, const Use& use)
{
  try
  {
    return use();
  }
  catch (const UserError& error)
  {
    throw UserError(field + ": '" + item + "': " + error.what());
  }
}

/** \throws UserError. */
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
  throw UserError(
      "write share;world;sensor;columns;least traffic;most traffic, with a share above 0 and 0 "
      "columns for the sensor's own");
}

/** A drive of simulated_validation. */
struct ValidationDrive
{
  std::string name;
  sim::SimulatorOptions options;
  int scans = 0;
};

/** \throws UserError. */
ValidationDrive parseDrive(const std::string& text)
{
  const std::vector<std::string> words = splitFields(text, ';');
  try
  {
    if (words.size() == 5)
    {
      ValidationDrive drive;
      drive.name = words[0] + " " + words[1] + " traffic " + words[2];
      drive.options.world = sim::worldKindFromString(words[0]);
      drive.options.sensor = sim::sensorKindFromString(words[1]);
      drive.options.traffic = numberOf(words[2]);
      drive.options.seed = wholeNumberOf(words[3]);
      drive.scans = wholeNumberOf(words[4]);
      if (drive.scans >= 2)
      {
        return drive;
      }
    }
  }
  catch (const std::logic_error&)  // no number
  {
  }
  throw UserError("write world;sensor;traffic;seed;scans, with 2 scans or more");
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
    for (const std::string& world : worlds)
    {
      namingItem("[data] simulator_worlds", world, [&] { addScene(parseScene(world), seeds); });
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
  /** \throws UserError for numbers out of range. */
  void addScene(const Scene& scene, const NumberRange& seeds)
  {
    sim::ClipOptions options;
    options.any_world = false;
    options.clips_per_world = static_cast<int>(pairs_per_world);
    options.min_traffic = scene.min_traffic;
    options.max_traffic = scene.max_traffic;
    options.simulator.world = scene.world;
    options.simulator.sensor = scene.sensor;
    options.simulator.columns = scene.columns;
    options.simulator.seed = static_cast<int>(1000003 * (seed_ % 1000) + 7777 + clips_.size());
    options.least_seed = static_cast<int>(seeds.first);
    options.most_seed = static_cast<int>(seeds.last);
    clips_.emplace_back(options);
    shares_.push_back(scene.share);
  }

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
  const std::string field = "[data] simulated_validation";
  const ValidationDrive drive = namingItem(field, text, [&] { return parseDrive(text); });
  splits.requireSeed(drive.options.seed, Split::validation, field);
  sim::Simulator simulator = namingItem(field, text, [&] { return sim::Simulator(drive.options); });
  Recording recording;
  recording.name = drive.name;
  for (int i = 0; i < drive.scans; ++i)
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
