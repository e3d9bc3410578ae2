// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/eval/PredictionMetrics.h>
#include <dyslam/formats/KittiFiles.h>
#include <dyslam/tracking/AdaptivePredictor.h>
#include <dyslam/tracking/PolynomialTrajectory.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
/** Mean time between the scans of KITTI's lidar, which is that of a revolution [s]; for data
 * without time stamps. */
constexpr double kitti_scan_period = 0.1036;

/** One object of KITTI tracking with its true and observed positions. World frame: x east, y north,
 * from OXTS and the calibration. */
struct KittiTarget
{
  std::string name;  //!< "10/0"
  PlanarTrack truth;
  PlanarTrack observations;  //!< the labels, or the detections nearest to them
};

/** T_world_velo of each frame, from an OXTS file. World: x east, y north, z up, origin at the
 * first position. \throws UserError. */
[[nodiscard]] std::vector<Pose> kittiLidarPoses(const std::string& oxts, const KittiCalib& calib);

/** Reads a target. \param track id of its label \param detections file in any layout of
 * readDetections(), or empty to use the labels. Of the detections with a score of at least 0, the
 * one nearest to the label in the ground plane is used, if within 2 m. \throws UserError for files
 * that cannot be read or a track without boxes. */
[[nodiscard]] KittiTarget readKittiTarget(const std::string& boxes,
                                          const std::string& oxts,
                                          const std::string& calib,
                                          int track,
                                          const std::string& detections);

/** The six targets of the paper's Table 5 from a folder with label_02, oxts, calib, det_pointrcnn.
 */
[[nodiscard]] std::vector<KittiTarget> readPaperTargets(const std::string& folder,
                                                        bool from_detections);

/** Polynomial of fixed degree and window; predicts only with a full window. */
[[nodiscard]] std::unique_ptr<OneStepPredictor> polynomialPredictor(int degree, int window);
/** Constant velocity: line through the last two positions. */
[[nodiscard]] std::unique_ptr<OneStepPredictor> constantVelocityPredictor();
[[nodiscard]] std::unique_ptr<OneStepPredictor> adaptivePredictor(
    const AdaptiveOptions& options = {});
}  // namespace dyslam
