// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/dyseg/MovingSegmenter.h>

#include <memory>
#include <optional>
#include <string>

namespace dyslam
{
/** Ini section `[dyseg_network]`. */
struct NetworkSegmenterOptions : Options
{
  std::string weights = "dyseg";  //!< a file, or the name of weights that come with DySLAM
  int first_gap = 8;              //!< age of the earlier scan that is compared [scans]
  /** Search range of the static motion. global: all motions, independent of any prior; prior:
   * around the prior, where that is reliable, which separates the static world from traffic that
   * moves alike; auto: globally until `first_gap` scans have been seen, then as `prior`. */
  std::string search = "auto";
  double threshold = 0.5;      //!< output of the network that becomes a probability of 0.5
  int min_points = 5;          //!< least number of points in a moving group
  int iterations = 2;          //!< iterations of the flow update
  int threads = 1;             //!< threads of the network
  std::string device = "cpu";  //!< device of the network: cpu or cuda
  /** Encode each scan deskewed by the motion predicted for the scan before, beside the work on that
   * one: faster on three cores and more, with a few more false alarms. */
  bool encode_ahead = false;

  void describe(OptionsVisitor& visitor) override;
};

/** DySeg (the paper's section 3.1): moving points by scene flow, from a trained network.
 *
 * Compares each scan with one some scans back, when slow objects were elsewhere. The static motion
 * between the two is estimated from the scans. The search starts at the static motion from scan to
 * scan, which is estimated too and given as Frame::segmenter_motion; once it is around the prior,
 * at the motion between their Frame::T_odom_vehicle, and Frame::segmenter_motion is left out. Until
 * `first_gap` scans have been seen, Frame::static_prior is given too. The first scan is all static,
 * as are points beyond the network's grid (102 m to each side with the shipped weights).
 *
 * In the library dyslam::dyseg_network; makeSegmenter() loads it with the module `networks`.
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
  /** With `encode_ahead` true once scans `first_gap` apart are compared: until then the motion is
   * not known well. */
  [[nodiscard]] bool encodesAhead() const override;
  [[nodiscard]] std::shared_ptr<const EncodedCloud> encode(
      const Cloud& cloud, const Pose& T_vehicle_lidar) const override;
  void segmentEncoded(Frame& frame, const std::shared_ptr<const EncodedCloud>& encoded) override;
  /** The past scans: their points, which are encoded again when they are loaded. */
  void exchangeState(StateArchive& archive) override;

  /** Motion of the vehicle relative to the static world, in the plane, between the last scan and
   * the one that it was compared with, `first_gap` back, from the two alone. Where they do not show
   * it, the start of the search, not converged. None before two scans were seen. */
  [[nodiscard]] const std::optional<MotionEstimate>& motionToEarlier() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/** dyslam_make_network_segmenter() of the module `networks`; the caller owns the segmenter. */
using MakeNetworkSegmenter = MovingSegmenter*(const NetworkSegmenterOptions&);
}  // namespace dyslam
