// SPDX-License-Identifier: BSD-3-Clause
#include "DysegValidation.h"

#include <dyslam/core/Error.h>
#include <dyslam/train/DataSplits.h>

#include <filesystem>

namespace dyslam
{
namespace
{
namespace fs = std::filesystem;

constexpr std::size_t far_back = 8;  // scans, of the slower comparison

/** Some frames of a run, and the keys of [train] they come from. */
struct Stretch
{
  std::string folder;
  std::string key;
  int first = 0;
  int last = 0;
};

void requireDisjoint(const Stretch& evaluated, const Stretch& trained, const std::string& data)
{
  std::error_code missing;  // reported where it is read
  if (!evaluated.folder.empty() && !trained.folder.empty() && evaluated.first <= trained.last &&
      fs::equivalent(fs::path(data) / evaluated.folder, fs::path(data) / trained.folder, missing))
  {
    throw UserError("[train] " + evaluated.key + "_first = " + std::to_string(evaluated.first) +
                    ": frames of " + evaluated.folder + " up to " + trained.key +
                    "_last = " + std::to_string(trained.last) +
                    " are trained on; begin behind them, or train on fewer");
  }
}

void requireExisting(const Stretch& evaluated, const std::string& data)
{
  if (!evaluated.folder.empty() && !fs::is_directory(data + "/" + evaluated.folder))
  {
    throw UserError("[train] " + evaluated.key + " = " + evaluated.folder + ": no such folder in " +
                    data + "; name another, or leave it empty");
  }
}

void requireSplit(const Stretch& evaluated, const std::string& data, const DataSplits& splits)
{
  if (!evaluated.folder.empty())
  {
    splits.requireFrames(data + "/" + evaluated.folder + "/velodyne",
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
}  // namespace

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
  std::vector<DysegValidationSet> sets(2);
  sets[0].name = "simulated";
  sets[1].name = "simulated 8 scans back";
  for (std::uint64_t i = 0; i < 8; ++i)
  {
    splits.requireSeed(static_cast<std::int64_t>(unseen_seeds + i), Split::validation,
                       "validation on simulated clips");
    const auto clip = simulateClip(unseen_seeds + i, far_back + 1, true);
    sets[0].samples.push_back(makeSample(clip, far_back, far_back - 1));
    sets[1].samples.push_back(makeSample(clip, far_back, 0));
  }
  if (options.data.empty())
  {
    return sets;
  }
  if (!boxed.folder.empty())
  {
    const auto run = loadBoxedRun(options.data + "/" + boxed.folder,
                                  static_cast<std::size_t>(boxed.first) - far_back,
                                  static_cast<std::size_t>(boxed.last));
    DysegValidationSet near{nameOf(boxed), {}};
    DysegValidationSet slow{nameOf(boxed) + " 8 scans back", {}};
    for (std::size_t i = far_back; i < run.frames.size(); i += 2)
    {
      near.samples.push_back(makeSample(run, i, i - 1));
      slow.samples.push_back(makeSample(run, i, i - far_back));
    }
    sets.push_back(std::move(near));
    sets.push_back(std::move(slow));
  }
  if (!labelled.folder.empty())
  {
    const auto folder = options.data + "/" + labelled.folder;
    const auto run = loadLabelledRun(folder, folder + "/" + options.labelled_poses,
                                     static_cast<std::size_t>(labelled.first) - 1,
                                     static_cast<std::size_t>(labelled.last));
    DysegValidationSet set{nameOf(labelled), {}};
    for (std::size_t i = 1; i < run.frames.size(); i += 3)
    {
      set.samples.push_back(makeSample(run, i, i - 1));
    }
    sets.push_back(std::move(set));
  }
  return sets;
}
}  // namespace dyslam
