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
/** Tells which points of a frame belong to moving things. */
class MovingSegmenter
{
 public:
  virtual ~MovingSegmenter() = default;

  /** The word that chooses it in the ini ([dyseg] method). */
  [[nodiscard]] virtual std::string name() const = 0;

  /** True if segment() reads Frame::T_odom_vehicle: it then runs after the pose is known, not
   * before. */
  [[nodiscard]] virtual bool needsPose() const = 0;

  /** Fills Frame::moving_probability with one value in [0, 1] per point of Frame::cloud. */
  virtual void segment(Frame& frame) = 0;

  /** The motion of the static world since the scan before, found by the last segment() on its own;
   * null if this segmenter finds none, or could not. */
  [[nodiscard]] virtual const MotionEstimate* staticMotion() const { return nullptr; }

  /** How surely each point of the last segment() stays where it is, by its looks, as long as too
   * little time has passed to see it move; null otherwise. */
  [[nodiscard]] virtual const std::vector<float>* staticLikelihood() const { return nullptr; }

  /** Forget the past scans. */
  virtual void reset() = 0;
};

struct MovingSegmenterOptions : Options
{
  std::string method = "residual";
  bool filter = false;  //!< gather the answers of several scans in the odometry frame
  void describe(OptionsVisitor& visitor) override;
};

/** The words of `method` that makeSegmenter() knows. */
[[nodiscard]] std::vector<std::string> segmenterMethods();

/** The segmenter that [dyseg] of the config names, with the options of its own section; null for
 * `none`. */
[[nodiscard]] std::unique_ptr<MovingSegmenter> makeSegmenter(ConfigLoader& config,
                                                             ThreadPool& pool);
}  // namespace dyslam
