// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/dyseg/MovingSegmenter.h>
#include <dyslam/dyseg/TemporalFilter.h>
#include <dyslam/train/DysegData.h>
#include <dyslam/train/DysegScores.h>

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace dyslam
{
/** A clip with truth, on which segmenters are judged. */
struct SegmentationSet
{
  std::string name;
  DysegClip clip;
  std::size_t first = 0;  //!< first frame that is judged; those before are history
};

struct SegmentationCounts : DysegScores
{
  std::uint64_t still = 0;     //!< static points
  std::vector<double> ms;      //!< of each scan
  std::vector<double> cpu_ms;  //!< processor time of all threads
};

/** What was found of one object, summed over frames. */
struct SegmentedInstance
{
  double distance = 0;
  double speed = 0;
  int frames = 0;
  std::uint64_t points = 0;
  std::uint64_t hits = 0;
};
using SegmentedInstances = std::map<std::int32_t, SegmentedInstance>;

/** How far each step of the trajectory is off, in random directions; errors add up. */
struct PoseNoise
{
  double metres = 0;
  double radians = 0;
};

/** Runs a segmenter over a set in order, as the pipeline does.
 * \param picture file for the middle scan from above (PPM, 80 m square, x up: grey static, green
 * found movers, red missed ones, blue false alarms); empty for none \param filter runs behind the
 * segmenter, if given */
[[nodiscard]] SegmentationCounts runSegmenter(MovingSegmenter& segmenter,
                                              const SegmentationSet& set,
                                              const PoseNoise& noise = {},
                                              SegmentedInstances* instances = nullptr,
                                              const std::string& picture = {},
                                              TemporalFilter* filter = nullptr);
}  // namespace dyslam
