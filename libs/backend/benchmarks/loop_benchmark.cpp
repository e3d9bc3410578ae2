// SPDX-License-Identifier: BSD-3-Clause
// Processor time of the loop search per keyframe as a run grows, with keyframes at different
// places.
#include <dyslam/backend/LoopCloser.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <random>
#include <utility>

namespace
{
using dyslam::Keyframe;

/** Structure of random height in about half of the cells of a polar grid, on flat ground. */
std::vector<Eigen::Vector3f> randomPlace(std::mt19937& rng)
{
  std::uniform_real_distribution<float> uniform(0, 1);
  std::vector<Eigen::Vector3f> points;
  for (int sector = 0; sector < 60; ++sector)
  {
    for (int ring = 0; ring < 20; ++ring)
    {
      const float azimuth = (static_cast<float>(sector) + 0.5F) * 6.2831853F / 60;
      const float range = 3 * (static_cast<float>(ring) + 0.5F);
      const float height = uniform(rng) < 0.5F ? 0 : 12 * uniform(rng);
      points.emplace_back(range * std::cos(azimuth), range * std::sin(azimuth), height);
    }
  }
  return points;
}
}  // namespace

int main()
{
  std::mt19937 rng(1);
  dyslam::KeyframeStore keyframes;
  dyslam::LoopCloser closer(dyslam::LoopCloserOptions{}, keyframes);
  constexpr std::size_t count = 10000;
  constexpr std::size_t block = 1000;
  double sum_ms = 0;
  double worst_ms = 0;
  std::size_t loops = 0;
  std::printf("keyframes  mean [ms]  worst [ms]  candidates registered\n");
  for (std::size_t i = 0; i < count; ++i)
  {
    Keyframe keyframe;
    keyframe.path_length = 1.5 * static_cast<double>(i);
    keyframe.T_map_vehicle = dyslam::poseFromYpr(keyframe.path_length, 0, 0, 0, 0, 0);
    keyframes.add(keyframe);
    const std::vector<Eigen::Vector3f> points = randomPlace(rng);
    const std::clock_t start = std::clock();
    closer.add(points);
    loops += closer.search().size();
    const double ms = 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    sum_ms += ms;
    worst_ms = std::max(worst_ms, ms);
    if ((i + 1) % block == 0)
    {
      std::printf("%9zu  %9.3f  %10.3f  %zu\n", i + 1, sum_ms / block, worst_ms, loops);
      sum_ms = worst_ms = 0;
      loops = 0;
    }
  }
  return 0;
}
