// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Statistics.h>
#include <dyslam/nets/DyloNetwork.h>
#include <dyslam/train/Recordings.h>

#include <limits>
#include <string>
#include <vector>

namespace dyslam
{
/** Errors of relative motions between consecutive scans; NaN where an estimate is not finite. */
struct MotionErrors
{
  Statistics translation;    //!< [m]
  Statistics rotation_deg;   //!< [deg]
  double forward_ratio = 0;  //!< sum of the estimated over sum of the true motions along x
};

[[nodiscard]] MotionErrors motionErrors(const std::vector<Pose>& estimates,
                                        const std::vector<Pose>& truths);

struct ValidationRow
{
  std::string recording;
  MotionErrors network;          //!< network, started from zero motion
  MotionErrors predicted_start;  //!< network, started from its estimate of the previous motion
  MotionErrors zero_motion, constant_velocity;  //!< baselines
  std::vector<double> stage_translation_rmse;   //!< RMSE of each stage of `network` [m]
  /** Area under the ROC curve of static confidence, moving against static sampled points; NaN where
   * the recording has no labels of both. */
  double mask_auc = std::numeric_limits<double>::quiet_NaN();
  std::size_t moving_points = 0;
  std::size_t still_points = 0;
  double milliseconds = 0;  //!< mean time to encode one scan and match it [ms]
};

/** Evaluates a network on recordings. \param mask_folder folder for a CSV file per recording with
 * the points of its middle scan; empty: not written */
[[nodiscard]] std::vector<ValidationRow> validateDylo(DyloNetwork& network,
                                                      const std::vector<Recording>& recordings,
                                                      torch::Device device,
                                                      const std::string& mask_folder = {});
[[nodiscard]] std::string validationTable(const std::vector<ValidationRow>& rows);
}  // namespace dyslam
