// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>
#include <dyslam/core/Options.h>
#include <dyslam/core/Parallel.h>
#include <dyslam/core/Pose.h>

#include <memory>
#include <string>
#include <vector>

namespace dyslam
{
/** Motion between consecutive frames.
 *
 * Reads Frame::cloud, and as weights Frame::moving_probability and Frame::static_confidence where
 * they are as long as the cloud. Not thread-safe; one object per recording.
 */
class LidarOdometry
{
 public:
  virtual ~LidarOdometry() = default;

  /** Motion from the frame of the call before to this one.
   *
   * The first frame yields the identity, converged. A frame that cannot be used (no or too few
   * points, no agreement) yields the prediction, converged = false and a reason; the next frame is
   * then told relative to it all the same, so that the chain of motions never breaks.
   * \param T_previous_current_prediction start value, e.g. the motion before
   * \param information of the prediction, of log(T_predicted^-1 T); zero where it is not known.
   * Methods that say so in joinsPrediction() weigh it against the points */
  virtual MotionEstimate process(const Frame& frame,
                                 const Pose& T_previous_current_prediction,
                                 const Matrix6& information = Matrix6::Zero()) = 0;
  /** Whether a prediction with information is part of what process() finds. The information of the
   * motion it returns still is that of the points alone. */
  [[nodiscard]] virtual bool joinsPrediction() const { return false; }
  /** Of the last frame: one per cloud point in [0, 1], how surely it stands still; empty from
   * methods that do not tell, and where the frame could not be used. */
  [[nodiscard]] virtual const std::vector<float>& staticConfidence() const;
  /** As new: the next frame is a first frame. */
  virtual void reset() = 0;
  [[nodiscard]] virtual std::string name() const = 0;
};

/** Names that makeOdometry() knows. */
[[nodiscard]] std::vector<std::string> odometryMethods();

/** Build a method by its name; its options come from the ini section `[<method>]`.
 * \throws UserError for an unknown name, naming the nearest, and for bad options. The pool must
 * outlive the result. */
[[nodiscard]] std::unique_ptr<LidarOdometry> makeOdometry(const std::string& method,
                                                          ConfigLoader& loader,
                                                          ThreadPool& pool);
}  // namespace dyslam
