// SPDX-License-Identifier: BSD-3-Clause
#include "KittiSequenceFiles.h"

#include <dyslam/base/Config.h>
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/PendingFile.h>
#include <dyslam/formats/PointTimeFiles.h>
#include <dyslam/formats/TextFile.h>

#include <set>
#include <system_error>

namespace dyslam
{
namespace fs = std::filesystem;

namespace
{
constexpr const char* mark_name = "rawlog2kitti.ini";
constexpr const char* mark_section = "export";

fs::path pendingOf(const fs::path& path)
{
  return path.string() + ".tmp";
}

void renameTo(const fs::path& from, const fs::path& to)
{
  std::error_code error;
  fs::rename(from, to, error);
  if (error)
  {
    throw UserError(to.string() + ": cannot be written: " + error.message());
  }
}
}  // namespace

KittiSequenceFiles::KittiSequenceFiles(const fs::path& folder, const KittiExportOptions& options)
{
  const std::string file = options.sequence + ".txt";
  sequence_.path = folder / "sequences" / options.sequence;
  poses_.path = folder / "poses" / file;
  tracks_.path = folder / "tracks" / file;
  for (Target* target : {&sequence_, &poses_, &tracks_})
  {
    target->pending = pendingOf(target->path);
  }
  requireReplaceable(poses_, options.force);
  if (options.poses_only)
  {
    return;
  }
  requireReplaceable(sequence_, options.force);
  if (!options.tracks.empty())
  {
    requireReplaceable(tracks_, options.force);
  }
  if (fs::exists(sequence_.path))
  {
    requireNoOtherFiles();
  }
  if (fs::exists(sequence_.pending) && !isExport(sequence_.pending))
  {
    throw UserError(sequence_.pending.string() +
                    ": is in the way of the export; remove it, or name another with --sequence");
  }
}

void KittiSequenceFiles::beginSequence()
{
  fs::remove_all(sequence_.pending);  // of a killed program
  makeFolder(sequence_.pending.string());
  sequence_.is_written = true;
  writeMark();
}

KittiSequenceFiles::~KittiSequenceFiles()
{
  std::error_code ignored;
  for (const Target* target : {&sequence_, &poses_, &tracks_})
  {
    if (target->is_written)
    {
      fs::remove_all(target->pending, ignored);
    }
  }
}

bool KittiSequenceFiles::isExport(const fs::path& sequence)
{
  return fs::exists(sequence / mark_name);
}

/** \throws UserError for a file that is there, without --force and in an original dataset. */
void KittiSequenceFiles::requireReplaceable(const Target& target, bool force) const
{
  if (!fs::exists(target.path))
  {
    return;
  }
  if (!force)
  {
    throw UserError(target.path.string() +
                    ": is there already; replace it with --force, or name another with --sequence");
  }
  const bool is_file_missing = &target != &sequence_ && !fs::is_regular_file(target.path);
  if (is_file_missing || (fs::exists(sequence_.path) && !isExport(sequence_.path)))
  {
    throw UserError(
        target.path.string() + ": was not written by rawlog2kitti (" + sequence_.path.string() +
        " has no " + mark_name +
        "), so that --force does not replace it; choose another --output or --sequence");
  }
}

/** \throws UserError if someone has put files into the folder of an export. */
void KittiSequenceFiles::requireNoOtherFiles() const
{
  const std::set<std::string> own{
      mark_name,   "velodyne",  "labels",   std::string(point_time_folder),
      "times.txt", "calib.txt", "poses.txt"};
  for (const auto& entry : entriesOf(sequence_.path))
  {
    const std::string name = entry.path().filename().string();
    if (own.count(name) == 0)
    {
      throw UserError(sequence_.path.string() + ": has files of others (" + name +
                      "), which --force does not remove; name another with --sequence");
    }
  }
}

std::string KittiSequenceFiles::begin(Target& file)
{
  makeFolder(file.path.parent_path().string());
  file.is_written = true;
  return file.pending.string();
}

std::string KittiSequenceFiles::beginPoses()
{
  return begin(poses_);
}

std::string KittiSequenceFiles::beginTracks()
{
  return begin(tracks_);
}

/** States which files beside the folder are of the export, for the next one. */
void KittiSequenceFiles::writeMark() const
{
  const auto flag = [](bool value) { return value ? "true" : "false"; };
  writeWhole(
      (sequence_.pending / mark_name).string(),
      std::string("# By this file rawlog2kitti --force knows that it may replace the folder.\n"
                  "[") +
          mark_section + "]\nposes = " + flag(poses_.is_written) +
          "\ntracks = " + flag(tracks_.is_written) + "\n");
}

/** \param name of the file in the mark of the earlier export */
void KittiSequenceFiles::installFile(const Target& file, const std::string& name) const
{
  if (file.is_written)
  {
    renameTo(file.pending, file.path);
    return;
  }
  const fs::path mark = sequence_.path / mark_name;
  if (sequence_.is_written && fs::exists(mark) &&
      Config::fromFile(mark.string()).text(mark_section, name).value_or("") == "true")
  {
    std::error_code ignored;
    fs::remove(file.path, ignored);
  }
}

void KittiSequenceFiles::install()
{
  if (sequence_.is_written)
  {
    writeMark();
  }
  installFile(poses_, "poses");
  installFile(tracks_, "tracks");
  if (!sequence_.is_written)
  {
    return;
  }
  const fs::path earlier = sequence_.path.string() + ".old.tmp";
  std::error_code ignored;
  if (fs::exists(sequence_.path))
  {
    fs::remove_all(earlier, ignored);
    renameTo(sequence_.path, earlier);
  }
  renameTo(sequence_.pending, sequence_.path);
  fs::remove_all(earlier, ignored);
}
}  // namespace dyslam
