// SPDX-License-Identifier: BSD-3-Clause
// Includes torch: for nets, train and their tests only.
#pragma once

#include <dyslam/nets/BevScan.h>
#include <dyslam/nets/CellLayers.h>
#include <dyslam/nets/CellPyramid.h>
#include <dyslam/nets/DysegOptions.h>
#include <dyslam/nets/FlowUpdate.h>
#include <dyslam/nets/RigidFlow.h>
#include <torch/nn.h>

#include <cstdint>
#include <memory>
#include <vector>

namespace dyslam
{
/** Occupied cells of a scan with the index tables of the sparse layers. */
struct DysegCells
{
  explicit DysegCells(const BevScan& scan);

  CellPyramid level;
  torch::Tensor half_from_full;      //!< N2 x 9: full-resolution rows under each kernel at 1/2
  torch::Tensor half_neighbours;     //!< N2 x 9: rows at 1/2 of the 3 x 3 cells around each
  torch::Tensor quarter_from_half;   //!< N4 x 9: rows at 1/2 under each kernel at 1/4
  torch::Tensor quarter_neighbours;  //!< N4 x 9: rows at 1/4 of the 3 x 3 cells around each
  torch::Tensor eighth_children;     //!< N8 x 4: rows at 1/4 of the children of each cell
  torch::Tensor eighth_neighbours;   //!< N8 x 9: rows at 1/8 of the 3 x 3 cells around each
  torch::Tensor quarter_parent;      //!< N4 x 1: row at 1/8 of the parent of each cell
  torch::Tensor half_index;          //!< H/2 x W/2: row of each cell, -1 if empty
  torch::Tensor quarter_index;       //!< H/4 x W/4: row of each cell, -1 if empty
  torch::Tensor eighth_index;        //!< H/8 x W/8: row of each cell, -1 if empty
  torch::Tensor quarter_position;    //!< N4 x 2: position (x, y) of each cell [cells]
  torch::Tensor eighth_position;     //!< N8 x 2: position (x, y) of each cell [cells]
  std::vector<Eigen::Vector2f> quarter_centre;  //!< N4 cell centres, frame of the points [m]
  std::vector<Eigen::Vector2f> eighth_centre;   //!< N8 cell centres, frame of the points [m]

  void to(torch::Device device);
};

/** Encoder output of one scan, computed once and compared with any other scan. Rows of occupied
 * cells at 1/2 (N2), 1/4 (N4) and 1/8 (N8) of the grid's resolution. */
struct DysegEncoding
{
  std::shared_ptr<const DysegCells> cells;
  torch::Tensor points;        //!< P x pillar_channels, point features
  torch::Tensor context;       //!< N4 x quarter_channels
  torch::Tensor static_logit;  //!< N4 logits of the appearance prior (static class)
  torch::Tensor fine;          //!< N2 x fine_channels, matching features
  torch::Tensor middle;        //!< N4 x matching_channels, matching features
  torch::Tensor coarse;        //!< N8 x matching_channels, matching features
};

/** Teacher forcing: motions that replace the network's own estimates in training (truth with added
 * errors).
 */
struct TeacherMotions
{
  PlanarMotion
      coarse;         //!< motion at the centre of the windows at 1/4, replaces the estimate at 1/8
  PlanarMotion fine;  //!< static motion, replaces the estimate at 1/4
};

/** Ego-motion between two scans. N occupied cells at 1/4 resolution. */
struct DysegMatch
{
  torch::Tensor coarse_correlation;  //!< N8 x (2r+1)^2, around zero motion; undefined with a prior
  torch::Tensor correlation;         //!< N x (2r+1)^2, around `initial`; with teacher forcing only
  PlanarMotion initial;  //!< initial static motion (current to past): prior, or estimate at 1/8
  RigidFlowFit fit;      //!< estimate at 1/4; empty with teacher forcing
};

/** Network output for the cells of the current scan. N occupied cells at 1/4 resolution.
 */
struct DysegCellOutput
{
  PlanarMotion static_motion;           //!< motion that the residual flow is relative to
  std::vector<torch::Tensor> residual;  //!< N x 2 after each update: flow minus static flow [m]
  torch::Tensor feature;                //!< N x cell_features, input of the point head
  torch::Tensor logit;                  //!< N: logit that the cell contains moving points
  torch::Tensor upsampling;             //!< N x 144 logits for upsampleFlow
};

/** DySeg (the paper's section 3.1): moving object segmentation from scene flow to an earlier scan.
 *
 * All layers are sparse: only occupied cells are computed. Pillar features and a shared encoder;
 * correlation at 1/8 (all motions), 1/4 (around the static flow) and 1/2 of the grid (single
 * points); the static flow in closed form, from cells weighted by the appearance prior; recurrent
 * updates (RAFT) of the residual flow; moving logits of cells, then of points, from residual flow,
 * context, correlation and visibility in the earlier scan.
 */
class DysegNetImpl : public torch::nn::Module
{
 public:
  explicit DysegNetImpl(const DysegNetworkOptions& options);

  [[nodiscard]] DysegEncoding encode(const BevScan& scan);

  /** Static motion: search over all motions at 1/8, then refinement at 1/4. \param guide teacher
   * forcing in training, else null \param guess replaces the search; null for none. */
  [[nodiscard]] DysegMatch match(const BevScan& scan,
                                 const DysegEncoding& current,
                                 const DysegEncoding& past,
                                 const TeacherMotions* guide = nullptr,
                                 const PlanarPrior* guess = nullptr);

  /** Residual flow and moving logits of the cells, given the static motion (current to past). */
  [[nodiscard]] DysegCellOutput segmentCells(const BevScan& scan,
                                             const DysegEncoding& current,
                                             const DysegEncoding& past,
                                             const PlanarMotion& static_motion,
                                             int iterations);

  /** Moving logits of some points, Q. \param indices into `scan.points`. */
  [[nodiscard]] torch::Tensor segmentPoints(const BevScan& scan,
                                            const DysegEncoding& current,
                                            const DysegEncoding& past,
                                            const BevRays& past_rays,
                                            const DysegCellOutput& cells,
                                            const std::vector<std::int32_t>& indices);

  /** Upsampled residual flow at the full-resolution cells of some points, Q x 2 [m]. */
  [[nodiscard]] torch::Tensor pointFlow(const BevScan& scan,
                                        const DysegEncoding& current,
                                        const DysegCellOutput& cells,
                                        const std::vector<std::int32_t>& indices) const;

  [[nodiscard]] const DysegNetworkOptions& options() const { return options_; }

 private:
  /** Context at 1/8 for each cell at 1/4, for objects larger than the receptive field at 1/4.
   * \return N4 x quarter_channels. */
  [[nodiscard]] torch::Tensor surroundings(const torch::Tensor& quarter, const DysegCells& cells);

  DysegNetworkOptions options_;
  torch::Tensor empty_fine_;    //!< learned matching feature of empty cells at 1/2
  torch::Tensor empty_middle_;  //!< learned matching feature of empty cells at 1/4
  torch::Tensor empty_coarse_;  //!< learned matching feature of empty cells at 1/8
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
  RowLinear static_hidden_{nullptr};
  RowLinear static_logit_{nullptr};
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
