// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/dyseg/MovingSegmenter.h>

#include <memory>
#include <string>
#include <vector>

namespace dyslam
{
struct NetworkSegmenterOptions : Options
{
  std::string weights = "dyseg";  //!< a file, or the name of weights that come with DySLAM
  int first_gap = 8;              //!< scans back to the one compared with
  int second_gap = 0;             //!< scans back to a second one; not above the first: none
  /** none: the static motion is looked for among all motions, so that no wrong pose can harm it;
   * prediction: around the predicted one, which among vehicles that drive alike tells the world
   * from the traffic; settled: among all motions in a run's first scans, then as `prediction`. */
  std::string guess = "settled";
  std::string combine = "mean";  //!< of the two answers: mean (of log-odds), max
  double threshold = 0.5;        //!< of the network's answer, from which on a point moves
  int min_points = 5;            //!< called moving, in the smallest group that counts
  int iterations = 2;            //!< of the flow update
  int threads = 1;               //!< of the network; more share cores with the other stages

  void describe(OptionsVisitor& visitor) override;
};

/** What the network saw besides the points' probabilities; vehicle frame, current to past scan. */
struct SceneFlow
{
  MotionEstimate static_motion;  //!< of the static world, in the plane, from the two scans alone
  std::size_t past_index = 0;    //!< Frame::index of the scan compared with
  std::vector<Eigen::Vector2f> cell_centre;  //!< [m]
  std::vector<Eigen::Vector2f> cell_flow;    //!< [m]
  std::vector<float> cell_moving_probability;
};

/** DySeg (the paper's section 3.1): moving points by scene flow, from a trained network.
 *
 * Follows the motion of the static world from scan to scan and judges each scan against one some
 * scans back, when slow movers were elsewhere, or against two. Needs no pose: the motion of the
 * static world comes from the scans themselves, and a drifting odometry can't harm it. Where the
 * next motion is predicted well it is looked for around that. The first scan is all static, as are
 * points farther than the network's grid reaches (102 m to each side with the shipped weights).
 */
class NetworkSegmenter : public MovingSegmenter
{
 public:
  /** \throws UserError if the weights are missing or not DySeg's. */
  explicit NetworkSegmenter(const NetworkSegmenterOptions& options);
  ~NetworkSegmenter() override;

  [[nodiscard]] std::string name() const override { return "network"; }
  [[nodiscard]] bool needsPose() const override { return false; }
  void segment(Frame& frame) override;
  [[nodiscard]] const MotionEstimate* staticMotion() const override;
  [[nodiscard]] const std::vector<float>* staticLikelihood() const override;
  void reset() override;

  /** Of the last segment(), to the scan `first_gap` back; null before two scans were compared. */
  [[nodiscard]] const SceneFlow* sceneFlow() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};
}  // namespace dyslam
