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
  std::string weights = "dyseg_simulated";  //!< file, or name of weights shipped with DySLAM
  int first_gap = 8;                        //!< age of the earlier scan for the comparison [scans]
  /** Search range of the static motion. global: all motions, independent of any prior; prior:
   * around the motion prior, if it is reliable, which separates the static world from uniformly
   * moving traffic; auto: global until `first_gap` scans have been seen, then as `prior`. */
  std::string search = "auto";
  double threshold = 0.5;      //!< network output that is mapped to a probability of 0.5
  int min_points = 5;          //!< least number of points in a moving group
  int iterations = 2;          //!< iterations of the flow update
  int threads = 0;             //!< threads of the network; 0: those of the stages
  std::string device = "cpu";  //!< device of the network: cpu or cuda
  /** Encode each scan, deskewed with the motion predicted for the previous scan, while that one is
   * processed: faster with three or more cores, a few more false alarms. */
  bool encode_ahead = false;

  void describe(OptionsVisitor& visitor) override;
};

/** DySeg (the paper's section 3.1): moving points by scene flow, from a trained network.
 *
 * Compares each scan with one some scans back, when slow objects were elsewhere. The static motion
 * between the two is estimated from the scans. A global search starts at the static motion from
 * scan to scan, which is also estimated and set as Frame::segmenter_motion. A search around the
 * prior starts at the motion between the two Frame::T_odom_vehicle, and Frame::segmenter_motion is
 * not set. Until `first_gap` scans have been seen, Frame::static_prior is set, too. All points of
 * the first scan are static, and points beyond the network's grid (102 m to each side with the
 * shipped weights).
 *
 * In the library dyslam::dyseg_network; makeSegmenter() loads it with the module `networks`.
 */
class NetworkSegmenter : public MovingSegmenter
{
 public:
  /** \throws UserError if the weights are missing or are not those of DySeg. */
  explicit NetworkSegmenter(const NetworkSegmenterOptions& options);
  ~NetworkSegmenter() override;

  [[nodiscard]] std::string name() const override { return "network"; }
  [[nodiscard]] bool needsPose() const override { return false; }
  void segment(Frame& frame) override;
  /** With `encode_ahead`, true as soon as scans `first_gap` apart are compared; before, the motion
   * is not accurate enough. */
  [[nodiscard]] bool encodesAhead() const override;
  [[nodiscard]] std::shared_ptr<const EncodedCloud> encode(
      const Cloud& cloud, const Pose& T_vehicle_lidar) const override;
  void segmentEncoded(Frame& frame, const std::shared_ptr<const EncodedCloud>& encoded) override;
  /** Saves or loads the points of past scans, which are encoded again after loading. */
  void exchangeState(StateArchive& archive) override;

  /** Planar motion of the vehicle relative to the static world between the last scan and the scan
   * that it was compared with, `first_gap` scans back, from these two only. If they do not
   * determine it: the start of the search, not converged. Nothing before the second scan. */
  [[nodiscard]] const std::optional<MotionEstimate>& motionToEarlier() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/** dyslam_make_network_segmenter() of the module `networks`; the caller owns the segmenter. */
using MakeNetworkSegmenter = MovingSegmenter*(const NetworkSegmenterOptions&);
}  // namespace dyslam
