// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Options.h>
#include <dyslam/base/Parallel.h>
#include <dyslam/core/Frame.h>

#include <memory>
#include <string>
#include <vector>

namespace dyslam
{
class StateArchive;

/** A cloud encoded by a segmenter; base class. */
class EncodedCloud
{
 public:
  virtual ~EncodedCloud() = default;
};

/** Finds the points of a frame that belong to moving objects. */
class MovingSegmenter
{
 public:
  virtual ~MovingSegmenter() = default;

  /** Name of the segmenter in the ini ([dyseg] method). */
  [[nodiscard]] virtual std::string name() const = 0;

  /** True if segment() needs the estimated Frame::T_odom_vehicle, not only the predicted one, and
   * therefore runs after the estimation of the pose. */
  [[nodiscard]] virtual bool needsPose() const = 0;

  /** Fills Frame::moving_probability with one value in [0, 1] per point of Frame::cloud, and, if
   * the segmenter estimates them, Frame::segmenter_motion and Frame::static_prior. */
  virtual void segment(Frame& frame) = 0;

  /** Whether the next cloud may be encoded before its motion is predicted: deskewed with an older
   * prediction, while earlier scans are segmented and registered. */
  [[nodiscard]] virtual bool encodesAhead() const { return false; }
  /** The part of segment() that needs only the cloud; null if there is none. May run in another
   * thread during segment().
   * \param T_vehicle_lidar Scan::T_vehicle_lidar of the cloud's scan */
  [[nodiscard]] virtual std::shared_ptr<const EncodedCloud> encode(
      const Cloud& /*cloud*/, const Pose& /*T_vehicle_lidar*/) const
  {
    return nullptr;
  }
  /** segment() with the result of encode() for a cloud with the points of Frame::cloud, maybe
   * deskewed with another motion. */
  virtual void segmentEncoded(Frame& frame, const std::shared_ptr<const EncodedCloud>& /*encoded*/)
  {
    segment(frame);
  }

  /** Saves or loads the state between frames. */
  virtual void exchangeState(StateArchive& archive) = 0;
};

/** Ini section `[dyseg]`. */
struct MovingSegmenterOptions : Options
{
  std::string method = "residual";
  std::string labels;             //!< folder of labels, of an earlier run or given; empty: none
  double moving_threshold = 0.5;  //!< moving probability above which Frame::moving is set
  void describe(OptionsVisitor& visitor) override;
};

/** Names that makeSegmenter() accepts. */
[[nodiscard]] std::vector<std::string> segmenterMethods();

/** Whether the segmenter `method` is in the module `networks`; false for an unknown name. */
[[nodiscard]] bool segmenterNeedsNetworks(const std::string& method);

/** Makes the segmenter `method`, with the options of its own section; null for `none`. The pool
 * must outlive the result. \throws UserError for an unknown name and for bad options. */
[[nodiscard]] std::unique_ptr<MovingSegmenter> makeSegmenter(const std::string& method,
                                                             ConfigLoader& config,
                                                             ThreadPool& pool);
}  // namespace dyslam
