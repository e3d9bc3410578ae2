// SPDX-License-Identifier: BSD-3-Clause
#include "DysegValidation.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Printable.h>
#include <dyslam/train/DataSplits.h>
#include <dyslam/train/DataText.h>
#include <dyslam/train/LabelledRun.h>

#include <filesystem>
#include <optional>

namespace dyslam
{
namespace
{
namespace fs = std::filesystem;

constexpr std::size_t far_back = 8;  // distance of the scans of the second comparison [scans]
constexpr const char* far_name = " 8 scans back";

/** A range of frames of a run, and the key of [train] that names it. */
struct Stretch
{
  std::string folder;
  std::string key;
  int first = 0;
  int last = 0;
};

void requireDisjoint(const Stretch& evaluated, const Stretch& trained, const std::string& data)
{
  std::error_code missing;  // a missing folder is reported where it is read
  if (!evaluated.folder.empty() && !trained.folder.empty() && evaluated.first <= trained.last &&
      fs::equivalent(dataPath(data, evaluated.folder), dataPath(data, trained.folder), missing))
  {
    throw UserError("[train] " + evaluated.key + "_first = " + std::to_string(evaluated.first) +
                    ": frames of " + evaluated.folder + " up to " + trained.key +
                    "_last = " + std::to_string(trained.last) +
                    " are trained on; begin behind them, or train on fewer");
  }
}

void requireExisting(const Stretch& evaluated, const std::string& data)
{
  if (!evaluated.folder.empty() && !fs::is_directory(dataPath(data, evaluated.folder)))
  {
    throw UserError("[train] " + evaluated.key + " = " + evaluated.folder + ": no such folder in " +
                    data + "; name another, or leave it empty");
  }
}

void requireSplit(const Stretch& evaluated, const std::string& data, const DataSplits& splits)
{
  if (!evaluated.folder.empty())
  {
    splits.requireFrames(dataPath(data, evaluated.folder) + "/velodyne",
                         {evaluated.first, evaluated.last}, Split::validation,
                         "[train] " + evaluated.key);
  }
}

std::string nameOf(const Stretch& evaluated)
{
  return evaluated.folder + " " + std::to_string(evaluated.first) + "-" +
         std::to_string(evaluated.last);
}

Stretch boxedOf(const DysegTrainerOptions& o)
{
  return {o.boxed_validation, "boxed_validation", o.boxed_validation_first,
          o.boxed_validation_last};
}

Stretch labelledOf(const DysegTrainerOptions& o)
{
  return {o.labelled_validation, "labelled_validation", o.labelled_validation_first,
          o.labelled_validation_last};
}

/** The frames of labelled_validation and the one before them. */
RecordingDescription labelledDescription(const DysegTrainerOptions& o)
{
  const std::string folder = dataPath(o.data, o.labelled_validation);
  RecordingDescription description;
  description.folder = folder + "/velodyne";
  description.pose_file = folder + "/" + o.labelled_poses;
  description.calib_file = o.labelled_calib.empty() ? "" : folder + "/" + o.labelled_calib;
  description.deskew = o.labelled_deskew;
  description.first = static_cast<std::size_t>(o.labelled_validation_first) - 1;
  description.last = static_cast<std::size_t>(o.labelled_validation_last);
  return description;
}

/** Scenes of a row of the validation table: several simulated clips. */
struct SimulatedRow
{
  const char* name;
  sim::WorldKind world;
  sim::SensorKind sensor;
  int columns;               //!< firings per revolution; 0: default of the sensor
  std::uint64_t first_seed;  //!< seed of the first clip minus `unseen_seeds`
  bool near;                 //!< compared with the previous scan, too
};

// The first two rows have the same streets and differ only in the firings per revolution.
constexpr SimulatedRow simulated_rows[] = {
    {"simulated street", sim::WorldKind::urban, sim::SensorKind::hdl64e, 0, 0, true},
    {"simulated street 512 columns", sim::WorldKind::urban, sim::SensorKind::hdl64e, 512, 0, false},
    {"simulated highway 1024 columns", sim::WorldKind::highway, sim::SensorKind::hdl64e, 1024, 4,
     false},
    {"simulated campus VLP-16", sim::WorldKind::campus, sim::SensorKind::vlp16, 0, 8, false}};
constexpr double simulated_traffic[] = {0.2, 0.3, 0.4,
                                        0.5};  // traffic density of each clip of a row

/** The pair without returns below a range. */
DysegSample withoutNearReturns(DysegSample sample, double min_range)
{
  for (std::vector<Eigen::Vector3f>* points : {&sample.current, &sample.past})
  {
    for (Eigen::Vector3f& p : *points)
    {
      if (p.norm() < static_cast<float>(min_range))
      {
        p.setZero();  // no return
      }
    }
  }
  return sample;
}

std::vector<DysegValidationSet> simulatedSets(const DataSplits& splits)
{
  std::vector<DysegValidationSet> sets;
  for (const SimulatedRow& row : simulated_rows)
  {
    DysegValidationSet near{row.name, false, {}};
    DysegValidationSet far{std::string(row.name) + far_name, true, {}};
    std::uint64_t seed = unseen_seeds + row.first_seed;
    for (const double traffic : simulated_traffic)
    {
      splits.requireSeed(static_cast<std::int64_t>(seed), Split::validation,
                         "validation on simulated clips");
      DysegClipScene scene;
      scene.world = row.world;
      scene.sensor = row.sensor;
      scene.traffic = traffic;
      scene.columns = row.columns;
      const auto clip = simulateClip(seed++, far_back + 1, true, scene);
      if (row.near)
      {
        near.samples.push_back(makeSample(clip, far_back, far_back - 1));
      }
      far.samples.push_back(makeSample(clip, far_back, 0));
    }
    if (row.near)
    {
      sets.push_back(std::move(near));
    }
    sets.push_back(std::move(far));
  }
  return sets;
}
}  // namespace

std::string scoreFields(const DysegScores& s)
{
  const auto mean = [](double sum, std::uint64_t count)
  { return count > 0 ? std::optional(sum / static_cast<double>(count)) : std::nullopt; };
  std::string fields;
  const auto add = [&fields](std::optional<double> value, int digits)
  { fields += value ? formatted(",%.*f", digits, *value) : ","; };
  add(s.iou(), 4);
  add(s.precision(), 4);
  add(s.recall(), 4);
  add(mean(s.static_error, s.static_cells), 4);
  add(mean(s.moving_error, s.moving_cells), 4);
  add(mean(s.translation_error, s.pairs), 4);
  add(mean(s.yaw_error, s.pairs), 5);
  return fields;
}

void checkDysegValidation(const DysegTrainerOptions& options)
{
  if (options.data.empty())
  {
    return;
  }
  for (const Stretch& evaluated : {boxedOf(options), labelledOf(options)})
  {
    if (!evaluated.folder.empty() && evaluated.first > evaluated.last)
    {
      throw UserError("[train] " + evaluated.key + "_first = " + std::to_string(evaluated.first) +
                      " is behind " + evaluated.key + "_last = " + std::to_string(evaluated.last) +
                      "; exchange them, or leave " + evaluated.key + " empty");
    }
    requireDisjoint(evaluated, {options.boxed_run, "boxed", 0, options.boxed_last}, options.data);
  }
}

std::vector<DysegValidationSet> makeDysegValidation(const DysegTrainerOptions& options)
{
  const Stretch boxed = boxedOf(options);
  const Stretch labelled = labelledOf(options);
  const DataSplits splits = DataSplits::load(options.splits, "[train] splits");
  if (!options.data.empty())
  {
    for (const Stretch& evaluated : {boxed, labelled})
    {
      requireExisting(evaluated, options.data);
      requireSplit(evaluated, options.data, splits);
    }
  }
  const double min_range = options.validation_min_range;
  std::vector<DysegValidationSet> sets = simulatedSets(splits);
  if (options.data.empty())
  {
    return sets;
  }
  if (!boxed.folder.empty())
  {
    const auto run = loadBoxedRun(dataPath(options.data, boxed.folder),
                                  static_cast<std::size_t>(boxed.first) - far_back,
                                  static_cast<std::size_t>(boxed.last), options.boxed);
    DysegValidationSet near{nameOf(boxed), false, {}};
    DysegValidationSet slow{nameOf(boxed) + far_name, true, {}};
    for (std::size_t i = far_back; i < run.frames.size(); i += 2)
    {
      near.samples.push_back(withoutNearReturns(makeSample(run, i, i - 1), min_range));
      slow.samples.push_back(withoutNearReturns(makeSample(run, i, i - far_back), min_range));
    }
    sets.push_back(std::move(near));
    sets.push_back(std::move(slow));
  }
  if (!labelled.folder.empty())
  {
    const LabelledRun run(labelledDescription(options), options.labelled_period);
    DysegValidationSet set{nameOf(labelled), false, {}};
    for (std::size_t i = 1; i < run.size(); i += 3)
    {
      set.samples.push_back(withoutNearReturns(run.sample(i, i - 1), min_range));
    }
    sets.push_back(std::move(set));
  }
  return sets;
}
}  // namespace dyslam
