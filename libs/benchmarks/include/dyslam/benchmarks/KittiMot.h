// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/benchmarks/KittiTracking.h>
#include <dyslam/eval/Table.h>
#include <dyslam/eval/TrackMetrics.h>
#include <dyslam/tracking/DetectionNoise.h>
#include <dyslam/tracking/Tracker.h>

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace dyslam
{
/** Input data of a tracking benchmark, and how its detections are degraded. */
struct KittiMotSetup
{
  std::string data;        //!< folder with label_02, oxts and calib; times/NNNN.txt where it exists
  std::string detections;  //!< folder of NNNN.txt files, or with one such folder per class
  TrackerOptions tracker;
  DetectionNoiseOptions noise;
  double frame_time = kitti_scan_period;  //!< time between scans of sequences without times [s]
  bool deskew = true;      //!< correct the boxes, which are from scans that are not deskewed
  double added_noise = 0;  //!< standard deviation added to x and y of the detections [m]
  int seed = 1;            //!< seed of `added_noise`
  int every = 1;           //!< only every n-th frame is used and evaluated
};

/** Tracks of several sequences, in the protocol of AB3DMOT's benchmark. */
struct KittiMotRun
{
  std::vector<TrackSequence> sequences;
  int every = 1;  //!< frame f of `sequences` is frame `every` * f of the data
  int frames = 0;
  double seconds = 0;  //!< time spent in Tracker::update() [s]
  std::size_t detections = 0;
  double highest_score = 0;  //!< of the detections
};

/** Tracks one class in several sequences; the ego-motion is that of OXTS. \param names of the
 * sequences ("0001", ...) \param type KITTI's name of the class \throws UserError for files that
 * are missing or cannot be read. */
[[nodiscard]] KittiMotRun runKittiMot(const KittiMotSetup& setup,
                                      const std::vector<std::string>& names,
                                      const std::string& type);

/** runKittiMot() several times; `seconds` is that of the fastest run. \param repeats at least 1 */
[[nodiscard]] KittiMotRun fastestKittiMot(const KittiMotSetup& setup,
                                          const std::vector<std::string>& names,
                                          const std::string& type,
                                          int repeats);

/** Why a class has no tracks, for the console: no detections, or none whose score starts a track.
 * Empty otherwise. \param type as for runKittiMot() */
[[nodiscard]] std::string kittiMotWarning(const KittiMotSetup& setup,
                                          const KittiMotRun& run,
                                          const std::string& type);

/** Scores of one class. */
struct KittiMotScores
{
  RecallAverages averages;
  Hota higher_order;  //!< at the threshold of the best MOTA
  int frames = 0;
  double frames_per_second = 0;
};
[[nodiscard]] KittiMotScores kittiMotScores(const KittiMotRun& run, const TrackRules& rules);

/** Classes and their scores. */
using NamedKittiMotScores = std::vector<std::pair<std::string, KittiMotScores>>;
/** \param sequences name of the set of sequences for the title, such as "validation" \param
 * with_published adds AB3DMOT's published figures (PointRCNN's detections, validation sequences,
 * IoU 0.25) */
[[nodiscard]] Table kittiMotTable(const NamedKittiMotScores& classes,
                                  const std::string& sequences,
                                  bool with_published);
[[nodiscard]] std::string kittiMotJson(const NamedKittiMotScores& classes);

/** Writes the estimated tracks of all classes as KITTI's result files `folder`/NNNN.txt, ids made
 * unique, frames numbered as in the data. \param runs one for each class, over `names`. \throws
 * UserError. */
void writeKittiMot(const std::string& folder,
                   const std::string& data,
                   const std::vector<std::string>& names,
                   const std::vector<KittiMotRun>& runs);

/** AB3DMOT's validation sequences. */
[[nodiscard]] std::vector<std::string> kittiMotValidation();
/** The other labelled sequences, for parameter selection. */
[[nodiscard]] std::vector<std::string> kittiMotTraining();
}  // namespace dyslam
