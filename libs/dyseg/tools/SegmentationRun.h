// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/dyseg/MovingSegmenter.h>
#include <dyslam/train/DysegData.h>
#include <dyslam/train/DysegScores.h>

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace dyslam
{
/** A clip with ground truth for the evaluation of segmenters. */
struct SegmentationSet
{
  std::string name;
  DysegClip clip;
  std::size_t first = 0;  //!< first evaluated frame; the frames before it are history
};

struct SegmentationCounts : DysegScores
{
  std::uint64_t static_points = 0;
  std::vector<double> ms;      //!< wall time of each scan
  std::vector<double> cpu_ms;  //!< CPU time of each scan, all threads
};

/** Segmentation of one object, summed over frames. */
struct SegmentedInstance
{
  double distance = 0;       //!< from the sensor [m]
  double speed = 0;          //!< over ground since the frame before, where it is in both [m/s]
  int frames = 0;            //!< number of frames in `distance`
  int speeds = 0;            //!< number of frames in `speed`
  std::uint64_t points = 0;  //!< moving points
  std::uint64_t hits = 0;    //!< moving points that were found
};
using SegmentedInstances = std::map<std::int32_t, SegmentedInstance>;

/** Error of each step of the trajectory, in random directions; errors accumulate. */
struct PoseNoise
{
  double metres = 0;
  double radians = 0;
};

/** Runs a segmenter over a set in order, as the pipeline does.
 * \param picture file for a bird's-eye view of the middle scan (PPM, 80 m square, x up: grey
 * static, green true positives, red false negatives, blue false positives); empty for none. */
[[nodiscard]] SegmentationCounts runSegmenter(MovingSegmenter& segmenter,
                                              const SegmentationSet& set,
                                              const PoseNoise& noise = {},
                                              SegmentedInstances* instances = nullptr,
                                              const std::string& picture = {});
}  // namespace dyslam
