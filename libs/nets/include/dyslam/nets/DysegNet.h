// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/nets/BevScan.h>
#include <dyslam/nets/DysegOptions.h>
#include <dyslam/nets/FlowUpdate.h>
#include <dyslam/nets/RigidFlow.h>
#include <torch/nn.h>

#include <cstdint>
#include <vector>

namespace dyslam
{
/** What the encoder makes of one scan; made once, compared with any other scan. */
struct DysegEncoding
{
  torch::Tensor points;   //!< P x pillar_channels, of each kept point
  torch::Tensor context;  //!< 1 x quarter_channels x H/4 x W/4
  torch::Tensor fine;     //!< H/2 x W/2 x fine_channels, for matching
  torch::Tensor middle;   //!< H/4 x W/4 x matching_channels, for matching
  torch::Tensor coarse;   //!< H/8 x W/8 x matching_channels, for matching
};

/** Occupied cells of a scan at 1/4 and 1/8 of its grid's resolution. */
struct DysegCells
{
  explicit DysegCells(const BevScan& scan);

  torch::Tensor quarter;                       //!< N numbers (int64) y * (cells/4) + x
  std::vector<std::int32_t> row_of_point;      //!< row of `quarter` for each kept point
  std::vector<Eigen::Vector2f> quarter_place;  //!< centres, in the frame of the points [m]
  torch::Tensor eighth;                        //!< as above, for 1/8
  std::vector<Eigen::Vector2f> eighth_place;
};

/** Motions to look around instead of the network's own fits: the truth and its errors in training.
 */
struct DysegGuide
{
  PlanarMotion first;   //!< where the windows at 1/4 lie, in place of the fit at 1/8
  PlanarMotion second;  //!< the static flow, in place of the fit at 1/4
};

/** What the network says about the cells of the current scan. N occupied cells at 1/4 resolution.
 */
struct DysegCellsOut
{
  torch::Tensor coarse_correlation;     //!< N8 x (2r+1)^2, around no motion
  torch::Tensor correlation;            //!< N x (2r+1)^2, around `first`
  PlanarMotion first;                   //!< static motion (current to past) from 1/8
  RigidFlowFit fit;                     //!< from 1/4
  PlanarMotion static_motion;           //!< what residual flow is relative to
  std::vector<torch::Tensor> residual;  //!< N x 2 after each update: flow less static flow [m]
  torch::Tensor feature;                //!< N x cell_features, for the points
  torch::Tensor logit;                  //!< N: the cell holds something that moves
  torch::Tensor upsampling;             //!< N x 144 logits for upsampleFlow
};

/** DySeg (the paper's section 3.1): what moves in a scan, from scene flow to an earlier one.
 *
 * Pillars, a shared encoder, correlation at 1/8 (all motions), 1/4 (around the static flow) and 1/2
 * of the grid (single points); the static flow in closed form; recurrent updates of the flow around
 * it; cells, then points, from residual flow, context, correlation and what earlier rays saw.
 */
class DysegNetImpl : public torch::nn::Module
{
 public:
  explicit DysegNetImpl(const DysegNetworkOptions& options);

  [[nodiscard]] DysegEncoding encode(const BevScan& scan);

  /** \param guide null at run time. \param guess of the static motion, to look around instead of
   * at all motions; null if there is none. */
  [[nodiscard]] DysegCellsOut cells(const BevScan& scan,
                                    const DysegCells& occupied,
                                    const DysegEncoding& current,
                                    const DysegEncoding& past,
                                    int iterations,
                                    const DysegGuide* guide = nullptr,
                                    const PlanarMotion* guess = nullptr);

  /** Logits of some points: moving or not. \param which positions in `scan.points`. */
  [[nodiscard]] torch::Tensor points(const BevScan& scan,
                                     const DysegCells& occupied,
                                     const DysegEncoding& current,
                                     const DysegEncoding& past,
                                     const BevRays& past_rays,
                                     const DysegCellsOut& cells,
                                     const std::vector<std::int32_t>& which);

  /** Full-resolution flow less static flow at the fine cells of some points, Q x 2 [m]. */
  [[nodiscard]] torch::Tensor pointFlow(const BevScan& scan,
                                        const DysegCells& occupied,
                                        const DysegCellsOut& cells,
                                        const std::vector<std::int32_t>& which) const;

  [[nodiscard]] const DysegNetworkOptions& options() const { return options_; }

 private:
  DysegNetworkOptions options_;
  torch::nn::Linear pillar_{nullptr};
  torch::nn::Linear pillar_deep_{nullptr};
  torch::nn::Conv2d half_{nullptr};
  torch::nn::Conv2d half_deep_{nullptr};
  torch::nn::Conv2d quarter_{nullptr};
  torch::nn::Conv2d quarter_first_{nullptr};
  torch::nn::Conv2d quarter_second_{nullptr};
  torch::nn::Linear fine_matching_{nullptr};
  torch::nn::Linear matching_{nullptr};
  torch::nn::Linear state_{nullptr};
  FlowUpdate update_{nullptr};
  torch::nn::Conv2d segment_{nullptr};
  torch::nn::Linear cell_{nullptr};
  torch::nn::Linear cell_logit_{nullptr};
  torch::nn::Linear upsampling_{nullptr};
  torch::nn::Linear point_first_{nullptr};
  torch::nn::Linear point_second_{nullptr};
  torch::nn::Linear point_logit_{nullptr};
};
TORCH_MODULE(DysegNet);
}  // namespace dyslam
