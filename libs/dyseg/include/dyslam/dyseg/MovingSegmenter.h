// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>
#include <dyslam/core/Options.h>
#include <dyslam/core/Parallel.h>

#include <memory>
#include <string>
#include <vector>

namespace dyslam
{
class StateArchive;

/** A cloud as a segmenter has encoded it. */
class EncodedCloud
{
 public:
  virtual ~EncodedCloud() = default;
};

/** Finds the points of a frame that belong to moving things. */
class MovingSegmenter
{
 public:
  virtual ~MovingSegmenter() = default;

  /** The word that chooses it in the ini ([dyseg] method). */
  [[nodiscard]] virtual std::string name() const = 0;

  /** True if segment() needs the estimated Frame::T_odom_vehicle, not only the predicted one: it
   * then runs after the estimation, not before. */
  [[nodiscard]] virtual bool needsPose() const = 0;

  /** Fills Frame::moving_probability with one value in [0, 1] per point of Frame::cloud, and, where
   * it has them, Frame::segmenter_motion and Frame::static_prior. */
  virtual void segment(Frame& frame) = 0;

  /** Whether the next cloud may be encoded before the motion up to it is predicted: deskewed by an
   * older prediction, while the scans before it are segmented and registered. */
  [[nodiscard]] virtual bool encodesAhead() const { return false; }
  /** The part of segment() that needs nothing but the cloud; null if there is none. May run in
   * another thread beside segment().
   * \param T_vehicle_lidar Scan::T_vehicle_lidar of the cloud's scan */
  [[nodiscard]] virtual std::shared_ptr<const EncodedCloud> encode(
      const Cloud& /*cloud*/, const Pose& /*T_vehicle_lidar*/) const
  {
    return nullptr;
  }
  /** segment() with the result of encode(), whose cloud has the points of Frame::cloud, perhaps
   * deskewed by another motion. */
  virtual void segmentEncoded(Frame& frame, const std::shared_ptr<const EncodedCloud>& /*encoded*/)
  {
    segment(frame);
  }

  /** What is kept from frame to frame. */
  virtual void exchangeState(StateArchive& archive) = 0;
};

/** Ini section `[dyseg]`. */
struct MovingSegmenterOptions : Options
{
  std::string method = "residual";
  std::string labels;             //!< folder of an earlier run's labels; empty: none
  double moving_threshold = 0.5;  //!< points with a higher probability are moving: Frame::moving
  void describe(OptionsVisitor& visitor) override;
};

/** The words of `method` that makeSegmenter() knows. */
[[nodiscard]] std::vector<std::string> segmenterMethods();

/** The segmenter of that name, with the options of its own section; null for `none`. \throws
 * UserError for an unknown name and for bad options. The pool must outlive the result. */
[[nodiscard]] std::unique_ptr<MovingSegmenter> makeSegmenter(const std::string& method,
                                                             ConfigLoader& config,
                                                             ThreadPool& pool);

/** Decides which points move, for all later stages: fills Frame::moving with one value per cloud
 * point, from Frame::moving_probability. Nothing moves where there are no probabilities. */
void decideMoving(Frame& frame, double moving_threshold);
}  // namespace dyslam
