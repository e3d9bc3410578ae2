// SPDX-License-Identifier: BSD-3-Clause
// Includes torch: for train and its tests only.
#pragma once

#include <dyslam/nets/DysegNet.h>
#include <dyslam/train/DysegData.h>
#include <dyslam/train/DysegLossOptions.h>

#include <cstdint>
#include <vector>

namespace dyslam
{
/** Ground truth of the occupied cells of a scan at one resolution. */
struct DysegCellTruth
{
  std::vector<Eigen::Vector2f> flow;  //!< current to past [m]; NaN if unknown
  std::vector<std::uint8_t> label;    //!< values as of DysegSample::label
};

/** Truth of cells from the truth of the kept points in them: moving if some points move.
 * \param row_of_point row of each kept point's cell \param places centres of the cells [m] \param
 * ego static motion, current to past */
[[nodiscard]] DysegCellTruth cellTruth(const DysegSample& sample,
                                       const BevScan& scan,
                                       const std::vector<std::int32_t>& row_of_point,
                                       const std::vector<Eigen::Vector2f>& places,
                                       const PlanarMotion& ego);

/** Cross-entropy of correlation windows against the true offset, shared by the four cells around
 * it.
 *
 * Cells whose offset is NaN or outside the window don't count; static and moving cells weigh the
 * same in sum. \param offset N x 2 (x, y) from the window's centre [cells] \param moving N flags.
 */
[[nodiscard]] torch::Tensor correlationLoss(const torch::Tensor& correlation,
                                            const torch::Tensor& offset,
                                            const torch::Tensor& moving,
                                            int radius);

/** Lovasz extension of 1 - IoU of the positive class (Berman et al. 2018), of the sigmoid of the
 * logits. \param weight number of points that each sampled point represents */
[[nodiscard]] torch::Tensor lovaszLoss(const torch::Tensor& logit,
                                       const torch::Tensor& label,
                                       const torch::Tensor& weight);

/** Mean over static values plus mean over moving values, each if there are any. */
[[nodiscard]] torch::Tensor balancedMean(const torch::Tensor& value, const torch::Tensor& moving);

struct DysegLoss
{
  torch::Tensor total;
  double matching = 0;
  double flow = 0;
  double static_probability = 0;
  double cell = 0;
  double point = 0;
};

/** Forward pass of one pair, with all losses. \param grid grid of the crop \param centre centre of
 * the crop, current sensor frame [m] */
[[nodiscard]] DysegLoss dysegLoss(DysegNet& net,
                                  const DysegSample& sample,
                                  const BevOptions& grid,
                                  const Eigen::Vector2f& centre,
                                  const DysegLossOptions& options,
                                  RandomDraws& draws);
}  // namespace dyslam
