// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Bytes.h>
#include <dyslam/base/Config.h>
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/PendingFile.h>
#include <dyslam/base/Printable.h>
#include <dyslam/formats/GroundTruth.h>
#include <dyslam/formats/TextFile.h>
#include <dyslam/formats/TrackFiles.h>
#include <dyslam/formats/TrajectoryFiles.h>

#include <algorithm>
#include <filesystem>

namespace dyslam
{
namespace fs = std::filesystem;

namespace
{
constexpr const char* simulator_file = "simulator.ini";
constexpr const char* simulator_section = "simulator";
constexpr const char* origin_file = "poses.ini";
constexpr const char* origin_section = "poses";

/** poses.ini */
struct OriginOptions : Options
{
  PoseOrigin values;
  void describe(OptionsVisitor& visitor) override
  {
    describePoseSource(visitor, "source", values.source,
                       "source of the true poses; only simulated ones are exact");
    visitor.text("name", values.name, "file or topic from which the true poses were read");
  }
};

/** The keys of simulator.ini that are read. */
struct WorldOptions : Options
{
  SimulatedWorld values;
  void describe(OptionsVisitor& visitor) override
  {
    visitor.text("world", values.world, "kind of the simulated world");
    visitor.text("sensor", values.sensor, "simulated LiDAR");
    visitor.real("traffic", values.traffic, 0, 1,
                 "traffic density, from 0 (nothing moves) to 1 (jam)");
    visitor.integer("seed", values.seed, 0, 2147483647, "seed of world, traffic and noise");
  }
};

/** Moves the files of a folder and its subfolders to those of another folder, which keep their
 * other files. \throws UserError. */
void moveFiles(const fs::path& from, const fs::path& to)
{
  makeFolder(to.string());
  for (const fs::directory_entry& entry : entriesOf(from))
  {
    const fs::path target = to / entry.path().filename();
    std::error_code error;
    if (entry.is_directory(error))
    {
      moveFiles(entry.path(), target);
      continue;
    }
    fs::rename(entry.path(), target, error);
    if (error)
    {
      throw UserError(target.string() + ": cannot be written: " + error.message());
    }
  }
}
}  // namespace

std::optional<SimulatedWorld> simulatedWorld(const std::string& folder)
{
  const fs::path path = fs::path(folder) / simulator_file;
  if (!fs::exists(path))
  {
    return std::nullopt;
  }
  const Config all = Config::fromFile(path.string());
  const Config::Section& section = all.section(simulator_section);
  Config read;
  for (const char* key : {"world", "sensor", "traffic", "seed"})
  {
    const auto value = section.find(key);
    if (value == section.end())
    {
      throw UserError(path.string() + ": has no " + key + " in [simulator]; simulate it again");
    }
    read.set(simulator_section, key, value->second);
  }
  WorldOptions options;
  load(options, read, simulator_section);
  return options.values;
}

PoseOrigin poseOrigin(const std::string& folder)
{
  if (fs::exists(fs::path(folder) / simulator_file))
  {
    return {PoseSource::simulated, ""};
  }
  OriginOptions options;
  if (const fs::path path = fs::path(folder) / origin_file; fs::exists(path))
  {
    load(options, Config::fromFile(path.string()), origin_section);
  }
  return options.values;
}

std::string groundTruthFolder(const std::string& rawlog_path)
{
  return fs::path(rawlog_path).replace_extension(".gt").string();
}

std::optional<std::vector<Label>> trueLabels(const std::string& folder,
                                             std::size_t frame,
                                             std::size_t points)
{
  const fs::path path = fs::path(folder) / "labels" / numberedName(frame, ".label");
  if (!fs::exists(path))
  {
    return std::nullopt;
  }
  auto labels = readLabels(path.string());
  if (labels.size() != points)
  {
    const bool may_be_of_several = labels.size() > points;
    throw UserError(path.string() + ": has " + counted(labels.size(), "label") +
                    ", but the scan has " + counted(points, "point") +
                    (may_be_of_several ? "; those of a recording of several lidars are of the "
                                         "points of all, which --further-lidars merges"
                                       : "") +
                    "; are both of one recording?");
  }
  return labels;
}

void requireNoLinks(const std::string& folder)
{
  for (const char* sub : {"labels", "flow"})
  {
    const fs::path path = fs::path(folder) / sub;
    std::error_code ignored;
    if (fs::is_symlink(fs::symlink_status(path, ignored)))
    {
      throw UserError(path.string() + ": is a link, and the files behind it would be replaced; " +
                      "remove the link, or choose another --output");
    }
  }
}

void removeGroundTruth(const std::string& folder)
{
  requireNoLinks(folder);
  for (const char* old : {true_poses_file, "tracks.txt", simulator_file, origin_file})
  {
    std::error_code ignored;
    fs::remove(fs::path(folder) / old, ignored);
  }
  // Only files of our own naming: the folder might hold someone's notes.
  for (const char* sub : {"labels", "flow"})
  {
    for (const auto& entry : entriesIfReadable(fs::path(folder) / sub))
    {
      const auto extension = entry.path().extension();
      if (extension == ".label" || extension == ".flow")
      {
        std::error_code ignored;
        fs::remove(entry.path(), ignored);
      }
    }
    std::error_code not_empty;
    fs::remove(fs::path(folder) / sub, not_empty);
  }
}

GroundTruthWriter::GroundTruthWriter(const std::string& folder) : folder_(folder)
{
  removeGroundTruth(folder);
  makeFolder(folder);
}

GroundTruthWriter::~GroundTruthWriter()
{
  try
  {
    close();
  }
  catch (const std::exception&)
  {
    // Errors are reported by close().
  }
}

void GroundTruthWriter::addPose(double stamp, const Pose& T_world_vehicle)
{
  // Readers refuse times that do not ascend; of scans with such times none is processed, either.
  if (poses_.empty() || stamp > poses_[poses_.size() - 1].stamp)
  {
    poses_.push_back(stamp, T_world_vehicle);
  }
}

void GroundTruthWriter::addBox(const LabelledBox& box)
{
  boxes_.push_back(box);
}

void GroundTruthWriter::addLabels(std::size_t frame, const std::vector<Label>& labels)
{
  const fs::path folder = fs::path(folder_) / "labels";
  makeFolder(folder.string());
  writeLabels(numberedPath(folder.string(), frame, ".label"), labels);
}

void GroundTruthWriter::addFlow(std::size_t frame, const std::vector<Eigen::Vector3f>& flow)
{
  const fs::path folder = fs::path(folder_) / "flow";
  makeFolder(folder.string());
  writeWhole(numberedPath(folder.string(), frame, ".flow"), bytesOf(flow));
}

void GroundTruthWriter::addSimulator(const Options& options)
{
  Config config;
  save(options, config, simulator_section);
  writeWhole((fs::path(folder_) / simulator_file).string(), config.toIni());
}

void GroundTruthWriter::close()
{
  if (closed_)
  {
    return;
  }
  closed_ = true;
  if (!poses_.empty())
  {
    writeTum((fs::path(folder_) / true_poses_file).string(), poses_);
    if (origin_.source != PoseSource::unknown)
    {
      OriginOptions options;
      options.values = {origin_.source, printable(origin_.name)};
      Config config;
      save(options, config, origin_section);
      writeWhole((fs::path(folder_) / origin_file).string(), config.toIni());
    }
  }
  if (!boxes_.empty())
  {
    std::stable_sort(boxes_.begin(), boxes_.end(),
                     [](const LabelledBox& a, const LabelledBox& b) { return a.frame < b.frame; });
    writeTracks((fs::path(folder_) / "tracks.txt").string(), boxes_);
  }
}

void installGroundTruth(const std::string& pending, const std::string& folder)
{
  std::error_code not_empty;
  fs::rename(pending, folder, not_empty);
  if (not_empty)
  {
    moveFiles(pending, folder);
  }
}
}  // namespace dyslam
