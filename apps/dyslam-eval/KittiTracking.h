// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/eval/PredictionMetrics.h>
#include <dyslam/eval/TrackMetrics.h>
#include <dyslam/tracking/AdaptivePredictor.h>
#include <dyslam/tracking/PolynomialTrajectory.h>
#include <dyslam/tracking/Tracker.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
/** One object of KITTI's tracking set: where it was (labels) and where it was seen. World frame: x
 * east, y north, by OXTS and calib. */
struct KittiTarget
{
  std::string name;  //!< "10/0"
  GroundPath truth;
  GroundPath sightings;  //!< the labels again, or the detections nearest to them
};

/** \param detections PointRCNN csv, or empty for the labels themselves. Of the detections scored
 * >= 0 the nearest to the label in the ground plane is taken, if within 2 m. \throws UserError. */
[[nodiscard]] KittiTarget readKittiTarget(const std::string& boxes,
                                          const std::string& oxts,
                                          const std::string& calib,
                                          int track,
                                          const std::string& detections);

/** The six targets of the paper's Table 5 from a folder with label_02, oxts, calib, det_pointrcnn.
 */
[[nodiscard]] std::vector<KittiTarget> readPaperTargets(const std::string& folder,
                                                        bool from_detections);

/** A fixed degree and window: predicts once the window is full. */
[[nodiscard]] std::unique_ptr<StepPredictor> polynomialStep(int degree, int window);
/** Through the last two positions. */
[[nodiscard]] std::unique_ptr<StepPredictor> constantVelocityStep();
[[nodiscard]] std::unique_ptr<StepPredictor> adaptiveStep(const AdaptiveOptions& options = {});

/** The tracker over the detections of several sequences, as AB3DMOT's benchmark has it. */
struct KittiMotRun
{
  std::vector<TrackSequence> sequences;
  int frames = 0;
  double seconds = 0;  //!< in Tracker::update() alone
};

/** One class over the sequences `names` ("0001", ...); ego-motion by OXTS. \throws UserError. */
[[nodiscard]] KittiMotRun runKittiMot(const std::string& folder,
                                      const std::vector<std::string>& names,
                                      const std::string& type,
                                      const TrackerOptions& options);

/** AB3DMOT's validation sequences. */
[[nodiscard]] std::vector<std::string> kittiMotValidation();
/** The others for which there are labels: for choosing parameters. */
[[nodiscard]] std::vector<std::string> kittiMotTraining();
}  // namespace dyslam
