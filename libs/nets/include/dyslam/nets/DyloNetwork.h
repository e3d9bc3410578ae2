// SPDX-License-Identifier: BSD-3-Clause
// Includes torch: for nets, train and their tests only.
#pragma once

#include <dyslam/nets/DyloPrior.h>
#include <dyslam/nets/GaussNewton.h>
#include <dyslam/nets/Layers.h>

#include <map>
#include <tuple>
#include <vector>

namespace dyslam
{
/** A scan and its features per level: computed once per scan, used in two pairs. */
struct EncodedScan
{
  ScanTensors scan;
  std::array<torch::Tensor, PreparedScan::level_count> features;  //!< levels 1 and above
  /** Of the nodes of levels 0 and 1 [N]: when each was measured, in shares of T_sweep from the
   * scan's own time. Undefined where a scan is not to be deskewed any further. */
  std::array<torch::Tensor, 2> phase;
  torch::Tensor image_phase;        //!< the same of every image cell
  Pose T_sweep = Pose::Identity();  //!< the motion it was deskewed with
};

/** What one stage found, coarse to fine. */
struct DyloStage
{
  std::size_t level = 0;  //!< of scan 1's points
  bool dense = false;     //!< only the pose (and its normal matrix) are new: see denseStage
  PoseTensors pose;       //!< scan 1 to scan 2, up to and including this stage
  MaskLogits logits;
  torch::Tensor points;  //!< [N, 3] of scan 1, as deskewed for this stage
  torch::Tensor weight;  //!< [N] M, sums to 1
  torch::Tensor valid;   //!< [N] points that found a match
  // Matches found from the pose before this stage (head gauss_newton):
  torch::Tensor normal, offset, target;
  torch::Tensor noise;          //!< deviation of a residual that the mask trusts fully [m]
  torch::Tensor normal_matrix;  //!< [6, 6], of weights that sum to 1
};

/** The LiDAR odometry network: pyramid, attentive cost volume, dynamic mask, pose coarse to fine.
 *
 * Scan 1 is the later one; the pose takes its points to scan 2. One pair at a time.
 */
class DyloNetworkImpl : public torch::nn::Module
{
 public:
  explicit DyloNetworkImpl(const DyloNetworkOptions& options);

  [[nodiscard]] EncodedScan encode(const ScanTensors& scan);

  /** \param start where the search begins. \param prior joins the points in the fine passes; none
   * for null. \returns every stage; the last pose is the answer.
   *
   * Fine passes follow (while gradients are not recorded until a step is short), and a last one,
   * the dense stage, over points of level 0 of both scans with the weights of the one before. In
   * each of them a scan 1 with phases is deskewed by the pose found so far, which is taken for the
   * motion since the scan before. */
  [[nodiscard]] std::vector<DyloStage> forward(const EncodedScan& scan1,
                                               const EncodedScan& scan2,
                                               const PoseTensors& start,
                                               const DyloPrior* prior = nullptr);

  [[nodiscard]] const DyloNetworkOptions& options() const { return options_; }

 private:
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
  /** \param embedding of the points of `level_before`, nothing at stage 0; becomes this stage's. */
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

  /** One more step, over twice the points of a fine stage and as many of scan 2 on the surfaces of
   * scan 1: what draws the ones too short draws the others too far. Each is weighed as the node of
   * level 1 there was, by its residual and by how thick its surface is. */
  [[nodiscard]] DyloStage denseStage(const EncodedScan& scan1,
                                     const EncodedScan& scan2,
                                     const DyloStage& fine,
                                     const DyloPrior* prior);

  DyloNetworkOptions options_;
  std::vector<SetConv> encoder_;
  Mlp first_join_{nullptr};
  AttentiveCostVolume first_cost_{nullptr};
  SetConv cost_down_{nullptr};
  DynamicMask coarsest_mask_{nullptr};
  SetUpConv cost_up_{nullptr};
  std::vector<AttentiveCostVolume> cost_;  //!< at levels 3, 2 and 1
  std::vector<SetUpConv> up_;
  std::vector<Mlp> join_;
  std::vector<DynamicMask> mask_;
  std::vector<Mlp> regression_;
  torch::Tensor isotropic_;  //!< logarithm, per stage
  Mlp fine_embed_{nullptr};
  DynamicMask fine_mask_{nullptr};
  torch::Tensor noise_;  //!< logarithm, per stage; the fine passes share the last
  std::map<std::tuple<std::int64_t, std::int64_t, std::int64_t, std::int64_t, std::int64_t>, Window>
      windows_;
};
TORCH_MODULE(DyloNetwork);
}  // namespace dyslam
