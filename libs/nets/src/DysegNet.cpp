// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/nets/BevOps.h>
#include <dyslam/nets/DysegNet.h>
#include <dyslam/nets/Threads.h>
#include <torch/torch.h>

#include <algorithm>

#include "StaticMotionMatcher.h"

namespace dyslam
{
using torch::Tensor;

namespace
{
constexpr std::int64_t motion_channels = 24;
constexpr std::int64_t segment_channels = 32;
constexpr std::int64_t cell_features = 24;
constexpr std::int64_t static_channels = 16;
constexpr std::int64_t subcells = 4;

/** The view itself, or a copy while gradients are recorded: the graph outlives the scan's memory.
 */
Tensor shared(const Tensor& view)
{
  return torch::GradMode::is_enabled() ? view.clone() : view;
}

Tensor featuresOf(const BevScan& scan)
{
  return shared(torch::from_blob(const_cast<float*>(scan.features.data()),
                                 {static_cast<std::int64_t>(scan.size()), BevScan::feature_count}));
}

Tensor toTensor(const std::vector<std::int32_t>& values)
{
  return torch::tensor(values, torch::kInt32).to(torch::kInt64);
}

/** Positions of a level's cells in units of cells, N x 2 (x, y). */
Tensor positionTensor(const CellLevel& level)
{
  auto positions = torch::empty({static_cast<std::int64_t>(level.size()), 2});
  auto* out = positions.data_ptr<float>();
  for (std::size_t i = 0; i < level.size(); ++i)
  {
    out[2 * i] = static_cast<float>(level.number[i] % level.width);
    out[2 * i + 1] = static_cast<float>(level.number[i] / level.width);
  }
  return positions;
}

/** Average pooling over the four children of each cell; empty children count as zero. */
Tensor averageChildren(const Tensor& quarter, const Tensor& children)
{
  return gatherRows(quarter, children).view({children.size(0), 4, quarter.size(1)}).mean(1);
}

Tensor indexOf(const CellLevel& level)
{
  return tableTensor(level.row_of_cell, level.width);
}
}  // namespace

void DysegNetworkOptions::describe(OptionsVisitor& v)
{
  v.integer("pillar_channels", pillar_channels, 4, 64,
            "channels of the point features that are pooled per cell");
  v.integer("half_channels", half_channels, 4, 128,
            "feature channels at 1/2 of the grid's resolution");
  v.integer("quarter_channels", quarter_channels, 4, 256,
            "feature channels at 1/4 and 1/8 of the grid's resolution");
  v.integer("matching_channels", matching_channels, 4, 128,
            "channels of the matching features at 1/4 and 1/8 of the grid's resolution");
  v.integer("fine_channels", fine_channels, 4, 64,
            "channels of the matching features at 1/2 of the grid's resolution");
  v.integer("hidden", hidden, 4, 128, "channels of the hidden state of the flow update");
  v.integer("radius", radius, 1, 10,
            "radius of the correlation windows at 1/4 and 1/8 of the grid's resolution [cells]");
  v.integer("fine_radius", fine_radius, 1, 5,
            "radius of the correlation windows at 1/2 of the grid's resolution [cells]");
}

DysegCells::DysegCells(const BevScan& scan)
    : level(scan),
      half_from_full(tableTensor(convolutionRows(level.full, level.half), 9)),
      half_neighbours(tableTensor(convolutionRows(level.half, level.half), 9)),
      quarter_from_half(tableTensor(convolutionRows(level.half, level.quarter), 9)),
      quarter_neighbours(tableTensor(convolutionRows(level.quarter, level.quarter), 9)),
      eighth_children(tableTensor(childRows(level.quarter, level.eighth), 4)),
      eighth_neighbours(tableTensor(convolutionRows(level.eighth, level.eighth), 9)),
      quarter_parent(tableTensor(parentRows(level.quarter, level.eighth), 1)),
      half_index(indexOf(level.half)),
      quarter_index(indexOf(level.quarter)),
      eighth_index(indexOf(level.eighth)),
      quarter_position(positionTensor(level.quarter)),
      eighth_position(positionTensor(level.eighth)),
      quarter_centre(cellCentres(level.quarter, scan)),
      eighth_centre(cellCentres(level.eighth, scan))
{
}

void DysegCells::to(torch::Device device)
{
  for (auto* t : {&half_from_full, &half_neighbours, &quarter_from_half, &quarter_neighbours,
                  &eighth_children, &eighth_neighbours, &quarter_parent, &half_index,
                  &quarter_index, &eighth_index, &quarter_position, &eighth_position})
  {
    *t = t->to(device);
  }
}

DysegNetImpl::DysegNetImpl(const DysegNetworkOptions& options) : options_(options)
{
  validate(options_, "network");
  const auto& o = options_;
  const auto window = (2 * o.radius + 1) * (2 * o.radius + 1);
  const auto fine_window = (2 * o.fine_radius + 1) * (2 * o.fine_radius + 1);
  empty_fine_ = register_parameter("empty_fine", torch::zeros({o.fine_channels}));
  empty_middle_ = register_parameter("empty_middle", torch::zeros({o.matching_channels}));
  empty_coarse_ = register_parameter("empty_coarse", torch::zeros({o.matching_channels}));
  pillar_ = register_module("pillar", RowLinear(BevScan::feature_count, o.pillar_channels));
  pillar_deep_ = register_module("pillar_deep", RowLinear(o.pillar_channels, o.pillar_channels));
  half_ = register_module("half", CellConv(o.pillar_channels, o.half_channels));
  half_deep_ = register_module("half_deep", CellConv(o.half_channels, o.half_channels));
  quarter_ = register_module("quarter", CellConv(o.half_channels, o.quarter_channels));
  quarter_first_ =
      register_module("quarter_first", CellConv(o.quarter_channels, o.quarter_channels));
  quarter_second_ =
      register_module("quarter_second", CellConv(o.quarter_channels, o.quarter_channels));
  wide_first_ = register_module("wide_first", CellConv(o.quarter_channels, o.quarter_channels));
  wide_second_ = register_module("wide_second", CellConv(o.quarter_channels, o.quarter_channels));
  wide_third_ = register_module("wide_third", CellConv(o.quarter_channels, o.quarter_channels));
  fine_matching_ = register_module("fine_matching", RowLinear(o.half_channels, o.fine_channels));
  matching_ = register_module("matching", RowLinear(o.quarter_channels, o.matching_channels));
  // The head of the appearance prior; checkpoints use these names.
  static_hidden_ = register_module("anchor", RowLinear(o.quarter_channels, static_channels));
  static_logit_ = register_module("anchor_logit", RowLinear(static_channels, 1));
  state_ = register_module("state", RowLinear(o.quarter_channels, o.hidden));
  update_ = register_module("update", FlowUpdate(o.hidden, motion_channels, o.radius));
  segment_ = register_module("segment", CellConv(o.hidden + o.quarter_channels, segment_channels));
  cell_ = register_module("cell",
                          RowLinear(segment_channels + 4 + window + peak_channels, cell_features));
  cell_logit_ = register_module("cell_logit", RowLinear(cell_features, 1));
  upsampling_ = register_module("upsampling", RowLinear(o.hidden, 9 * subcells * subcells));
  const auto point_inputs = cell_features + 3 + 2 * fine_window + o.pillar_channels +
                            BevScan::feature_count + BevRays::channels;
  point_first_ = register_module("point_first", RowLinear(point_inputs, 48));
  point_second_ = register_module("point_second", RowLinear(48, 24));
  point_logit_ = register_module("point_logit", RowLinear(24, 1));
}

Tensor DysegNetImpl::surroundings(const Tensor& quarter, const DysegCells& cells)
{
  const auto coarse = averageChildren(quarter, cells.eighth_children);
  auto wide = wide_first_(coarse, cells.eighth_neighbours, relu);
  wide = wide + wide_second_(wide, cells.eighth_neighbours, relu);
  return gatherRows(wide_third_(wide, cells.eighth_neighbours), cells.quarter_parent);
}

DysegEncoding DysegNetImpl::encode(const BevScan& scan)
{
  const auto device = pillar_->weight.device();
  DysegEncoding e;
  auto cells = std::make_shared<DysegCells>(scan);
  cells->to(device);
  const auto& full = cells->level.full;
  const auto row = tableTensor(full.row_of_point, 1).squeeze(1).to(device);
  e.points = pillar_deep_(pillar_(featuresOf(scan).to(device), relu), relu);
  const auto pillars = pillarMax(e.points, row, static_cast<std::int64_t>(full.size()));
  auto half = half_(pillars, cells->half_from_full, relu);
  half = half_deep_(half, cells->half_neighbours, relu);
  auto quarter = quarter_(half, cells->quarter_from_half, relu);
  const auto first = quarter_first_(quarter, cells->quarter_neighbours, relu);
  quarter = (quarter + quarter_second_(first, cells->quarter_neighbours)).relu();
  quarter = (quarter + surroundings(quarter, *cells)).relu();
  e.context = quarter;
  e.fine = fine_matching_(half);
  e.static_logit = static_logit_(static_hidden_(quarter, relu)).squeeze(1);
  e.middle = matching_(quarter);
  e.coarse = averageChildren(e.middle, cells->eighth_children);
  e.cells = std::move(cells);
  return e;
}

DysegMatch DysegNetImpl::match(const BevScan& scan,
                               const DysegEncoding& current,
                               const DysegEncoding& past,
                               const TeacherMotions* guide,
                               const PlanarPrior* guess)
{
  const SparseMap past_middle{past.middle, past.cells->quarter_index, empty_middle_};
  const StaticMotionMatcher matcher(scan, current, past_middle, options_.radius);
  DysegMatch out;
  if (guess == nullptr)
  {
    out.coarse_correlation =
        correlate(current.coarse, {past.coarse, past.cells->eighth_index, empty_coarse_},
                  current.cells->eighth_position, options_.radius);
  }
  if (guide != nullptr)
  {
    out.initial = guide->coarse;
    out.correlation = matcher.correlationAround(out.initial);
    return out;
  }
  double margin = 1;
  out.initial = guess != nullptr ? guess->motion : matcher.search(out.coarse_correlation, margin);
  constexpr double search_error = 0.6;  // largest expected error of the search [m]
  out.fit = matcher.refine(out.initial, guess != nullptr ? guess->max_error : search_error);
  out.fit.margin = margin;
  return out;
}

DysegCellOutput DysegNetImpl::segmentCells(const BevScan& scan,
                                           const DysegEncoding& current,
                                           const DysegEncoding& past,
                                           const PlanarMotion& static_motion,
                                           int iterations)
{
  const auto device = current.middle.device();
  const auto& occupied = *current.cells;
  const auto& source = current.middle;
  const SparseMap past_middle{past.middle, past.cells->quarter_index, empty_middle_};
  const float size = 4 * scan.cell_size;
  const int radius = options_.radius;
  DysegCellOutput out;
  out.static_motion = static_motion;
  const auto flow = rigidFlow(static_motion, occupied.quarter_centre);
  const auto base = occupied.quarter_position + flow.to(device) / size;
  auto state = state_(current.context).tanh();
  auto residual = torch::zeros({source.size(0), 2}, source.options());
  Tensor static_window;
  for (int i = 0; i < iterations; ++i)
  {
    residual = residual.detach();
    const auto window = correlate(source, past_middle, base + residual, radius);
    static_window = i == 0 ? window : static_window;
    const auto step = update_(state, window, residual, occupied.quarter_neighbours);
    state = step.state;
    residual = residual + step.change;
    out.residual.push_back(residual * size);
  }

  const auto segment =
      segment_(torch::cat({state, current.context}, 1), occupied.quarter_neighbours, relu);
  const auto residual_flow = residual.detach();
  const auto peak = peakOffset(static_window, radius);
  out.feature = cell_(
      torch::cat({segment, residual_flow, residual_flow.abs(), static_window, peak}, 1), relu);
  out.logit = cell_logit_(out.feature).squeeze(1);
  out.upsampling = upsampling_(state);
  return out;
}

namespace
{
/** Per point: position in the past fine map, and visibility in the past scan. */
struct PointGeometry
{
  Tensor fine_row;    //!< Q (int64), row of the point's cell at 1/2
  Tensor fine_place;  //!< Q x 2, ego-motion-compensated position in the past fine map [cells]
  Tensor rays;        //!< Q x BevRays::channels
  Tensor row;         //!< Q (int64), row of the point's cell at 1/4
};

PointGeometry pointGeometry(const BevScan& scan,
                            const DysegCells& cells,
                            const BevRays& past_rays,
                            const PlanarMotion& static_motion,
                            const std::vector<std::int32_t>& indices)
{
  const auto count = static_cast<std::int64_t>(indices.size());
  PointGeometry g{torch::empty({count}, torch::kInt64), torch::empty({count, 2}),
                  torch::empty({count, BevRays::channels}), torch::empty({count}, torch::kInt64)};
  auto* fine = g.fine_row.data_ptr<std::int64_t>();
  auto* place = g.fine_place.data_ptr<float>();
  auto* rays = g.rays.data_ptr<float>();
  auto* row = g.row.data_ptr<std::int64_t>();
  const Eigen::Matrix2f R = Eigen::Rotation2Dd(static_motion.yaw).toRotationMatrix().cast<float>();
  const Eigen::Vector2f t = static_motion.translation.cast<float>();
  const float size = 2 * scan.cell_size;
  forEachRow(
      indices.size(), 256,
      [&](std::size_t q)
      {
        const auto i = static_cast<std::size_t>(indices[q]);
        const auto& p = scan.points[i];
        const int x = scan.cell[i] % scan.cells / 2;
        const int y = scan.cell[i] / scan.cells / 2;
        fine[q] = cells.level.half.row_of_point[i];
        const Eigen::Vector2f centre =
            scan.corner +
            size * Eigen::Vector2f(static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F);
        const Eigen::Vector2f there = (R * centre + t - scan.corner) / size;
        place[2 * q] = there.x() - 0.5F;
        place[2 * q + 1] = there.y() - 0.5F;
        const Eigen::Vector2f flat = R * p.head<2>() + t;
        past_rays.compare(Eigen::Vector3f(flat.x(), flat.y(), p.z()), rays + q * BevRays::channels);
        row[q] = cells.level.quarter.row_of_point[i];
      });
  return g;
}
}  // namespace

Tensor DysegNetImpl::segmentPoints(const BevScan& scan,
                                   const DysegEncoding& current,
                                   const DysegEncoding& past,
                                   const BevRays& past_rays,
                                   const DysegCellOutput& cells,
                                   const std::vector<std::int32_t>& indices)
{
  const auto device = current.middle.device();
  const auto g = pointGeometry(scan, *current.cells, past_rays, cells.static_motion, indices);
  const auto row = g.row.to(device);
  const auto index = toTensor(indices).to(device);
  const auto source = current.fine.index_select(0, g.fine_row.to(device));
  const SparseMap past_fine{past.fine, past.cells->half_index, empty_fine_};
  const auto place = g.fine_place.to(device);
  const auto residual = cells.residual.back().detach().index_select(0, row);
  const auto moved = place + residual / (2 * scan.cell_size);
  const auto features = featuresOf(scan).to(device);
  const auto input = torch::cat(
      {cells.feature.index_select(0, row), residual,
       cells.logit.detach().index_select(0, row).unsqueeze(1),
       correlate(source, past_fine, place, options_.fine_radius),
       correlate(source, past_fine, moved, options_.fine_radius),
       current.points.index_select(0, index), features.index_select(0, index), g.rays.to(device)},
      1);
  return point_logit_(point_second_(point_first_(input, relu), relu)).squeeze(1);
}

Tensor DysegNetImpl::pointFlow(const BevScan& scan,
                               const DysegEncoding& current,
                               const DysegCellOutput& cells,
                               const std::vector<std::int32_t>& indices) const
{
  const auto device = cells.logit.device();
  std::vector<std::int32_t> row(indices.size());
  std::vector<std::int32_t> sub(indices.size());
  constexpr int factor = subcells;
  for (std::size_t q = 0; q < indices.size(); ++q)
  {
    const auto i = static_cast<std::size_t>(indices[q]);
    const int x = scan.cell[i] % scan.cells;
    const int y = scan.cell[i] / scan.cells;
    row[q] = current.cells->level.quarter.row_of_point[i];
    sub[q] = y % factor * factor + x % factor;
  }
  return upsampleFlow(cells.residual.back(), cells.upsampling, current.cells->quarter_neighbours,
                      toTensor(row).to(device), toTensor(sub).to(device), factor);
}
}  // namespace dyslam
