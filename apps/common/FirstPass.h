// SPDX-License-Identifier: BSD-3-Clause
// The first of two passes over a recording: its arguments, and where its labels stay for the
// second one.
#pragma once

#include <dyslam/core/Error.h>
#include <dyslam/core/Files.h>

#include <filesystem>
#include <string>
#include <vector>

#include "SlamArguments.h"

namespace dyslam
{
/** Arguments of a pass that writes labels only. */
inline SlamArguments firstPassArguments(const SlamArguments& a)
{
  SlamArguments first;
  first.settings = a.settings;
  first.settings.labels = true;
  first.settings.probabilities = false;
  first.settings.static_scans = false;
  first.settings.profile_csv.clear();
  first.config = a.config;
  first.assignments = assignmentsOf(a);
  first.verbosity = a.verbosity;
  for (const char* unused :
       {"pipeline.mapping", "pipeline.hindsight_tracking", "output.replay", "output.simplemap",
        "output.pcd", "output.ply", "output.scene", "output.plot", "output.page"})
  {
    first.assignments.push_back(std::string(unused) + "=false");
  }
  first.assignments.emplace_back("output.checkpoint_seconds=0");
  return first;
}

/** Removes the label files in a folder, and nothing else. */
inline void removeLabels(const std::filesystem::path& folder)
{
  for (const auto& entry : entriesOf(folder))
  {
    if (entry.path().extension() == ".label")
    {
      std::filesystem::remove(entry.path());
    }
  }
}

inline std::filesystem::path labelsOfFirstPass(const std::string& output)
{
  return std::filesystem::path(output) / "first_pass" / "labels";
}

/** The labels that a run with these settings reads; empty for none. */
inline std::string labelsIn(const Config& config)
{
  return config.has("dyseg", "labels") ? config.section("dyseg").at("labels").text : "";
}

/** Whether a run with these settings into that folder is the second pass of one with two: a folder
 * of labels may be of an earlier run. */
inline bool isSecondPass(const Config& config, const std::string& output)
{
  std::error_code none;
  const std::string labels = labelsIn(config);
  return !labels.empty() && std::filesystem::equivalent(labels, labelsOfFirstPass(output), none);
}

/** \throws UserError if labels are given for a run that makes them itself. */
inline void requireNoLabels(const SlamArguments& a)
{
  const std::string given = labelsIn(readGivenSettings(a.config, assignmentsOf(a)).merged());
  if (!given.empty())
  {
    throw UserError("dyseg.labels=" + given +
                    ": --passes 2 makes labels of its own in the first pass; give one of the two");
  }
}

/** Moves the labels of the first pass to where the second one, which writes into the same folder,
 * does not replace them. \return the new folder. \throws UserError. */
inline std::string keepLabelsOfFirstPass(const std::string& output)
{
  namespace fs = std::filesystem;
  const fs::path kept = labelsOfFirstPass(output);
  const fs::path made = fs::path(output) / "labels";
  try
  {
    for (const fs::path& folder : {kept.parent_path(), kept})
    {
      if (fs::is_symlink(folder))
      {
        throw UserError(folder.string() + ": is a link; remove it, or choose another --output");
      }
    }
    fs::create_directories(kept);
    removeLabels(kept);
    for (const auto& entry : entriesOf(made))
    {
      fs::rename(entry.path(), kept / entry.path().filename());
    }
    fs::remove(made);
  }
  catch (const fs::filesystem_error& error)
  {
    throw UserError(kept.string() + ": cannot be written (" + error.code().message() +
                    "); choose another --output");
  }
  return kept.string();
}
}  // namespace dyslam
