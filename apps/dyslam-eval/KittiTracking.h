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
/** One object of KITTI tracking with its true and observed positions. World frame: x east, y north,
 * from OXTS and the calibration. */
struct KittiTarget
{
  std::string name;  //!< "10/0"
  PlanarTrack truth;
  PlanarTrack observations;  //!< the labels, or the detections nearest to them
};

/** \param detections PointRCNN csv, or empty to use the labels. Of the detections with a score of
 * at least 0, the one nearest to the label in the ground plane is used, if within 2 m. \throws
 * UserError for files that cannot be read or a track without boxes. */
[[nodiscard]] KittiTarget readKittiTarget(const std::string& boxes,
                                          const std::string& oxts,
                                          const std::string& calib,
                                          int track,
                                          const std::string& detections);

/** The six targets of the paper's Table 5 from a folder with label_02, oxts, calib, det_pointrcnn.
 */
[[nodiscard]] std::vector<KittiTarget> readPaperTargets(const std::string& folder,
                                                        bool from_detections);

/** Fixed degree and window; predicts only with a full window. */
[[nodiscard]] std::unique_ptr<OneStepPredictor> polynomialPredictor(int degree, int window);
/** Line through the last two positions. */
[[nodiscard]] std::unique_ptr<OneStepPredictor> constantVelocityPredictor();
[[nodiscard]] std::unique_ptr<OneStepPredictor> adaptivePredictor(
    const AdaptiveOptions& options = {});

/** Tracks of several sequences, in the protocol of AB3DMOT's benchmark. */
struct KittiMotRun
{
  std::vector<TrackSequence> sequences;
  int frames = 0;
  double seconds = 0;  //!< spent in Tracker::update()
};

/** One class over the sequences `names` ("0001", ...); ego-motion by OXTS. \throws UserError for
 * files that cannot be read or a track without boxes. */
[[nodiscard]] KittiMotRun runKittiMot(const std::string& folder,
                                      const std::vector<std::string>& names,
                                      const std::string& type,
                                      const TrackerOptions& options);

/** AB3DMOT's validation sequences. */
[[nodiscard]] std::vector<std::string> kittiMotValidation();
/** The other labelled sequences, for parameter selection. */
[[nodiscard]] std::vector<std::string> kittiMotTraining();
}  // namespace dyslam
