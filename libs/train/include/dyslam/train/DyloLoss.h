// SPDX-License-Identifier: BSD-3-Clause
// Includes torch: for train and its tests only.
#pragma once

#include <dyslam/base/Options.h>
#include <dyslam/nets/DyloNetwork.h>

#include <vector>

namespace dyslam
{
/** Ini section `[loss]` of DyLO's training. */
struct DyloLossOptions : Options
{
  double flow = 0.2;      //!< weight of the error of the soft correspondences
  double precision = 1;   //!< weight of the negative log-likelihood of the residuals
  double moving = 0.3;    //!< weight of the cross-entropy of moving labels
  double final_pose = 0;  //!< weight of the log error of the pose of the last, dense pass

  void describe(OptionsVisitor& visitor) override;
};

/** Loss with learned weights s_x, s_q: per stage ||t - t*|| e^-s_x + s_x + ||q - q*|| e^-s_q + s_q,
 * levels weighted 1.6, 0.8, 0.4, 0.2 coarse to fine as in PWCLO-Net, further stages 0.2 each, and
 * point-wise terms: flow, residual likelihood, moving labels. The term of the dense pass, whose
 * pose is the network's output, is log(||t - t*|| + 5 mm) + log(||q - q*|| + 0.0002): relative
 * errors count, of a pair accurate to centimetres as much as of one that diverged. */
class DyloLossImpl : public torch::nn::Module
{
 public:
  explicit DyloLossImpl(const DyloLossOptions& options);

  [[nodiscard]] const DyloLossOptions& options() const { return options_; }

  struct Terms
  {
    torch::Tensor total, pose, flow, precision, moving, final_pose;
    std::vector<double> translation_error;  //!< per stage [m]
  };
  /** \param labels [level] 0 unknown, 1 static, 2 moving per node of scan 1; levels 1 to 3 are
   * read.
   */
  Terms forward(const std::vector<DyloStage>& stages,
                const ScanTensors& scan1,
                const PoseTensors& truth,
                const std::vector<torch::Tensor>& labels);

 private:
  DyloLossOptions options_;
  torch::Tensor s_x_, s_q_;  //!< learned weights of translation and rotation, per stage
};
TORCH_MODULE(DyloLoss);
}  // namespace dyslam
