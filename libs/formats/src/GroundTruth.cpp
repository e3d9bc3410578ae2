// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Config.h>
#include <dyslam/core/Error.h>
#include <dyslam/core/PendingFile.h>
#include <dyslam/core/Printable.h>
#include <dyslam/formats/GroundTruth.h>
#include <dyslam/formats/TextFile.h>
#include <dyslam/formats/TrajectoryFiles.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>

#include "TrackLines.h"

namespace dyslam
{
namespace fs = std::filesystem;

namespace
{
constexpr const char* simulator_file = "simulator.ini";
constexpr const char* simulator_section = "simulator";
constexpr const char* origin_file = "poses.ini";
constexpr const char* origin_section = "poses";

struct NamedSource
{
  const char* word;
  PoseSource source;
};
constexpr std::array<NamedSource, 4> pose_sources{{{"unknown", PoseSource::unknown},
                                                   {"simulated", PoseSource::simulated},
                                                   {"gnss_ins", PoseSource::gnss_ins},
                                                   {"given", PoseSource::given}}};

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

std::string PoseOrigin::text() const
{
  const std::string from = name.empty() ? "" : " (" + name + ")";
  switch (source)
  {
    case PoseSource::simulated:
      return "simulated" + from + ", exact";
    case PoseSource::gnss_ins:
      return "GNSS/INS" + from + ", not exact";
    case PoseSource::given:
      return "given poses" + from + ", not known to be exact";
    case PoseSource::unknown:
      break;
  }
  return "of unknown source" + from + ", not known to be exact";
}

std::string toString(PoseSource source)
{
  return std::find_if(pose_sources.begin(), pose_sources.end(),
                      [source](const NamedSource& named) { return named.source == source; })
      ->word;
}

PoseSource poseSourceFromString(const std::string& word)
{
  const auto found = std::find_if(pose_sources.begin(), pose_sources.end(),
                                  [&word](const NamedSource& named) { return word == named.word; });
  return found == pose_sources.end() ? PoseSource::unknown : found->source;
}

void describePoseSource(OptionsVisitor& visitor,
                        const char* key,
                        PoseSource& source,
                        const char* help)
{
  std::vector<std::string> words;
  for (const NamedSource& named : pose_sources)
  {
    words.emplace_back(named.word);
  }
  std::string word = toString(source);
  visitor.word(key, word, words, help);
  source = poseSourceFromString(word);
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

std::vector<LabelledBox> readTracks(const std::string& path)
{
  TextFile file(path);
  std::vector<LabelledBox> boxes;
  while (file.next())
  {
    LabelledBox box = readTrackLine(file, "height width length x y z yaw");
    box.id = file.integer(1);
    box.box.size = {file.number(12), file.number(11), file.number(10)};
    box.box.center = {file.number(13), file.number(14), file.number(15)};
    box.box.yaw = file.number(16);
    boxes.push_back(box);
  }
  return boxes;
}

std::string trackLine(const LabelledBox& box)
{
  std::string text = std::to_string(box.frame) + ' ' + std::to_string(box.id) + ' ' +
                     typeWord(box) + ' ' + std::to_string(box.truncated) + ' ' +
                     std::to_string(box.occluded);
  const auto append = [&text](double value)
  {
    text += ' ';
    appendNumber(text, value, 9);
  };
  append(-10);  // alpha, the observation angle in the camera image: unknown
  for (int i = 0; i < 4; ++i)
  {
    append(box.image_box[i]);
  }
  const Box& b = box.box;
  for (const double value : {b.size.z(), b.size.y(), b.size.x(), b.center.x(), b.center.y(),
                             b.center.z(), b.yaw, box.score})
  {
    append(value);
  }
  return text + '\n';
}

void writeTracks(const std::string& path, const std::vector<LabelledBox>& boxes)
{
  std::string text;
  for (const LabelledBox& box : boxes)
  {
    text += trackLine(box);
  }
  writeWhole(path, text);
}

GroundTruthReader::GroundTruthReader(const std::string& folder) : folder_(folder)
{
  if (!fs::is_directory(folder))
  {
    throw UserError(folder + ": no such folder of ground truth");
  }
  const fs::path root(folder);
  if (fs::exists(root / "poses_tum.txt"))
  {
    poses_ = readTum((root / "poses_tum.txt").string());
  }
  if (fs::exists(root / "tracks.txt"))
  {
    tracks_ = readTracks((root / "tracks.txt").string());
  }
  for (std::size_t i = 0; i < tracks_.size(); ++i)
  {
    boxes_of_frame_.emplace(tracks_[i].frame, i);
  }
}

std::vector<LabelledBox> GroundTruthReader::boxes(std::size_t frame) const
{
  std::vector<LabelledBox> result;
  const auto range = boxes_of_frame_.equal_range(static_cast<int>(frame));
  for (auto it = range.first; it != range.second; ++it)
  {
    result.push_back(tracks_[it->second]);
  }
  return result;
}

std::optional<std::vector<Label>> GroundTruthReader::labels(std::size_t frame,
                                                            std::size_t points) const
{
  const fs::path path = fs::path(folder_) / "labels" / numberedName(frame, ".label");
  if (!fs::exists(path))
  {
    return std::nullopt;
  }
  return readLabels(path.string(), points);
}

std::optional<std::vector<Eigen::Vector3f>> GroundTruthReader::flow(std::size_t frame,
                                                                    std::size_t points) const
{
  const fs::path path = fs::path(folder_) / "flow" / numberedName(frame, ".flow");
  if (!fs::exists(path))
  {
    return std::nullopt;
  }
  const std::string bytes = readWhole(path.string());
  if (bytes.size() != points * 3 * sizeof(float))
  {
    throw UserError(path.string() + ": has " + std::to_string(bytes.size()) +
                    " bytes; 12 for each of the scan's " + std::to_string(points) +
                    " points are needed");
  }
  std::vector<Eigen::Vector3f> flow(points);
  for (std::size_t i = 0; i < points; ++i)
  {
    std::memcpy(flow[i].data(), bytes.data() + i * 3 * sizeof(float), 3 * sizeof(float));
  }
  return flow;
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

GroundTruthWriter::GroundTruthWriter(const std::string& folder) : folder_(folder)
{
  requireNoLinks(folder);
  makeFolder(folder);
  for (const char* old : {"poses_tum.txt", "tracks.txt", simulator_file, origin_file})
  {
    std::error_code ignored;
    fs::remove(fs::path(folder) / old, ignored);
  }
  // Only files of our own naming: the folder might hold someone's notes.
  for (const char* sub : {"labels", "flow"})
  {
    const fs::path path = fs::path(folder) / sub;
    std::error_code error;
    for (fs::directory_iterator it(path, error), end; !error && it != end; it.increment(error))
    {
      const auto extension = it->path().extension();
      if (extension == ".label" || extension == ".flow")
      {
        std::error_code ignored;
        fs::remove(it->path(), ignored);
      }
    }
  }
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
  static_assert(sizeof(Eigen::Vector3f) == 3 * sizeof(float), "packed vectors are needed");
  const fs::path folder = fs::path(folder_) / "flow";
  makeFolder(folder.string());
  writeWhole(numberedPath(folder.string(), frame, ".flow"),
             std::string_view(reinterpret_cast<const char*>(flow.data()),
                              flow.size() * sizeof(Eigen::Vector3f)));
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
    writeTum((fs::path(folder_) / "poses_tum.txt").string(), poses_);
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
}  // namespace dyslam
