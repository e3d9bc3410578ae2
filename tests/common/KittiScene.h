// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/formats/KittiTracks.h>

#include <cmath>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

namespace dyslam
{
constexpr int kitti_scene_frames = 60;

/** Writes a synthetic sequence 0000 in KITTI's layout: calib, oxts, label_02, and
 * det_pointrcnn with noise, misses and false alarms. The vehicle drives eastwards. */
inline void writeKittiScene(const std::filesystem::path& folder)
{
  constexpr double frame_time = 0.1036;  // [s]
  constexpr double ego_speed = 10;       // [m/s]
  for (const char* sub : {"calib", "oxts", "label_02", "det_pointrcnn"})
  {
    std::filesystem::create_directories(folder / sub);
  }
  std::ofstream(folder / "calib/0000.txt")
      << "P2: 700 0 600 0 0 700 180 0 0 0 1 0\nR_rect 1 0 0 0 1 0 0 0 1\n"
         "Tr_velo_cam 0 -1 0 0 0 0 -1 0 1 0 0 0\nTr_imu_velo 1 0 0 0 0 1 0 0 0 0 1 0\n";
  std::ofstream oxts(folder / "oxts/0000.txt");
  oxts.precision(15);
  for (int f = 0; f < kitti_scene_frames; ++f)
  {
    const double east = ego_speed * frame_time * f;
    oxts << "0 " << east / 6378137.0 * 180 / M_PI << " 100 0 0 0 0 " << ego_speed << " "
         << ego_speed;
    for (int column = 9; column < 30; ++column)
    {
      oxts << " 0";
    }
    oxts << "\n";
  }
  struct Actor
  {
    ObjectClass object_class;
    Eigen::Vector2d start;  // position in the first scan [m]
    Eigen::Vector2d velocity;
    Eigen::Vector3d size;
  };
  const std::vector<Actor> actors{{ObjectClass::car, {12, 3}, {10, 0}, {4.2, 1.8, 1.5}},
                                  {ObjectClass::car, {60, -4}, {-3, 0}, {3.9, 1.7, 1.5}},
                                  {ObjectClass::car, {40, 8}, {0, 0}, {4.4, 1.8, 1.6}},
                                  {ObjectClass::pedestrian, {50, -7}, {1.2, 0.2}, {0.7, 0.6, 1.8}}};
  std::mt19937 generator(11);
  std::normal_distribution<double> noise(0, 0.06);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<LabelledBox> labels;
  std::vector<LabelledBox> detections;
  for (int f = 0; f < kitti_scene_frames; ++f)
  {
    const double t = f * frame_time;
    for (std::size_t i = 0; i < actors.size(); ++i)
    {
      LabelledBox box;
      box.frame = f;
      box.id = static_cast<int>(i);
      box.object_class = actors[i].object_class;
      const Eigen::Vector2d at =
          actors[i].start + t * (actors[i].velocity - Eigen::Vector2d(ego_speed, 0));
      if (at.x() < 5)
      {
        continue;
      }
      box.box.centre = {at.x(), at.y(), -0.9};
      box.box.size = actors[i].size;
      box.image_box = {100.0 * static_cast<double>(i), 100, 100.0 * static_cast<double>(i) + 90,
                       200};
      labels.push_back(box);
      if (uniform(generator) < 0.1)
      {
        continue;
      }
      box.box.centre += Eigen::Vector3d(noise(generator), noise(generator), 0);
      box.score = 4 + uniform(generator);
      detections.push_back(box);
    }
    if (f % 3 == 0)
    {
      LabelledBox box = labels.back();
      box.object_class = ObjectClass::car;
      box.box.centre = {10 + 40 * uniform(generator), 20 * uniform(generator) - 10, -0.9};
      box.box.size = actors[0].size;
      box.score = 0.5 + uniform(generator);
      detections.push_back(box);
    }
  }
  const Pose T_cam_velo = readKittiCalib((folder / "calib/0000.txt").string()).T_cam_velo;
  writeKittiTracks((folder / "label_02/0000.txt").string(), labels, T_cam_velo);
  writeKittiTracks((folder / "det_pointrcnn/0000.txt").string(), detections, T_cam_velo);
}
}  // namespace dyslam
