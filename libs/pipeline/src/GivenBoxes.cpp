// SPDX-License-Identifier: BSD-3-Clause
#include "GivenBoxes.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/Printable.h>
#include <dyslam/base/Words.h>
#include <dyslam/formats/KittiTracks.h>
#include <dyslam/formats/TextFile.h>
#include <dyslam/formats/TrackFiles.h>
#include <dyslam/tracking/BoxDetections.h>

#include <algorithm>
#include <filesystem>
#include <optional>

#include "DetectorClasses.h"

namespace dyslam
{
namespace
{
namespace fs = std::filesystem;

std::vector<LabelledBox> readFolder(const std::string& folder,
                                    const std::optional<Pose>& T_cam_velo)
{
  std::map<int, std::string> files;
  for (const auto& entry : entriesOf(folder))
  {
    if (const auto scan = numberOfName(entry.path().filename().string(), ".txt"))
    {
      const std::string file = entry.path().string();
      const auto [known, is_first] = files.emplace(*scan, file);
      if (!is_first)
      {
        throw UserError(file + ": is of the same scan as " + known->second);
      }
    }
  }
  if (files.empty())
  {
    throw UserError(folder + ": has no NNNNNN.txt with the boxes of a scan");
  }
  std::vector<LabelledBox> boxes;
  for (const auto& [scan, file] : files)
  {
    for (LabelledBox& box : readKittiObjects(file, T_cam_velo))
    {
      box.frame = scan;
      boxes.push_back(std::move(box));
    }
  }
  return boxes;
}

bool hasExtent(const LabelledBox& box)
{
  return box.box.size.minCoeff() > 0;
}

/** Whether most boxes are higher above the lidar than what moves on the ground: z of a camera is
 * ahead. */
bool areMostlyInTheAir(const std::map<std::size_t, std::vector<LabelledBox>>& boxes)
{
  constexpr double highest = 5;  // above the lidar [m]
  std::size_t all = 0;
  std::size_t high = 0;
  for (const auto& [scan, of_scan] : boxes)
  {
    all += of_scan.size();
    high += static_cast<std::size_t>(std::count_if(of_scan.begin(), of_scan.end(),
                                                   [](const LabelledBox& box)
                                                   { return box.box.centre.z() > highest; }));
  }
  return 2 * high > all;
}

/** \throws UserError that names the key. */
void requireThere(const std::string& key, const std::string& path)
{
  if (!fs::exists(path))
  {
    throw UserError("boxes." + key + ": " + path + ": no such file or folder");
  }
}

std::vector<LabelledBox> readBoxes(const GivenBoxesOptions& options)
{
  requireThere("file", options.file);
  std::optional<Pose> T_cam_velo;
  if (!options.calib.empty())
  {
    requireThere("calib", options.calib);
    T_cam_velo = namingSetting("boxes.calib", options.calib,
                               [&] { return readKittiCalib(options.calib).T_cam_velo; });
  }
  return namingSetting("boxes.file", options.file,
                       [&]
                       {
                         return fs::is_directory(options.file)
                                    ? readFolder(options.file, T_cam_velo)
                                : T_cam_velo ? readDetections(options.file, *T_cam_velo)
                                             : readTracks(options.file);
                       });
}
}  // namespace

void GivenBoxesOptions::describe(OptionsVisitor& visitor)
{
  visitor.text("file", file,
               "boxes of another detector, which are tracked instead of clusters of moving points: "
               "KITTI's tracking columns, or a folder of NNNNNN.txt in KITTI's object layout; "
               "empty: none");
  visitor.text("calib", calib,
               "KITTI's calibration, file or folder: the boxes are in the camera frame; empty: in "
               "the lidar frame, x y z their centre");
  visitor.real("min_score", min_score, -1e6, 1e6, "boxes with a lower score are left out");
}

GivenBoxes::GivenBoxes(const GivenBoxesOptions& options, const DetectionNoiseOptions& noise)
    : noise_(noise)
{
  validate(options, "boxes");
  validate(noise, "detection_noise");
  bool has_flat = false;
  for (LabelledBox& box : readBoxes(options))
  {
    const std::optional<ObjectClass> object_class = classFromDetector(box.type);
    const bool counts = box.frame >= 0 && box.score >= options.min_score && box.type != "DontCare";
    if (counts && !object_class)
    {
      ++immobile_;
      immobile_names_.insert(box.type);
    }
    else if (counts && !hasExtent(box))
    {
      has_flat = true;
    }
    else if (counts)
    {
      box.object_class = *object_class;
      boxes_[static_cast<std::size_t>(box.frame)].push_back(std::move(box));
    }
  }
  if (boxes_.empty())
  {
    throw UserError("boxes.file: " + options.file + ": has no boxes" +
                    (has_flat        ? " with a height, width and length above 0"
                     : immobile_ > 0 ? " of things that can move"
                     : options.min_score > GivenBoxesOptions().min_score
                         ? " with a score of at least boxes.min_score"
                         : ""));
  }
  is_camera_frame_likely_ = options.calib.empty() && areMostlyInTheAir(boxes_);
}

std::vector<std::string> GivenBoxes::warnings() const
{
  std::vector<std::string> result;
  if (immobile_ > 0)
  {
    result.push_back("boxes.file: left out " + counted(immobile_, "detection") +
                     " of things that cannot move (" + joined(immobile_names_) + ")");
  }
  if (is_camera_frame_likely_)
  {
    result.emplace_back(
        "boxes.file: most boxes are more than 5 m above the lidar; if they are in KITTI's camera "
        "frame, boxes.calib is needed");
  }
  return result;
}

void GivenBoxes::detect(Frame& frame) const
{
  const auto boxes = boxes_.find(frame.index);
  frame.detections.clear();
  if (boxes != boxes_.end())
  {
    frame.detections = detectionsOf(boxes->second, frame, noise_);
  }
}

void GivenBoxes::markMoving(Frame& frame)
{
  constexpr float probability = 0.9F;  // that a point in the box of a dynamic object moves
  for (const TrackedObject& object : frame.objects)
  {
    if (object.confirmed && object.dynamic)
    {
      frame.moving.resize(frame.cloud.size(), false);
      frame.moving_probability.resize(frame.cloud.size(), 0);
      for (const std::uint32_t i : frame.pointsOf(object))
      {
        frame.moving[i] = true;
        frame.moving_probability[i] = std::max(frame.moving_probability[i], probability);
      }
    }
  }
}
}  // namespace dyslam
