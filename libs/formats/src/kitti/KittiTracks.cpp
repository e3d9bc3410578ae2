// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Angle.h>
#include <dyslam/base/PendingFile.h>
#include <dyslam/formats/KittiTracks.h>
#include <dyslam/formats/TextFile.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "TrackLines.h"

namespace dyslam
{
namespace
{
enum class Layout
{
  csv,
  with_id,
  without_id
};

bool isWord(std::string_view field)
{
  return !field.empty() && field.find_first_of("0123456789") != 0 && field.front() != '-' &&
         field.front() != '+' && field.front() != '.';
}

Layout layoutOf(const TextFile& file)
{
  const auto& fields = file.fields();
  if (fields.size() == 15 && !isWord(fields[1]))
  {
    return Layout::csv;
  }
  if (fields.size() == 18 && isWord(fields[2]))
  {
    return Layout::with_id;
  }
  if (fields.size() == 17 && isWord(fields[1]))
  {
    return Layout::without_id;
  }
  if (fields.size() == 17 && isWord(fields[2]))
  {
    file.fail("has no score; detections need one in an 18th column");
  }
  file.fail("has " + std::to_string(fields.size()) +
            " fields in no known order; give AB3DMOT's csv (15), or KITTI's tracking columns with "
            "a score (18, or 17 without the id)");
}

LabelledBox readWithoutId(const TextFile& file, const Pose& T_cam_velo)
{
  file.requireFields(17,
                     "frame type truncated occluded alpha left top right bottom height width "
                     "length x y z ry score");
  LabelledBox box;
  box.frame = frameFrom(file);
  box.type = std::string(file.fields()[1]);
  box.object_class = objectClassFromString(box.type);
  box.image_box = {file.number(5), file.number(6), file.number(7), file.number(8)};
  box.box = toLidar(cameraBoxFrom(file, 9), T_cam_velo);
  box.score = file.number(16);
  return box;
}
}  // namespace

CameraBox toCamera(const Box& box, const Pose& T_cam_velo)
{
  CameraBox result;
  result.length = box.size.x();
  result.width = box.size.y();
  result.height = box.size.z();
  result.bottom = T_cam_velo * box.centre + Eigen::Vector3d(0, box.size.z() / 2, 0);
  // The direction of this yaw that lies in the camera's horizontal plane.
  const Eigen::Matrix3d& R = T_cam_velo.linear();
  Eigen::Vector3d heading(std::cos(box.yaw), std::sin(box.yaw), 0);
  heading.z() = -R.row(1).head<2>().dot(heading.head<2>()) / R(1, 2);
  const Eigen::Vector3d in_camera = R * heading;
  result.ry = std::atan2(-in_camera.z(), in_camera.x());
  return result;
}

std::vector<LabelledBox> readDetections(const std::string& path, const Pose& T_cam_velo)
{
  TextFile file(path);
  if (!file.next())
  {
    return {};
  }
  switch (layoutOf(file))
  {
    case Layout::csv:
      return readDetectionsCsv(path, T_cam_velo);
    case Layout::with_id:
      do
      {
        file.requireFields(18, "KITTI's tracking columns with a score");
      } while (file.next());
      return readKittiTracking(path, T_cam_velo);
    case Layout::without_id:
      break;
  }
  std::vector<LabelledBox> boxes;
  do
  {
    boxes.push_back(readWithoutId(file, T_cam_velo));
  } while (file.next());
  boxes.erase(std::remove_if(boxes.begin(), boxes.end(),
                             [](const LabelledBox& box) { return box.type == "DontCare"; }),
              boxes.end());
  return boxes;
}

std::vector<LabelledBox> readKittiObjects(const std::string& path,
                                          const std::optional<Pose>& T_cam_velo)
{
  TextFile file(path);
  std::vector<LabelledBox> boxes;
  while (file.next())
  {
    const bool has_score = file.fields().size() == 16;
    if (!has_score)
    {
      file.requireFields(15,
                         "type truncated occluded alpha left top right bottom height width length "
                         "x y z ry, with or without score");
    }
    LabelledBox box;
    box.type = std::string(file.fields()[0]);
    if (box.type == "DontCare")
    {
      continue;
    }
    box.object_class = objectClassFromString(box.type);
    box.image_box = {file.number(4), file.number(5), file.number(6), file.number(7)};
    const CameraBox columns = cameraBoxFrom(file, 8);
    box.box =
        T_cam_velo
            ? toLidar(columns, *T_cam_velo)
            : Box{columns.bottom, {columns.length, columns.width, columns.height}, columns.ry};
    box.score = has_score ? file.number(15) : 1;
    boxes.push_back(std::move(box));
  }
  return boxes;
}

void writeKittiTracks(const std::string& path,
                      const std::vector<LabelledBox>& boxes,
                      const Pose& T_cam_velo)
{
  constexpr int digits = 12;
  std::string text;
  for (const LabelledBox& box : boxes)
  {
    const CameraBox camera = toCamera(box.box, T_cam_velo);
    const double alpha = wrapAngle(camera.ry - std::atan2(camera.bottom.x(), camera.bottom.z()));
    text += std::to_string(box.frame) + ' ' + std::to_string(box.id) + ' ' + typeWord(box) + ' ' +
            std::to_string(box.truncated) + ' ' + std::to_string(box.occluded);
    for (const double value :
         {alpha, box.image_box[0], box.image_box[1], box.image_box[2], box.image_box[3],
          camera.height, camera.width, camera.length, camera.bottom.x(), camera.bottom.y(),
          camera.bottom.z(), camera.ry, box.score})
    {
      text += ' ';
      appendNumber(text, value, digits);
    }
    text += '\n';
  }
  writeWhole(path, text);
}
}  // namespace dyslam
