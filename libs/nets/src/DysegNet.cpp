// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/nets/BevOps.h>
#include <dyslam/nets/DysegNet.h>
#include <dyslam/nets/MotionVote.h>
#include <torch/torch.h>

#include <algorithm>

namespace dyslam
{
using torch::Tensor;

namespace
{
constexpr std::int64_t motion_channels = 24;
constexpr std::int64_t segment_channels = 32;
constexpr std::int64_t cell_features = 24;
constexpr std::int64_t anchor_channels = 16;
constexpr std::int64_t peak_channels = 3;
constexpr std::int64_t subcells = 4;
constexpr double rectified = 0;        // slope below zero
constexpr float voting_reach = 51.2F;  // m to each side
// Widths of the fit's robust kernel [m].
constexpr double fine_width = 0.15;
constexpr double voted_within = 0.6;
// Yaws tried in the votes [rad], in steps to each side.
constexpr double coarse_yaw_step = 0.035;
constexpr int coarse_yaw_steps = 3;
constexpr double fine_yaw_step = 0.012;
constexpr int fine_yaw_steps = 2;
constexpr int rounds = 8;           // of the finer fit, at most
constexpr double settled = 0.003;   // m, a step after which no other is needed
constexpr double most_left = 0.85;  // share of an offset that a look leaves
constexpr double lever = 20;        // m, at which a turn counts like a shift

/** A view of foreign memory; a copy while gradients are recorded, for they outlive the scan. */
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

/** Motion vectors of a rigid motion at some places, N x 2 [m]. */
Tensor rigidFlow(const PlanarMotion& motion, const std::vector<Eigen::Vector2f>& places)
{
  auto flow = torch::empty({static_cast<std::int64_t>(places.size()), 2});
  auto* out = flow.data_ptr<float>();
  const Eigen::Matrix2f R = Eigen::Rotation2Dd(motion.yaw).toRotationMatrix().cast<float>();
  const Eigen::Vector2f t = motion.translation.cast<float>();
  for (std::size_t i = 0; i < places.size(); ++i)
  {
    const Eigen::Vector2f f = R * places[i] + t - places[i];
    out[2 * i] = f.x();
    out[2 * i + 1] = f.y();
  }
  return flow;
}

/** Positions of cells in units of cells, N x 2 (x, y). */
Tensor positionsOf(const CellLevel& level)
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

/** Means over the four quarter cells of each eighth cell, empty ones counted as zeros. */
Tensor meanOfParts(const Tensor& quarter, const Tensor& parts)
{
  return gatherRows(quarter, parts).view({parts.size(0), 4, quarter.size(1)}).mean(1);
}

Tensor indexOf(const CellLevel& level)
{
  return tableTensor(level.row_of_cell, level.width);
}

/** Fits the static motion to the peaks of a correlation.
 * \param trust of each cell, N \param centre motion that the windows lie around, `flow` of the
 * cells \param within this far from the centre cells count at first [m]. */
RigidFlowFit fitPeaks(const Tensor& correlation,
                      const Tensor& trust,
                      int radius,
                      float size,
                      const Tensor& flow,
                      const std::vector<Eigen::Vector2f>& places,
                      const PlanarMotion& centre,
                      double within)
{
  torch::NoGradGuard no_gradient;
  const auto peak = peakOffset(correlation, radius).cpu().contiguous();
  const auto base = flow.cpu().contiguous();
  const auto trusted = trust.cpu().contiguous();
  const float* p = peak.data_ptr<float>();
  const float* t = trusted.data_ptr<float>();
  const float* b = base.data_ptr<float>();
  std::vector<Eigen::Vector2f> found(places.size());
  std::vector<float> weight(places.size());
  for (std::size_t i = 0; i < places.size(); ++i)
  {
    found[i] =
        size * Eigen::Vector2f(p[3 * i], p[3 * i + 1]) + Eigen::Vector2f(b[2 * i], b[2 * i + 1]);
    weight[i] = p[3 * i + 2] * p[3 * i + 2] * t[i];
  }
  return fitRigidFlow(places, found, weight, fine_width, within, &centre);
}

/** 1 for cells that have a say in the static motion, else 0: far ones hold a few points each, and
 * their windows are as wide as those of near ones. */
Tensor heardOf(const std::vector<Eigen::Vector2f>& places)
{
  auto heard = torch::empty({static_cast<std::int64_t>(places.size())});
  std::transform(places.begin(), places.end(), heard.data_ptr<float>(),
                 [](const Eigen::Vector2f& p)
                 { return p.cwiseAbs().maxCoeff() < voting_reach ? 1.0F : 0.0F; });
  return heard;
}

/** The static motion that the windows of a correlation speak for. */
MotionVote vote(const Tensor& correlation,
                const Tensor& trust,
                int radius,
                float size,
                const std::vector<Eigen::Vector2f>& places,
                const PlanarMotion& centre,
                double yaw_step,
                int yaw_steps)
{
  torch::NoGradGuard no_gradient;
  const auto probability = correlation.softmax(1).cpu().contiguous();
  const auto given = trust.cpu().contiguous();
  const std::vector<float> weight(given.data_ptr<float>(), given.data_ptr<float>() + given.numel());
  return voteMotion({probability.data_ptr<float>(), radius, size, places, weight}, centre, yaw_step,
                    yaw_steps);
}
}  // namespace

void DysegNetworkOptions::describe(OptionsVisitor& v)
{
  v.integer("pillar_channels", pillar_channels, 4, 64, "of the network on single points");
  v.integer("half_channels", half_channels, 4, 128, "at half the grid's resolution");
  v.integer("quarter_channels", quarter_channels, 4, 256, "at a quarter of it");
  v.integer("matching_channels", matching_channels, 4, 128, "compared between scans");
  v.integer("fine_channels", fine_channels, 4, 64, "compared at half resolution");
  v.integer("hidden", hidden, 4, 128, "state of the flow update");
  v.integer("radius", radius, 1, 10, "of the correlation windows, in cells");
  v.integer("fine_radius", fine_radius, 1, 5, "of the windows at half resolution, in cells");
}

DysegCells::DysegCells(const BevScan& scan)
    : level(scan),
      half_under(tableTensor(convolutionRows(level.full, level.half), 9)),
      half_around(tableTensor(convolutionRows(level.half, level.half), 9)),
      quarter_under(tableTensor(convolutionRows(level.half, level.quarter), 9)),
      quarter_around(tableTensor(convolutionRows(level.quarter, level.quarter), 9)),
      eighth_parts(tableTensor(childRows(level.quarter, level.eighth), 4)),
      eighth_around(tableTensor(convolutionRows(level.eighth, level.eighth), 9)),
      quarter_parent(tableTensor(parentRows(level.quarter, level.eighth), 1)),
      half_index(indexOf(level.half)),
      quarter_index(indexOf(level.quarter)),
      eighth_index(indexOf(level.eighth)),
      quarter_position(positionsOf(level.quarter)),
      eighth_position(positionsOf(level.eighth)),
      quarter_place(cellCentres(level.quarter, scan)),
      eighth_place(cellCentres(level.eighth, scan))
{
}

void DysegCells::to(torch::Device device)
{
  for (auto* t : {&half_under, &half_around, &quarter_under, &quarter_around, &eighth_parts,
                  &eighth_around, &quarter_parent, &half_index, &quarter_index, &eighth_index,
                  &quarter_position, &eighth_position})
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
  anchor_ = register_module("anchor", RowLinear(o.quarter_channels, anchor_channels));
  anchor_logit_ = register_module("anchor_logit", RowLinear(anchor_channels, 1));
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
  const auto coarse = meanOfParts(quarter, cells.eighth_parts);
  auto wide = wide_first_(coarse, cells.eighth_around, rectified);
  wide = wide + wide_second_(wide, cells.eighth_around, rectified);
  return gatherRows(wide_third_(wide, cells.eighth_around), cells.quarter_parent);
}

DysegEncoding DysegNetImpl::encode(const BevScan& scan)
{
  const auto device = pillar_->weight.device();
  DysegEncoding e;
  auto cells = std::make_shared<DysegCells>(scan);
  cells->to(device);
  const auto& full = cells->level.full;
  const auto row = tableTensor(full.row_of_point, 1).squeeze(1).to(device);
  e.points = pillar_deep_(pillar_(featuresOf(scan).to(device), rectified), rectified);
  const auto pillars = pillarMax(e.points, row, static_cast<std::int64_t>(full.size()));
  auto half = half_(pillars, cells->half_under, rectified);
  half = half_deep_(half, cells->half_around, rectified);
  auto quarter = quarter_(half, cells->quarter_under, rectified);
  const auto first = quarter_first_(quarter, cells->quarter_around, rectified);
  quarter = (quarter + quarter_second_(first, cells->quarter_around)).relu();
  quarter = (quarter + surroundings(quarter, *cells)).relu();
  e.context = quarter;
  e.fine = fine_matching_(half);
  e.anchor = anchor_logit_(anchor_(quarter, rectified)).squeeze(1);
  e.middle = matching_(quarter);
  e.coarse = meanOfParts(e.middle, cells->eighth_parts);
  e.cells = std::move(cells);
  return e;
}

DysegMatch DysegNetImpl::match(const BevScan& scan,
                               const DysegEncoding& current,
                               const DysegEncoding& past,
                               const DysegGuide* guide,
                               const MotionGuess* guess)
{
  const auto device = current.middle.device();
  const auto& occupied = *current.cells;
  const float size = 4 * scan.cell_size;
  const int radius = options_.radius;
  const CellMap past_middle{past.middle, past.cells->quarter_index, empty_middle_};
  const auto trust =
      current.anchor.detach().sigmoid().square() * heardOf(occupied.quarter_place).to(device);
  DysegMatch out;
  if (guess == nullptr)
  {
    out.coarse_correlation =
        correlate(current.coarse, {past.coarse, past.cells->eighth_index, empty_coarse_},
                  occupied.eighth_position, radius);
  }
  double lead = 1;
  if (guide != nullptr)
  {
    out.first = guide->first;
  }
  else if (guess != nullptr)
  {
    out.first = guess->motion;
  }
  else
  {
    const auto coarse_trust = gatherRows(trust.unsqueeze(1), occupied.eighth_parts).mean(1);
    const MotionVote coarse =
        vote(out.coarse_correlation, coarse_trust, radius, 2 * size, occupied.eighth_place,
             PlanarMotion(), coarse_yaw_step, coarse_yaw_steps);
    lead = coarse.lead;
    out.first = coarse.motion;
    const auto flow = rigidFlow(out.first, occupied.quarter_place);
    const auto window = correlate(current.middle, past_middle,
                                  occupied.quarter_position + flow.to(device) / size, radius);
    out.first = vote(window, trust, radius, size, occupied.quarter_place, out.first, fine_yaw_step,
                     fine_yaw_steps)
                    .motion;
  }
  // Peaks between cells are seen too near the window's centre: look again from there, until what is
  // found is the centre. Each look takes the same share of what is left, which Aitken's method
  // uses.
  PlanarMotion centre = out.first;
  Eigen::Vector3d last_step = Eigen::Vector3d::Zero();
  for (int round = 0; round < (guide == nullptr ? rounds : 1); ++round)
  {
    const auto flow = rigidFlow(centre, occupied.quarter_place);
    out.correlation = correlate(current.middle, past_middle,
                                occupied.quarter_position + flow.to(device) / size, radius);
    if (guide != nullptr)
    {
      break;
    }
    out.fit = fitPeaks(out.correlation, trust, radius, size, flow, occupied.quarter_place, centre,
                       guess != nullptr ? guess->within : voted_within);
    if (!out.fit.converged)
    {
      break;
    }
    Eigen::Vector3d step;
    step << out.fit.motion.translation - centre.translation,
        lever * (out.fit.motion.yaw - centre.yaw);
    const double left =
        last_step.squaredNorm() > 0
            ? std::clamp(step.dot(last_step) / last_step.squaredNorm(), 0.0, most_left)
            : 0.0;
    last_step = round % 2 == 0 ? step : Eigen::Vector3d::Zero();
    step /= 1 - left;
    centre.translation += step.head<2>();
    centre.yaw += step.z() / lever;
    out.fit.motion = centre;
    if (step.norm() < settled)
    {
      break;
    }
  }
  out.fit.lead = lead;
  return out;
}

DysegCellsOut DysegNetImpl::cells(const BevScan& scan,
                                  const DysegEncoding& current,
                                  const DysegEncoding& past,
                                  const PlanarMotion& static_motion,
                                  int iterations)
{
  const auto device = current.middle.device();
  const auto& occupied = *current.cells;
  const auto& source = current.middle;
  const CellMap past_middle{past.middle, past.cells->quarter_index, empty_middle_};
  const float size = 4 * scan.cell_size;
  const int radius = options_.radius;
  DysegCellsOut out;
  out.static_motion = static_motion;
  const auto flow = rigidFlow(static_motion, occupied.quarter_place);
  const auto base = occupied.quarter_position + flow.to(device) / size;
  auto state = state_(current.context).tanh();
  auto residual = torch::zeros({source.size(0), 2}, source.options());
  Tensor at_static;
  for (int i = 0; i < iterations; ++i)
  {
    residual = residual.detach();
    const auto window = correlate(source, past_middle, base + residual, radius);
    at_static = i == 0 ? window : at_static;
    const auto step = update_(state, window, residual, occupied.quarter_around);
    state = step.state;
    residual = residual + step.change;
    out.residual.push_back(residual * size);
  }

  const auto segment =
      segment_(torch::cat({state, current.context}, 1), occupied.quarter_around, rectified);
  const auto still = residual.detach();
  const auto peak = peakOffset(at_static, radius);
  out.feature = cell_(torch::cat({segment, still, still.abs(), at_static, peak}, 1), rectified);
  out.logit = cell_logit_(out.feature).squeeze(1);
  out.upsampling = upsampling_(state);
  return out;
}

namespace
{
/** Per point: where in the past fine map, and what past rays saw there. */
struct PointGeometry
{
  Tensor fine_row;    //!< Q (int64), of the point's cell at 1/2
  Tensor fine_place;  //!< Q x 2, static position in the past fine map [cells]
  Tensor rays;        //!< Q x BevRays::channels
  Tensor row;         //!< Q (int64), row of the point's cell at 1/4
};

PointGeometry pointGeometry(const BevScan& scan,
                            const DysegCells& cells,
                            const BevRays& past_rays,
                            const PlanarMotion& static_motion,
                            const std::vector<std::int32_t>& which)
{
  const auto count = static_cast<std::int64_t>(which.size());
  PointGeometry g{torch::empty({count}, torch::kInt64), torch::empty({count, 2}),
                  torch::empty({count, BevRays::channels}), torch::empty({count}, torch::kInt64)};
  auto* fine = g.fine_row.data_ptr<std::int64_t>();
  auto* place = g.fine_place.data_ptr<float>();
  auto* rays = g.rays.data_ptr<float>();
  auto* row = g.row.data_ptr<std::int64_t>();
  const Eigen::Matrix2f R = Eigen::Rotation2Dd(static_motion.yaw).toRotationMatrix().cast<float>();
  const Eigen::Vector2f t = static_motion.translation.cast<float>();
  const float size = 2 * scan.cell_size;
  for (std::size_t q = 0; q < which.size(); ++q)
  {
    const auto i = static_cast<std::size_t>(which[q]);
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
  }
  return g;
}
}  // namespace

Tensor DysegNetImpl::points(const BevScan& scan,
                            const DysegEncoding& current,
                            const DysegEncoding& past,
                            const BevRays& past_rays,
                            const DysegCellsOut& cells,
                            const std::vector<std::int32_t>& which)
{
  const auto device = current.middle.device();
  const auto g = pointGeometry(scan, *current.cells, past_rays, cells.static_motion, which);
  const auto row = g.row.to(device);
  const auto index = toTensor(which).to(device);
  const auto source = current.fine.index_select(0, g.fine_row.to(device));
  const CellMap past_fine{past.fine, past.cells->half_index, empty_fine_};
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
  return point_logit_(point_second_(point_first_(input, rectified), rectified)).squeeze(1);
}

Tensor DysegNetImpl::pointFlow(const BevScan& scan,
                               const DysegEncoding& current,
                               const DysegCellsOut& cells,
                               const std::vector<std::int32_t>& which) const
{
  const auto device = cells.logit.device();
  std::vector<std::int32_t> row(which.size());
  std::vector<std::int32_t> sub(which.size());
  constexpr int factor = subcells;
  for (std::size_t q = 0; q < which.size(); ++q)
  {
    const auto i = static_cast<std::size_t>(which[q]);
    const int x = scan.cell[i] % scan.cells;
    const int y = scan.cell[i] / scan.cells;
    row[q] = current.cells->level.quarter.row_of_point[i];
    sub[q] = y % factor * factor + x % factor;
  }
  return upsampleFlow(cells.residual.back(), cells.upsampling, current.cells->quarter_around,
                      toTensor(row).to(device), toTensor(sub).to(device), factor);
}
}  // namespace dyslam
