// SPDX-License-Identifier: BSD-3-Clause
#include "DysegPairs.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Printable.h>
#include <dyslam/base/Words.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/train/DataText.h>
#include <dyslam/train/ScanFiles.h>

#include <algorithm>
#include <stdexcept>

namespace dyslam
{
namespace
{
constexpr int clip_scans = 11;
constexpr std::size_t longest_gap = 10;  // largest distance of the scans of a pair [scans]
constexpr double period = 0.1;           // time per scan of pairs made from one scan [s]

/** Draws the firings per revolution: 0 (default of the sensor) for half of the clips, else fewer,
 * as in recordings. */
int drawColumns(sim::SensorKind sensor, RandomDraws& draws)
{
  constexpr int least = 400;
  constexpr int most = 1024;
  constexpr int of_few_beams = 900;
  if (draws.chance(0.5))
  {
    return 0;
  }
  return sensor == sim::SensorKind::vlp16
             ? of_few_beams
             : least + static_cast<int>(draws.below(std::size_t{most - least + 1}));
}

/** Draws the traffic density; on streets light traffic is most frequent, as on real ones. */
double drawTraffic(sim::WorldKind world, RandomDraws& draws)
{
  const double drawn = draws.uniform();
  switch (world)
  {
    case sim::WorldKind::urban:
      return 0.03 + 0.97 * drawn * drawn;
    case sim::WorldKind::highway:
      return 0.05 + 0.95 * drawn;
    case sim::WorldKind::downtown:
      return 0.2 + 0.8 * drawn;
    default:
      return 0.3 + 0.7 * drawn;
  }
}

/** The lidars of `other_sensors`. \throws UserError naming the key. */
std::vector<sim::SensorKind> otherSensors(const DysegTrainerOptions& options)
{
  std::vector<sim::SensorKind> sensors;
  for (const std::string& name : listItems(options.other_sensors, ','))
  {
    try
    {
      sensors.push_back(sim::sensorKindFromString(name));
    }
    catch (const UserError& error)
    {
      throw UserError(std::string("[train] other_sensors: ") + error.what());
    }
  }
  if (sensors.empty())
  {
    throw UserError(
        "[train] other_sensors: names no lidar; name one, or set other_sensors_share=0");
  }
  return sensors;
}

void drawEgo(RandomDraws& draws, DysegClipScene& scene)
{
  switch (scene.world)
  {
    case sim::WorldKind::urban:
      scene.ego_speed = draws.uniform(5, 15);
      break;
    case sim::WorldKind::highway:
      scene.ego_speed = draws.uniform(15, 32);
      break;
    case sim::WorldKind::downtown:
      scene.ego_speed = draws.uniform(3, 13);
      break;
    default:
      scene.ego = draws.chance(0.3) ? sim::EgoKind::handheld : sim::EgoKind::robot;
      scene.ego_speed = draws.uniform(1, scene.ego == sim::EgoKind::handheld ? 2 : 5);
      break;
  }
}
}  // namespace

DysegClipScene trainingScene(std::uint64_t number, const DysegTrainerOptions& options)
{
  DysegClipScene scene;
  RandomDraws draws(static_cast<std::uint64_t>(options.seed), number);
  scene.world = draws.chance(options.campus_share)    ? sim::WorldKind::campus
                : draws.chance(options.highway_share) ? sim::WorldKind::highway
                                                      : sim::WorldKind::urban;
  // Drawn only if wanted, so that recipes without it keep their scenes.
  if (options.downtown_share > 0 && scene.world == sim::WorldKind::urban &&
      draws.chance(options.downtown_share))
  {
    scene.world = sim::WorldKind::downtown;
  }
  scene.sensor =
      draws.chance(options.few_beams_share) ? sim::SensorKind::vlp16 : sim::SensorKind::hdl64e;
  scene.columns = drawColumns(scene.sensor, draws);
  scene.traffic = drawTraffic(scene.world, draws);
  drawEgo(draws, scene);
  // Drawn last and only if wanted, so that recipes without it keep their scenes.
  if (options.other_sensors_share > 0 && scene.sensor == sim::SensorKind::hdl64e &&
      draws.chance(options.other_sensors_share))
  {
    const auto others = otherSensors(options);
    scene.sensor = others.at(draws.below(others.size()));
  }
  return scene;
}

DysegPairs::DysegPairs(const DysegTrainerOptions& options) : options_(options)
{
  const DataSplits splits = DataSplits::load(options.splits, "[train] splits");
  if (options.simulated_share > 0)
  {
    seeds_ = splits.trainingSeeds();
  }
  if (options.other_sensors_share > 0)
  {
    (void)otherSensors(options);  // a wrong name is an error at once
  }
  if (!options.data.empty())
  {
    readRuns(splits);
    readSingles(splits);
  }
  else if (!options.labelled_runs.empty())
  {
    throw UserError(
        "[train] labelled_runs: [train] data is empty, so only simulated data are used; set data "
        "to the folder of the recordings, or leave labelled_runs empty");
  }
  if (options.simulated_share <= 0 && runs_.empty() && labelled_runs_.empty() && singles_.empty())
  {
    throw UserError(
        "[train]: no training data; set data and the runs or single scans in it, or "
        "simulated_share above 0");
  }
}

void DysegPairs::readRuns(const DataSplits& splits)
{
  if (!options_.boxed_run.empty())
  {
    const std::string folder = dataPath(options_.data, options_.boxed_run);
    splits.requireFrames(folder + "/velodyne", {0, options_.boxed_last}, Split::training,
                         "[train] boxed_run");
    runs_.push_back(
        loadBoxedRun(folder, 0, static_cast<std::size_t>(options_.boxed_last), options_.boxed));
  }
  const std::string field = "[train] labelled_runs";
  for (const std::string& item : listItems(options_.labelled_runs, '|'))
  {
    const RecordingDescription description = parseRecording(item, options_.data, field);
    const NumberRange frames{static_cast<std::int64_t>(description.first),
                             static_cast<std::int64_t>(description.last)};
    LabelledRun run(description, options_.labelled_period);
    splits.requireFrames(description.folder, frames, Split::training, field);
    labelled_runs_.push_back(std::move(run));
  }
}

void DysegPairs::readSingles(const DataSplits& splits)
{
  for (const auto& part : listItems(options_.single_scans, ','))
  {
    for (const auto& f : listBinFiles(dataPath(options_.data, part)))
    {
      splits.requireScan(f, Split::training, "[train] single_scans");
      singles_.push_back(readTrainingPoints(f, 0));
    }
  }
}

DysegClip DysegPairs::simulate(int number) const
{
  const auto n = static_cast<std::uint64_t>(number);
  const auto drawn = static_cast<std::uint64_t>(options_.seed) * 1000003 + n;
  const auto seeds = static_cast<std::uint64_t>(seeds_.last - seeds_.first + 1);
  const auto seed = static_cast<std::uint64_t>(seeds_.first) + drawn % seeds;
  return simulateClip(seed, clip_scans, n % 3 != 0, trainingScene(n, options_));
}

void DysegPairs::simulateAhead()
{
  const auto at_a_time = static_cast<std::size_t>(std::max(1, options_.threads / 4));
  while (coming_.size() < at_a_time)
  {
    const int number = next_clip_ + static_cast<int>(coming_.size());
    coming_.push_back(std::async(std::launch::async, [this, number] { return simulate(number); }));
  }
}

void DysegPairs::prepare(int step)
{
  if (options_.simulated_share <= 0)
  {
    return;
  }
  const int newest = step / options_.simulate_every;
  if (pool_.empty())
  {
    // A resumed training generates the clips of the pool again.
    next_clip_ = std::max(0, newest + 1 - options_.simulated_pool);
  }
  while (next_clip_ <= newest)
  {
    simulateAhead();
    pool_.push_back(coming_.front().get());
    coming_.pop_front();
    ++next_clip_;
  }
  simulateAhead();
  while (pool_.size() > static_cast<std::size_t>(options_.simulated_pool))
  {
    pool_.pop_front();
  }
}

namespace
{
/** A pair made from one scan, as if measured from two nearby positions. */
DysegSample seenTwice(const std::vector<Eigen::Vector3f>& scan, RandomDraws& draws)
{
  const double ahead = draws.chance(0.15) ? 0 : draws.uniform(-1.5, draws.chance(0.3) ? 7 : 2.5);
  const auto [y, z, yaw, pitch, roll] = draws.normals<5>({0.05, 0.02, 0.02, 0.003, 0.003});
  const Pose motion = poseFromYpr(ahead, y, z, yaw, pitch, roll);
  auto sample = doubleScan(scan, motion, draws);
  sample.elapsed = period * static_cast<double>(1 + draws.below(longest_gap));
  return sample;
}

struct DrawnFrames
{
  std::size_t current = 0;
  std::size_t past = 0;
};

/** Draws the scans of a pair out of `frames` consecutive ones. */
DrawnFrames drawFrames(std::size_t frames, const DysegTrainerOptions& options, RandomDraws& draws)
{
  const std::size_t longest = std::min(longest_gap, frames - 1);
  const std::size_t gap = draws.chance(options.gap_share)
                              ? std::min(static_cast<std::size_t>(options.gap), longest)
                              : 1 + draws.below(longest);
  const std::size_t later = gap + draws.below(frames - gap);
  return draws.chance(0.7) ? DrawnFrames{later, later - gap} : DrawnFrames{later - gap, later};
}

DysegSample pairOf(const DysegClip& clip, const DysegTrainerOptions& options, RandomDraws& draws)
{
  if (draws.chance(options.same_scan_share))
  {
    return seenTwice(clip.frames[draws.below(clip.frames.size())].points, draws);
  }
  const DrawnFrames drawn = drawFrames(clip.frames.size(), options, draws);
  return makeSample(clip, drawn.current, drawn.past);
}

DysegSample pairOf(const LabelledRun& run, const DysegTrainerOptions& options, RandomDraws& draws)
{
  if (draws.chance(options.same_scan_share))
  {
    return seenTwice(run.points(draws.below(run.size())), draws);
  }
  const DrawnFrames drawn = drawFrames(run.size(), options, draws);
  return run.sample(drawn.current, drawn.past);
}
}  // namespace

DysegSample DysegPairs::drawOfRuns(RandomDraws& draws) const
{
  if (labelled_runs_.empty())
  {
    return pairOf(runs_[draws.below(runs_.size())], options_, draws);
  }
  std::size_t scans = 0;
  for (const DysegClip& run : runs_)
  {
    scans += run.frames.size();
  }
  for (const LabelledRun& run : labelled_runs_)
  {
    scans += run.size();
  }
  std::size_t scan = draws.below(scans);
  for (const DysegClip& run : runs_)
  {
    if (scan < run.frames.size())
    {
      return pairOf(run, options_, draws);
    }
    scan -= run.frames.size();
  }
  auto run = labelled_runs_.begin();
  for (; scan >= run->size(); ++run)
  {
    scan -= run->size();
  }
  return pairOf(*run, options_, draws);
}

DysegSample DysegPairs::draw(RandomDraws& draws) const
{
  const bool runs = !runs_.empty() || !labelled_runs_.empty();
  const bool real = runs || !singles_.empty();
  if (!pool_.empty() && (!real || draws.chance(options_.simulated_share)))
  {
    return pairOf(pool_[draws.below(pool_.size())], options_, draws);
  }
  if (!singles_.empty() && (!runs || draws.chance(options_.single_share)))
  {
    return seenTwice(singles_[draws.below(singles_.size())], draws);
  }
  if (!runs)
  {
    throw std::logic_error("DysegPairs: prepare() makes the clips to draw from");
  }
  return drawOfRuns(draws);
}

std::string DysegPairs::summary() const
{
  std::size_t labelled_scans = 0;
  for (const LabelledRun& run : labelled_runs_)
  {
    labelled_scans += run.size();
  }
  std::string kinds = options_.simulated_share > 0 ? "simulated clips" : "";
  if (const std::size_t runs = runs_.size() + labelled_runs_.size(); runs > 0)
  {
    appendWord(kinds, counted(runs, "real run"));
  }
  if (labelled_scans > 0)
  {
    kinds += " (" + counted(labelled_scans, "scan") + " with point labels)";
  }
  if (!singles_.empty())
  {
    appendWord(kinds, counted(singles_.size(), "single scan"));
  }
  return kinds;
}
}  // namespace dyslam
