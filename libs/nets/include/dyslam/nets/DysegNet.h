// SPDX-License-Identifier: BSD-3-Clause
// Includes torch: for nets, train and their tests only.
#pragma once

#include <dyslam/nets/BevScan.h>
#include <dyslam/nets/CellLayers.h>
#include <dyslam/nets/CellLevels.h>
#include <dyslam/nets/DysegOptions.h>
#include <dyslam/nets/FlowUpdate.h>
#include <dyslam/nets/RigidFlow.h>
#include <torch/nn.h>

#include <cstdint>
#include <memory>
#include <vector>

namespace dyslam
{
/** Occupied cells of a scan and which of them touch, as the network's layers need it. */
struct DysegCells
{
  explicit DysegCells(const BevScan& scan);

  CellLevels level;
  torch::Tensor half_under;      //!< full-resolution rows under each half cell's kernel, N2 x 9
  torch::Tensor half_around;     //!< N2 x 9
  torch::Tensor quarter_under;   //!< rows at half resolution, N4 x 9
  torch::Tensor quarter_around;  //!< N4 x 9
  torch::Tensor eighth_parts;    //!< rows at a quarter, N8 x 4
  torch::Tensor eighth_around;   //!< N8 x 9
  torch::Tensor quarter_parent;  //!< rows at an eighth, N4 x 1
  torch::Tensor half_index;      //!< row of each cell of the map, -1 if empty, H/2 x W/2
  torch::Tensor quarter_index;
  torch::Tensor eighth_index;
  torch::Tensor quarter_position;  //!< N4 x 2 (x, y) [cells]
  torch::Tensor eighth_position;
  std::vector<Eigen::Vector2f> quarter_place;  //!< centres, in the frame of the points [m]
  std::vector<Eigen::Vector2f> eighth_place;

  void to(torch::Device device);
};

/** What the encoder makes of one scan; made once, compared with any other scan. Rows of occupied
 * cells at 1/2 (N2), 1/4 (N4) and 1/8 (N8) of the grid's resolution. */
struct DysegEncoding
{
  std::shared_ptr<const DysegCells> cells;
  torch::Tensor points;   //!< P x pillar_channels, of each kept point
  torch::Tensor context;  //!< N4 x quarter_channels
  torch::Tensor anchor;   //!< N4 logits: looks like something that stays where it is
  torch::Tensor fine;     //!< N2 x fine_channels, for matching
  torch::Tensor middle;   //!< N4 x matching_channels, for matching
  torch::Tensor coarse;   //!< N8 x matching_channels, for matching
};

/** Motions to look around instead of the network's own fits: the truth and its errors in training.
 */
struct DysegGuide
{
  PlanarMotion first;   //!< where the windows at 1/4 lie, in place of the fit at 1/8
  PlanarMotion second;  //!< the static flow, in place of the fit at 1/4
};

/** The motion of the static world between two scans. N occupied cells at 1/4 resolution. */
struct DysegMatch
{
  torch::Tensor coarse_correlation;  //!< N8 x (2r+1)^2, around no motion; undefined with a guess
  torch::Tensor correlation;         //!< N x (2r+1)^2, around `first`
  PlanarMotion first;                //!< static motion (current to past) from 1/8
  RigidFlowFit fit;                  //!< from 1/4; empty with a guide
};

/** What the network says about the cells of the current scan. N occupied cells at 1/4 resolution.
 */
struct DysegCellsOut
{
  PlanarMotion static_motion;           //!< what residual flow is relative to
  std::vector<torch::Tensor> residual;  //!< N x 2 after each update: flow less static flow [m]
  torch::Tensor feature;                //!< N x cell_features, for the points
  torch::Tensor logit;                  //!< N: the cell holds something that moves
  torch::Tensor upsampling;             //!< N x 144 logits for upsampleFlow
};

/** DySeg (the paper's section 3.1): what moves in a scan, from scene flow to an earlier one.
 *
 * Everything is computed for occupied cells only, an eighth to a quarter of the grid.
 * Pillars, a shared encoder, correlation at 1/8 (all motions), 1/4 (around the static flow) and 1/2
 * of the grid (single points); the static flow in closed form, of cells that look like walls and
 * trees rather than like vehicles; recurrent updates of the flow around it; cells, then points,
 * from residual flow, context, correlation and what earlier rays saw.
 */
class DysegNetImpl : public torch::nn::Module
{
 public:
  explicit DysegNetImpl(const DysegNetworkOptions& options);

  [[nodiscard]] DysegEncoding encode(const BevScan& scan);

  /** The static motion from all motions at 1/8, then around it at 1/4. \param guide null at run
   * time. \param guess to look around instead of at all motions; null if there is none. */
  [[nodiscard]] DysegMatch match(const BevScan& scan,
                                 const DysegEncoding& current,
                                 const DysegEncoding& past,
                                 const DysegGuide* guide = nullptr,
                                 const MotionGuess* guess = nullptr);

  /** What does not follow the static motion (current to past). */
  [[nodiscard]] DysegCellsOut cells(const BevScan& scan,
                                    const DysegEncoding& current,
                                    const DysegEncoding& past,
                                    const PlanarMotion& static_motion,
                                    int iterations);

  /** Logits of some points: moving or not. \param which positions in `scan.points`. */
  [[nodiscard]] torch::Tensor points(const BevScan& scan,
                                     const DysegEncoding& current,
                                     const DysegEncoding& past,
                                     const BevRays& past_rays,
                                     const DysegCellsOut& cells,
                                     const std::vector<std::int32_t>& which);

  /** Full-resolution flow less static flow at the fine cells of some points, Q x 2 [m]. */
  [[nodiscard]] torch::Tensor pointFlow(const BevScan& scan,
                                        const DysegEncoding& current,
                                        const DysegCellsOut& cells,
                                        const std::vector<std::int32_t>& which) const;

  [[nodiscard]] const DysegNetworkOptions& options() const { return options_; }

 private:
  /** What lies some metres around each cell at 1/4, as seen at 1/8: the ends of a long vehicle's
   * flank, for one. \return N4 x quarter_channels. */
  [[nodiscard]] torch::Tensor surroundings(const torch::Tensor& quarter, const DysegCells& cells);

  DysegNetworkOptions options_;
  torch::Tensor empty_fine_;  //!< what an empty cell shows to those that look for a match
  torch::Tensor empty_middle_;
  torch::Tensor empty_coarse_;
  RowLinear pillar_{nullptr};
  RowLinear pillar_deep_{nullptr};
  CellConv half_{nullptr};
  CellConv half_deep_{nullptr};
  CellConv quarter_{nullptr};
  CellConv quarter_first_{nullptr};
  CellConv quarter_second_{nullptr};
  CellConv wide_first_{nullptr};
  CellConv wide_second_{nullptr};
  CellConv wide_third_{nullptr};
  RowLinear fine_matching_{nullptr};
  RowLinear matching_{nullptr};
  RowLinear anchor_{nullptr};
  RowLinear anchor_logit_{nullptr};
  RowLinear state_{nullptr};
  FlowUpdate update_{nullptr};
  CellConv segment_{nullptr};
  RowLinear cell_{nullptr};
  RowLinear cell_logit_{nullptr};
  RowLinear upsampling_{nullptr};
  RowLinear point_first_{nullptr};
  RowLinear point_second_{nullptr};
  RowLinear point_logit_{nullptr};
};
TORCH_MODULE(DysegNet);
}  // namespace dyslam
