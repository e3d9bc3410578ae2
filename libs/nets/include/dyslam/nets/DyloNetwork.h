// SPDX-License-Identifier: BSD-3-Clause
// Includes torch: for nets, train and their tests only.
#pragma once

#include <dyslam/nets/DyloPrior.h>
#include <dyslam/nets/GaussNewton.h>
#include <dyslam/nets/Layers.h>

#include <array>
#include <cstdint>
#include <map>
#include <tuple>
#include <vector>

namespace dyslam
{
/** A scan and its features per level; computed once per scan and used in two pairs. */
struct EncodedScan
{
  ScanTensors scan;
  std::array<torch::Tensor, PreparedScan::level_count> features;  //!< levels 1 and above
  /** Acquisition time of the nodes of levels 0 and 1 [N] relative to the scan's stamp, as a
   * fraction of the scan period. Undefined if the scan is not to be deskewed further. */
  std::array<torch::Tensor, 2> phase;
  torch::Tensor image_phase;        //!< acquisition time of each image cell, as `phase`
  Pose T_sweep = Pose::Identity();  //!< motion over a scan period the scan was deskewed with
};

/** Estimate of one stage, coarse to fine. */
struct DyloStage
{
  std::size_t level = 0;  //!< level of scan 1's points
  bool dense = false;     //!< only pose and normal matrix are updated: see denseStage()
  PoseTensors pose;       //!< maps scan 1 to scan 2, including this stage's update
  MaskLogits logits;
  torch::Tensor points;  //!< [N, 3] points of scan 1, as deskewed in this stage [m]
  torch::Tensor weight;  //!< [N] mask weights M, sum 1
  torch::Tensor valid;   //!< [N] 1 for points with a correspondence
  // Correspondences at the pose before this stage (head gauss_newton): planes and points.
  torch::Tensor normal, offset, target;
  torch::Tensor noise;          //!< standard deviation of the residuals of full mask weight [m]
  torch::Tensor normal_matrix;  //!< [6, 6], for weights that sum to 1
};

/** DyLO's LiDAR odometry network (the paper's Figs. 3 and 4, after PWCLO-Net): feature
 * pyramid, attentive cost volume, dynamic mask, pose refinement from coarse to fine.
 *
 * Scan 1 is the later one; the pose maps its points to scan 2. Not thread-safe.
 */
class DyloNetworkImpl : public torch::nn::Module
{
 public:
  explicit DyloNetworkImpl(const DyloNetworkOptions& options);

  [[nodiscard]] EncodedScan encode(const ScanTensors& scan);

  /** \param start initial guess \param prior fused with the points in the fine stages; null for
   * none \return all stages; the last pose is the estimate.
   *
   * Four coarse stages are followed by fine stages (a fixed number while gradients are recorded,
   * else until a step is short) and the dense stage, over points of level 0 of both scans with the
   * weights of the last fine stage. In all of them a scan 1 with phases is deskewed by the current
   * pose, which is taken as the motion over the scan period. */
  [[nodiscard]] std::vector<DyloStage> forward(const EncodedScan& scan1,
                                               const EncodedScan& scan2,
                                               const PoseTensors& start,
                                               const DyloPrior* prior = nullptr);

  [[nodiscard]] const DyloNetworkOptions& options() const { return options_; }

 private:
  /** Registers the layers of a coarse stage, in the order of the optimizer's states in checkpoints.
   * \param embedding, hidden numbers of channels */
  void addCoarseStage(std::size_t stage, std::int64_t embedding, std::int64_t hidden);
  /** Windows between two levels of a scan, kept from call to call; see windowBetween(). */
  [[nodiscard]] const Window& window(std::size_t from,
                                     std::size_t to,
                                     const EncodedScan& scan,
                                     std::int64_t rows,
                                     std::int64_t cols);
  [[nodiscard]] DyloStage poseStage(std::size_t stage,
                                    std::size_t level,
                                    const PoseTensors& start,
                                    const torch::Tensor& warped,
                                    const Correlation& correlation,
                                    const MaskLogits& logits,
                                    const torch::Tensor& embedding);
  /** \param[in,out] embedding features of the nodes of `level_before`, undefined at stage 0; set to
   * the features of this stage */
  [[nodiscard]] DyloStage coarseStage(std::size_t stage,
                                      const EncodedScan& scan1,
                                      const EncodedScan& scan2,
                                      const PoseTensors& start,
                                      std::size_t level_before,
                                      torch::Tensor& embedding);
  [[nodiscard]] DyloStage fineStage(const EncodedScan& scan1,
                                    const EncodedScan& scan2,
                                    const PoseTensors& start,
                                    const torch::Tensor& embedding,
                                    const DyloPrior* prior);

  /** One more Gauss-Newton step over more points, of scan 1 on surfaces of scan 2 and of scan 2 on
   * surfaces of scan 1: the biases of the two directions cancel. A point's weight is that of its
   * node of level 1, reduced by its residual and by the thickness of its surface. */
  [[nodiscard]] DyloStage denseStage(const EncodedScan& scan1,
                                     const EncodedScan& scan2,
                                     const DyloStage& fine,
                                     const DyloPrior* prior);

  DyloNetworkOptions options_;
  std::vector<SetConv> encoder_;
  Mlp first_fusion_{nullptr};
  AttentiveCostVolume first_cost_{nullptr};
  SetConv cost_down_{nullptr};
  DynamicMask coarsest_mask_{nullptr};
  SetUpConv cost_up_{nullptr};
  std::vector<AttentiveCostVolume> cost_;  //!< cost volumes at levels 3, 2 and 1
  std::vector<SetUpConv> up_;
  std::vector<Mlp> fusion_;
  std::vector<DynamicMask> mask_;
  std::vector<Mlp> regression_;
  torch::Tensor isotropic_;  //!< per stage: log weight of the point-to-point term
  Mlp fine_embed_{nullptr};
  DynamicMask fine_mask_{nullptr};
  torch::Tensor noise_;  //!< per stage: log of DyloStage::noise; the fine stages share the last
  std::map<std::tuple<std::int64_t, std::int64_t, std::int64_t, std::int64_t, std::int64_t>, Window>
      windows_;
};
TORCH_MODULE(DyloNetwork);
}  // namespace dyslam
