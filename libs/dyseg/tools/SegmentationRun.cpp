// SPDX-License-Identifier: BSD-3-Clause
#include "SegmentationRun.h"

#include <dyslam/base/Error.h>
#include <dyslam/core/Scan.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <fstream>

namespace dyslam
{
namespace
{
/** Bird's-eye view, 80 m square, x up: grey true negatives, green true positives, red false
 * negatives, blue false positives. */
void writePicture(const std::string& file,
                  const Frame& frame,
                  const std::vector<std::uint8_t>& label)
{
  constexpr int side = 800;
  constexpr float half = 40;
  std::vector<std::uint8_t> image(3 * side * side, 255);
  const std::uint8_t colours[4][3] = {{150, 150, 150}, {40, 90, 255}, {230, 30, 30}, {0, 160, 40}};
  for (int kind = 0; kind < 4; ++kind)
  {
    for (std::size_t k = 0; k < frame.cloud.size(); ++k)
    {
      const bool predicted = frame.moving_probability[k] > 0.5F;
      const auto truth = label[frame.cloud.source[k]];
      const bool moves = truth == DysegSample::moving_point;
      const bool alarm = predicted && truth == DysegSample::static_point;
      if (kind != (moves ? (predicted ? 3 : 2) : (alarm ? 1 : 0)))
      {
        continue;
      }
      const auto& p = frame.cloud.points[k];
      const int row = static_cast<int>((half - p.x()) / (2 * half) * side);
      const int column = static_cast<int>((half - p.y()) / (2 * half) * side);
      for (int n = 0; n < (kind == 0 ? 1 : 4); ++n)
      {
        const int y = row + n / 2;
        const int x = column + n % 2;
        if (x >= 0 && y >= 0 && x < side && y < side)
        {
          std::copy_n(colours[kind], 3, &image[static_cast<std::size_t>(3 * (y * side + x))]);
        }
      }
    }
  }
  std::ofstream out(file, std::ios::binary);
  out << "P6\n" << side << ' ' << side << "\n255\n";
  out.write(reinterpret_cast<const char*>(image.data()),
            static_cast<std::streamsize>(image.size()));
  if (!out)
  {
    throw UserError(file + ": cannot be written");
  }
}

/** The returns of a frame of the clip. */
Frame frameOf(const DysegClip::Frame& from, std::size_t number, const Pose& drift)
{
  Frame frame;
  frame.index = number;
  for (std::size_t i = 0; i < from.points.size(); ++i)
  {
    if (isReturn(from.points[i]))
    {
      frame.cloud.points.push_back(from.points[i]);
      frame.cloud.source.push_back(static_cast<std::uint32_t>(i));
    }
  }
  frame.T_odom_vehicle = from.T_world_sensor * drift;
  return frame;
}

/** Number of moving points of an object in one scan, and of those that were found. */
struct ObjectCounts
{
  int points = 0;
  int hits = 0;
};

std::map<std::int32_t, ObjectCounts> count(const Frame& frame,
                                           const DysegClip::Frame& from,
                                           const std::vector<std::uint8_t>& label,
                                           SegmentationCounts& counts)
{
  std::map<std::int32_t, ObjectCounts> by_object;
  for (std::size_t k = 0; k < frame.cloud.size(); ++k)
  {
    const auto i = frame.cloud.source[k];
    const bool predicted = frame.moving_probability[k] > 0.5F;
    if (label[i] == DysegSample::moving_point)
    {
      (predicted ? counts.true_positives : counts.false_negatives) += 1;
      ObjectCounts& object = by_object[from.object[i]];
      object.points += 1;
      object.hits += predicted ? 1 : 0;
    }
    else if (label[i] == DysegSample::static_point)
    {
      counts.false_positives += predicted ? 1 : 0;
      ++counts.static_points;
    }
  }
  return by_object;
}

void addInstances(const std::map<std::int32_t, ObjectCounts>& by_object,
                  const DysegClip& clip,
                  std::size_t f,
                  SegmentedInstances& instances)
{
  const DysegClip::Frame& from = clip.frames[f];
  for (const auto& [id, counts] : by_object)
  {
    if (counts.points < 10)
    {
      continue;
    }
    SegmentedInstance& entry = instances[id];
    const DysegClip::Object& object = from.objects.at(id);
    entry.distance += object.T_sensor_object.translation().norm();
    if (f > 0 && clip.frames[f - 1].objects.count(id) != 0)
    {
      const DysegClip::Frame& before = clip.frames[f - 1];
      entry.speed +=
          ((before.T_world_sensor * before.objects.at(id).T_sensor_object).translation() -
           (from.T_world_sensor * object.T_sensor_object).translation())
              .norm() /
          clip.period;
      ++entry.speeds;
    }
    ++entry.frames;
    entry.points += static_cast<std::uint64_t>(counts.points);
    entry.hits += static_cast<std::uint64_t>(counts.hits);
  }
}
}  // namespace

SegmentationCounts runSegmenter(MovingSegmenter& segmenter,
                                const SegmentationSet& set,
                                const PoseNoise& noise,
                                SegmentedInstances* instances,
                                const std::string& picture)
{
  SegmentationCounts counts;
  RandomDraws draws(11, 1);
  Pose drift = Pose::Identity();
  for (std::size_t f = 0; f < set.clip.frames.size(); ++f)
  {
    const auto& from = set.clip.frames[f];
    const double bearing = draws.uniform(-3.14159, 3.14159);
    drift = drift * poseFromYpr(noise.metres * std::cos(bearing), noise.metres * std::sin(bearing),
                                0, draws.chance(0.5) ? noise.radians : -noise.radians, 0, 0);
    Frame frame = frameOf(from, f, drift);
    const auto start = std::chrono::steady_clock::now();
    const auto start_cpu = std::clock();
    segmenter.segment(frame);
    counts.cpu_ms.push_back(1e3 * static_cast<double>(std::clock() - start_cpu) / CLOCKS_PER_SEC);
    counts.ms.push_back(
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
            .count());
    if (f < set.first)
    {
      continue;
    }
    const auto label = labelsBySpeed(from);
    if (!picture.empty() && f == (set.first + set.clip.frames.size()) / 2)
    {
      writePicture(picture, frame, label);
    }
    const auto by_object = count(frame, from, label, counts);
    if (instances != nullptr)
    {
      addInstances(by_object, set.clip, f, *instances);
    }
  }
  return counts;
}
}  // namespace dyslam
