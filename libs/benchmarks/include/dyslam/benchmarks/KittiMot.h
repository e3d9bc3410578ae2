// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/benchmarks/KittiTracking.h>
#include <dyslam/eval/Table.h>
#include <dyslam/eval/TrackMetrics.h>
#include <dyslam/tracking/DetectionNoise.h>
#include <dyslam/tracking/Tracker.h>

#include <string>
#include <utility>
#include <vector>

namespace dyslam
{
/** What is tracked, and how the detections are degraded before. */
struct KittiMotSetup
{
  std::string data;        //!< folder with label_02, oxts and calib; times/NNNN.txt where it exists
  std::string detections;  //!< folder of NNNN.txt, or with one such folder for each class
  TrackerOptions tracker;
  DetectionNoiseOptions noise;
  double frame_time = kitti_scan_period;  //!< between scans, of sequences without times [s]
  bool deskew = true;                     //!< boxes are of scans that are not deskewed
  double added_noise = 0;  //!< standard deviation added to x and y of the detections [m]
  int seed = 1;            //!< of that noise
  int every = 1;           //!< only every n-th frame is used and evaluated
};

/** Tracks of several sequences, in the protocol of AB3DMOT's benchmark. */
struct KittiMotRun
{
  std::vector<TrackSequence> sequences;
  int frames = 0;
  double seconds = 0;  //!< spent in Tracker::update()
};

/** One class over the sequences `names` ("0001", ...); ego-motion by OXTS. \throws UserError for
 * files that are missing or cannot be read. */
[[nodiscard]] KittiMotRun runKittiMot(const KittiMotSetup& setup,
                                      const std::vector<std::string>& names,
                                      const std::string& type);

/** The same several times, with the seconds of the fastest. \param repeats at least 1 */
[[nodiscard]] KittiMotRun fastestKittiMot(const KittiMotSetup& setup,
                                          const std::vector<std::string>& names,
                                          const std::string& type,
                                          int repeats);

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
/** \param sequences which they are, for the title: "validation" \param with_published also
 * AB3DMOT's figures, of PointRCNN's detections of the validation sequences and IoU 0.25 */
[[nodiscard]] Table kittiMotTable(const NamedKittiMotScores& classes,
                                  const std::string& sequences,
                                  bool with_published);
[[nodiscard]] std::string kittiMotJson(const NamedKittiMotScores& classes);

/** Writes the estimated tracks of all classes as KITTI's result files `folder`/NNNN.txt, ids made
 * unique. \param runs one for each class, over `names`. \throws UserError. */
void writeKittiMot(const std::string& folder,
                   const std::string& data,
                   const std::vector<std::string>& names,
                   const std::vector<KittiMotRun>& runs);

/** AB3DMOT's validation sequences. */
[[nodiscard]] std::vector<std::string> kittiMotValidation();
/** The other labelled sequences, for parameter selection. */
[[nodiscard]] std::vector<std::string> kittiMotTraining();
}  // namespace dyslam
