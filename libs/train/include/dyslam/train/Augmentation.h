// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Angle.h>
#include <dyslam/base/Options.h>
#include <dyslam/train/PairSource.h>
#include <dyslam/train/RandomDraws.h>

#include <string>
#include <vector>

namespace dyslam
{
/** Ini section `[augmentation]` of DyLO's training. */
struct AugmentationOptions : Options
{
  double translation =
      0.12;  //!< standard deviation of T_aug along x; half of it along y, a quarter along z [m]
  /** Standard deviation of T_aug's yaw; a third of it in pitch and roll [rad]. */
  double yaw = 1 * radians_per_degree;
  double mirror = 0.5;          //!< probability that a pair is mirrored
  double turned = 0.2;          //!< probability of a common random heading of both scans
  double range_noise = 0.01;    //!< largest standard deviation of added range noise [m]
  double point_dropout = 0.15;  //!< largest share of points left out
  double beam_dropout = 0.1;    //!< probability of leaving out all but every 2nd or 4th beam
  double bodies = 0.5;          //!< probability of pasted bodies; simulated pairs have none
  int max_bodies = 8;           //!< most bodies pasted into a pair
  double co_moving = 0.4;       //!< share of pasted bodies that move with the ego-vehicle

  void describe(OptionsVisitor& visitor) override;
};

/** Points of one real object, in the frame of the sensor that measured it [m]. */
using Body = std::vector<Eigen::Vector3f>;

/** Instances labelled as moving vehicles (class 252, number in the high half) with at least
 * `min_points`, of every scan in a folder that has a .label beside it. */
[[nodiscard]] std::vector<Body> loadBodies(const std::string& folder, std::size_t min_points);

/** Inserts a body into both scans and removes the points that it occludes. \param T_2_1_body motion
 * of the body's points from the later to the earlier scan */
void pasteBody(const Body& body, const Pose& T_2_1_body, PointLabel label, TrainingPair& pair);

/** Applies all augmentations of the options to a pair. T_aug moves the later scan (the paper's Eq.
 * 12), so the truth becomes T_2_1 T_aug^-1 (Eq. 13 in our direction). */
void augment(const AugmentationOptions& options,
             const std::vector<Body>& bodies,
             RandomDraws& draws,
             TrainingPair& pair);
}  // namespace dyslam
