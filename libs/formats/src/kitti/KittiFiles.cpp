// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/formats/Kitti360Files.h>
#include <dyslam/formats/KittiFiles.h>
#include <dyslam/formats/TextFile.h>
#include <dyslam/formats/TrajectoryFiles.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>

#include "CalibEntries.h"
#include "TrackLines.h"

namespace dyslam
{
namespace fs = std::filesystem;

namespace
{
constexpr double earth_radius = 6378137.0;  // [m], as the development kit has it

Pose poseFromRT(const std::string& path)
{
  const CalibEntries entries(path);
  Pose pose = entries.pose({"R"}, 3);
  const auto& t = entries.numbers({"T"}, 3);
  pose.translation() = Eigen::Vector3d(t[0], t[1], t[2]);
  return pose;
}

void setP2(const std::vector<double>& values, KittiCalib& calib)
{
  for (std::size_t i = 0; i < 12; ++i)
  {
    calib.P2(static_cast<int>(i / 4), static_cast<int>(i % 4)) = values[i];
  }
}

KittiCalib readRawFolder(const fs::path& folder)
{
  KittiCalib calib;
  const std::string camera = (folder / "calib_cam_to_cam.txt").string();
  const std::string lidar = (folder / "calib_velo_to_cam.txt").string();
  const fs::path imu = folder / "calib_imu_to_velo.txt";
  calib.has_camera = fs::exists(camera) || fs::exists(lidar) || !fs::exists(imu);
  if (calib.has_camera)
  {
    const CalibEntries entries(camera);
    calib.T_cam_velo = entries.pose({"R_rect_00"}, 3) * poseFromRT(lidar);
    if (const auto* P2 = entries.find({"P_rect_02"}, 12))
    {
      setP2(*P2, calib);
    }
  }
  if (fs::exists(imu))
  {
    calib.T_velo_imu = poseFromRT(imu.string());
    calib.has_imu = true;
  }
  return calib;
}

KittiCalib readFolder(const fs::path& folder)
{
  return isKitti360Calib(folder.string()) ? readKitti360Calib(folder.string())
                                          : readRawFolder(folder);
}

/** Whether a file of this name is read with the others of its folder. */
bool isPartOfFolder(const std::string& name)
{
  const auto names = {"calib_cam_to_cam.txt", "calib_velo_to_cam.txt", "calib_imu_to_velo.txt",
                      "calib_cam_to_velo.txt", "calib_cam_to_pose.txt"};
  return std::find(names.begin(), names.end(), name) != names.end();
}

OxtsReading oxtsFrom(const TextFile& file)
{
  if (file.fields().size() < 25)
  {
    file.fail("has " + std::to_string(file.fields().size()) +
              " numbers; oxts data have 30, of which the first 25 are needed");
  }
  OxtsReading r;
  r.latitude = file.number(0);
  r.longitude = file.number(1);
  r.altitude = file.number(2);
  r.roll = file.number(3);
  r.pitch = file.number(4);
  r.yaw = file.number(5);
  r.position_accuracy = file.number(23);
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    r.acceleration[static_cast<int>(axis)] = file.number(11 + axis);
    r.angular_velocity[static_cast<int>(axis)] = file.number(17 + axis);
  }
  if (std::abs(r.latitude) >= 90)
  {
    file.fail("the latitude is not between -90 and 90");
  }
  return r;
}
}  // namespace

KittiCalib readKittiCalib(const std::string& file_or_folder)
{
  if (fs::is_directory(file_or_folder))
  {
    return readFolder(file_or_folder);
  }
  const std::string& path = file_or_folder;
  if (isPartOfFolder(fs::path(path).filename().string()))
  {
    const fs::path folder = fs::path(path).parent_path();
    return readFolder(folder.empty() ? fs::path(".") : folder);
  }
  const CalibEntries entries(path);
  KittiCalib calib;
  if (entries.has("Tr"))
  {
    calib.T_cam_velo = entries.pose({"Tr"}, 4);
  }
  else
  {
    const Pose rectification = entries.pose({"R_rect", "R0_rect"}, 3);
    calib.T_cam_velo = rectification * entries.pose({"Tr_velo_cam", "Tr_velo_to_cam"}, 4);
  }
  if (entries.has("Tr_imu_velo") || entries.has("Tr_imu_to_velo"))
  {
    calib.T_velo_imu = entries.pose({"Tr_imu_velo", "Tr_imu_to_velo"}, 4);
    calib.has_imu = true;
  }
  if (const auto* P2 = entries.find({"P2"}, 12))
  {
    setP2(*P2, calib);
  }
  return calib;
}

namespace
{
/** \throws UserError unless year, month, day, hour and minute are those of a date and time. */
void requireDate(const TextFile& file)
{
  constexpr std::array<const char*, 5> names{"year", "month", "day", "hour", "minute"};
  constexpr std::array<int, 5> least{1, 1, 1, 0, 0};
  constexpr std::array<int, 5> most{9999, 12, 31, 23, 59};
  for (std::size_t i = 0; i < names.size(); ++i)
  {
    if (file.integer(i) < least[i] || file.integer(i) > most[i])
    {
      file.fail(std::string(names[i]) + " is " + std::to_string(file.integer(i)) + ", not " +
                std::to_string(least[i]) + " to " + std::to_string(most[i]));
    }
  }
}

/** A line such as `2011-09-26 13:02:25.951199337` [s since 1970]. \throws UserError. */
double dateAndTime(const TextFile& file)
{
  file.requireFields(6, "a date and time");
  requireDate(file);
  const int year = file.integer(0) - (file.integer(1) <= 2 ? 1 : 0);
  // Days since 1970 of a Gregorian date, with March as the year's first month.
  const int month = (file.integer(1) + 9) % 12;
  const int days = 365 * year + year / 4 - year / 100 + year / 400 + (153 * month + 2) / 5 +
                   file.integer(2) - 1 - 719468;
  return 86400.0 * days + 3600.0 * file.integer(3) + 60.0 * file.integer(4) + file.number(5);
}
}  // namespace

std::vector<double> readKittiTimestamps(const std::string& path)
{
  TextFile file(path, " \t\r-:");
  std::vector<double> times;
  std::size_t size = 0;  // up to the last time
  while (file.nextOrEmpty())
  {
    if (file.fields().empty())
    {
      times.push_back(std::numeric_limits<double>::quiet_NaN());
      continue;
    }
    times.push_back(dateAndTime(file));
    size = times.size();
  }
  times.resize(size);
  return times;
}

std::vector<double> readTimesOrTimestamps(const std::string& path)
{
  TextFile first(path, " ");
  return first.next() && first.line().find(':') != std::string::npos ? readKittiTimestamps(path)
                                                                     : readTimes(path);
}

std::vector<OxtsReading> readOxts(const std::string& file_or_folder)
{
  std::vector<OxtsReading> readings;
  if (!fs::is_directory(file_or_folder))
  {
    TextFile file(file_or_folder);
    while (file.next())
    {
      readings.push_back(oxtsFrom(file));
    }
    return readings;
  }
  fs::path folder(file_or_folder);
  for (const char* sub : {"oxts", "data"})
  {
    folder = fs::is_directory(folder / sub) ? folder / sub : folder;
  }
  std::vector<std::string> names;
  for (const auto& entry : entriesOf(folder))
  {
    const std::string stem = entry.path().stem().string();
    if (entry.path().extension() == ".txt" &&
        stem.find_first_not_of("0123456789") == std::string::npos)
    {
      names.push_back(entry.path().string());
    }
  }
  std::sort(names.begin(), names.end());
  for (const std::string& name : names)
  {
    const auto expected = static_cast<long long>(readings.size());
    const std::string stem = fs::path(name).stem().string();
    if (std::atoll(stem.c_str()) != expected)
    {
      throw UserError(folder.string() + ": has no " + std::to_string(expected) + ".txt (after it " +
                      stem + ".txt); the readings must be complete from number 0");
    }
    TextFile file(name);
    if (!file.next())
    {
      throw UserError(name + ": is empty");
    }
    readings.push_back(oxtsFrom(file));
  }
  if (readings.empty())
  {
    throw UserError(folder.string() + ": has no oxts data (0000000000.txt, ...)");
  }
  return readings;
}

std::vector<Pose> oxtsPoses(const std::vector<OxtsReading>& readings)
{
  std::vector<Pose> poses;
  if (readings.empty())
  {
    return poses;
  }
  const double scale = std::cos(readings.front().latitude * M_PI / 180);
  for (const OxtsReading& r : readings)
  {
    const double x = scale * earth_radius * r.longitude * M_PI / 180;
    const double y = scale * earth_radius * std::log(std::tan((90 + r.latitude) * M_PI / 360));
    poses.push_back(poseFromYpr(x, y, r.altitude, r.yaw, r.pitch, r.roll));
  }
  const Pose T_first_world = poses.front().inverse();
  for (Pose& pose : poses)
  {
    pose = T_first_world * pose;
  }
  poses.front() = Pose::Identity();
  return poses;
}

Box toLidar(const CameraBox& box, const Pose& T_cam_velo)
{
  const Pose T_velo_cam = T_cam_velo.inverse();
  Box result;
  result.centre = T_velo_cam * (box.bottom - Eigen::Vector3d(0, box.height / 2, 0));
  result.size = {box.length, box.width, box.height};
  const Eigen::Vector3d heading =
      T_velo_cam.linear() * Eigen::Vector3d(std::cos(box.ry), 0, -std::sin(box.ry));
  result.yaw = std::atan2(heading.y(), heading.x());
  return result;
}

std::vector<LabelledBox> readKittiTracking(const std::string& path,
                                           const Pose& T_cam_velo,
                                           bool keep_dont_care)
{
  TextFile file(path);
  std::vector<LabelledBox> boxes;
  while (file.next())
  {
    LabelledBox box = readTrackLine(file, "height width length x y z ry");
    if (keep_dont_care || box.type != "DontCare")
    {
      box.id = file.integerPart(1);
      box.box = toLidar(cameraBoxFrom(file, 10), T_cam_velo);
      boxes.push_back(box);
    }
  }
  return boxes;
}

std::vector<LabelledBox> readDetectionsCsv(const std::string& path, const Pose& T_cam_velo)
{
  TextFile file(path);
  std::vector<LabelledBox> boxes;
  while (file.next())
  {
    file.requireFields(15, "frame,type,x1,y1,x2,y2,score,h,w,l,x,y,z,ry,alpha");
    LabelledBox box;
    box.frame = frameFrom(file);
    const int type = file.integer(1);
    if (type < 1 || type > 3)
    {
      file.fail("type " + std::to_string(type) + " is not 1 (pedestrian), 2 (car) or 3 (cyclist)");
    }
    box.object_class = type == 1   ? ObjectClass::pedestrian
                       : type == 2 ? ObjectClass::car
                                   : ObjectClass::cyclist;
    box.type = toString(box.object_class);
    box.image_box = {file.number(2), file.number(3), file.number(4), file.number(5)};
    box.score = file.number(6);
    box.box = toLidar(cameraBoxFrom(file, 7), T_cam_velo);
    boxes.push_back(box);
  }
  return boxes;
}
}  // namespace dyslam
