// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/nets/BevOps.h>
#include <dyslam/nets/DysegNet.h>
#include <torch/torch.h>

#include <algorithm>

namespace dyslam
{
namespace nn = torch::nn;
using torch::Tensor;

namespace
{
constexpr std::int64_t motion_channels = 24;
constexpr std::int64_t segment_channels = 32;
constexpr std::int64_t cell_features = 24;
constexpr std::int64_t peak_channels = 3;
constexpr std::int64_t subcells = 4;
// Widths of the robust kernels of the two fits [m].
constexpr double coarse_width = 0.6;
constexpr double coarse_start = 4.0;
constexpr double fine_width = 0.15;
constexpr double fine_start = 1.5;

nn::Conv2d conv3(std::int64_t in, std::int64_t out, std::int64_t stride = 1)
{
  return nn::Conv2d(nn::Conv2dOptions(in, out, 3).padding(1).stride(stride));
}

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

/** Numbers of the occupied coarse cells, ascending, and each point's row among them. */
void occupiedCells(const BevScan& scan,
                   int factor,
                   std::vector<std::int32_t>& numbers,
                   std::vector<std::int32_t>& row_of_point)
{
  const int width = scan.cells / factor;
  std::vector<std::int32_t> row(static_cast<std::size_t>(width * width), -1);
  row_of_point.resize(scan.size());
  for (std::size_t i = 0; i < scan.size(); ++i)
  {
    const int x = scan.cell[i] % scan.cells / factor;
    const int y = scan.cell[i] / scan.cells / factor;
    row_of_point[i] = y * width + x;
    row[static_cast<std::size_t>(row_of_point[i])] = 0;
  }
  numbers.clear();
  for (std::size_t c = 0; c < row.size(); ++c)
  {
    if (row[c] == 0)
    {
      row[c] = static_cast<std::int32_t>(numbers.size());
      numbers.push_back(static_cast<std::int32_t>(c));
    }
  }
  for (auto& r : row_of_point)
  {
    r = row[static_cast<std::size_t>(r)];
  }
}

std::vector<Eigen::Vector2f> placesOf(const BevScan& scan,
                                      int factor,
                                      const std::vector<std::int32_t>& numbers)
{
  const int width = scan.cells / factor;
  const float size = scan.cell_size * static_cast<float>(factor);
  std::vector<Eigen::Vector2f> places;
  places.reserve(numbers.size());
  for (const auto n : numbers)
  {
    const Eigen::Vector2f cell(static_cast<float>(n % width), static_cast<float>(n / width));
    places.push_back(scan.corner + size * (cell + Eigen::Vector2f::Constant(0.5F)));
  }
  return places;
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
Tensor cellPosition(const Tensor& number, std::int64_t width)
{
  return torch::stack({number.remainder(width), number.div(width, "floor")}, 1).to(torch::kFloat32);
}

/** Fits the static motion to the peaks of a correlation. */
RigidFlowFit fitPeaks(const Tensor& correlation,
                      int radius,
                      float size,
                      const Tensor& base_flow,
                      const std::vector<Eigen::Vector2f>& places,
                      double width,
                      double start_width,
                      const PlanarMotion* start)
{
  torch::NoGradGuard no_gradient;
  const auto peak = peakOffset(correlation.detach(), radius).cpu().contiguous();
  const auto base = base_flow.defined() ? base_flow.cpu().contiguous() : Tensor();
  const float* p = peak.data_ptr<float>();
  const float* b = base.defined() ? base.data_ptr<float>() : nullptr;
  std::vector<Eigen::Vector2f> flow(places.size());
  std::vector<float> weight(places.size());
  for (std::size_t i = 0; i < places.size(); ++i)
  {
    flow[i] = size * Eigen::Vector2f(p[3 * i], p[3 * i + 1]);
    if (b != nullptr)
    {
      flow[i] += Eigen::Vector2f(b[2 * i], b[2 * i + 1]);
    }
    weight[i] = p[3 * i + 2] * p[3 * i + 2];
  }
  return fitRigidFlow(places, flow, weight, width, start_width, start);
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
{
  std::vector<std::int32_t> numbers;
  std::vector<std::int32_t> rows;
  occupiedCells(scan, 8, numbers, rows);
  eighth = toTensor(numbers);
  eighth_place = placesOf(scan, 8, numbers);
  occupiedCells(scan, 4, numbers, row_of_point);
  quarter = toTensor(numbers);
  quarter_place = placesOf(scan, 4, numbers);
}

DysegNetImpl::DysegNetImpl(const DysegNetworkOptions& options) : options_(options)
{
  validate(options_, "network");
  const auto& o = options_;
  const auto window = (2 * o.radius + 1) * (2 * o.radius + 1);
  const auto fine_window = (2 * o.fine_radius + 1) * (2 * o.fine_radius + 1);
  pillar_ = register_module("pillar", nn::Linear(BevScan::feature_count, o.pillar_channels));
  pillar_deep_ = register_module("pillar_deep", nn::Linear(o.pillar_channels, o.pillar_channels));
  half_ = register_module("half", conv3(o.pillar_channels, o.half_channels, 2));
  half_deep_ = register_module("half_deep", conv3(o.half_channels, o.half_channels));
  quarter_ = register_module("quarter", conv3(o.half_channels, o.quarter_channels, 2));
  quarter_first_ = register_module("quarter_first", conv3(o.quarter_channels, o.quarter_channels));
  quarter_second_ =
      register_module("quarter_second", conv3(o.quarter_channels, o.quarter_channels));
  fine_matching_ = register_module("fine_matching", nn::Linear(o.half_channels, o.fine_channels));
  matching_ = register_module("matching", nn::Linear(o.quarter_channels, o.matching_channels));
  state_ = register_module("state", nn::Linear(o.quarter_channels, o.hidden));
  update_ = register_module("update", FlowUpdate(o.hidden, motion_channels, o.radius));
  segment_ = register_module("segment", conv3(o.hidden + o.quarter_channels, segment_channels));
  cell_ = register_module("cell",
                          nn::Linear(segment_channels + 4 + window + peak_channels, cell_features));
  cell_logit_ = register_module("cell_logit", nn::Linear(cell_features, 1));
  upsampling_ = register_module("upsampling", nn::Linear(o.hidden, 9 * subcells * subcells));
  const auto point_inputs = cell_features + 3 + 2 * fine_window + o.pillar_channels +
                            BevScan::feature_count + BevRays::channels;
  point_first_ = register_module("point_first", nn::Linear(point_inputs, 48));
  point_second_ = register_module("point_second", nn::Linear(48, 24));
  point_logit_ = register_module("point_logit", nn::Linear(24, 1));
  for (auto& p : parameters())
  {
    if (p.dim() == 4)
    {
      p.set_data(p.contiguous(torch::MemoryFormat::ChannelsLast));
    }
  }
}

DysegEncoding DysegNetImpl::encode(const BevScan& scan)
{
  const auto device = pillar_->weight.device();
  const auto count = static_cast<std::int64_t>(scan.size());
  const auto features = featuresOf(scan).to(device);
  const auto cell =
      shared(torch::from_blob(const_cast<std::int32_t*>(scan.cell.data()), {count}, torch::kInt32))
          .to(device);
  DysegEncoding e;
  e.points = pillar_deep_(pillar_(features).relu()).relu();
  const std::int64_t side = scan.cells;
  const auto pillars =
      pillarMax(e.points, cell, side * side).view({1, side, side, -1}).permute({0, 3, 1, 2});
  auto half = half_(pillars).relu();
  half = half_deep_(half).relu();
  auto map = quarter_(half).relu();
  map = (map + quarter_second_(quarter_first_(map).relu())).relu();
  e.context = map;
  const auto rows = [](const Tensor& t) { return t.permute({0, 2, 3, 1}).squeeze(0); };
  e.fine = fine_matching_(rows(half));
  e.middle = matching_(rows(map));
  e.coarse = torch::avg_pool2d(e.middle.permute({2, 0, 1}).unsqueeze(0), 2)
                 .squeeze(0)
                 .permute({1, 2, 0})
                 .contiguous();
  return e;
}

DysegCellsOut DysegNetImpl::cells(const BevScan& scan,
                                  const DysegCells& occupied,
                                  const DysegEncoding& current,
                                  const DysegEncoding& past,
                                  int iterations,
                                  const DysegGuide* guide,
                                  const PlanarMotion* guess)
{
  const auto device = current.middle.device();
  const auto eighth = occupied.eighth.to(device);
  const auto quarter = occupied.quarter.to(device);
  const std::int64_t side = scan.cells / 4;
  const float size = 4 * scan.cell_size;
  const int radius = options_.radius;
  const auto sourceRows = [](const Tensor& map, const Tensor& cell) {
    return map.reshape({-1, map.size(2)}).index_select(0, cell);
  };
  DysegCellsOut out;

  // All motions, at 1/8: where does the static world go?
  out.coarse_correlation = correlate(sourceRows(current.coarse, eighth), past.coarse,
                                     cellPosition(eighth, side / 2), radius);
  out.first = guide != nullptr ? guide->first
              : guess != nullptr
                  ? *guess
                  : fitPeaks(out.coarse_correlation, radius, 2 * size, Tensor(),
                             occupied.eighth_place, coarse_width, coarse_start, nullptr)
                        .motion;

  // Around that motion, at 1/4: the static flow to a few centimetres.
  const auto source = sourceRows(current.middle, quarter);
  const auto here = cellPosition(quarter, side);
  const auto first_flow = rigidFlow(out.first, occupied.quarter_place);
  out.correlation = correlate(source, past.middle, here + first_flow.to(device) / size, radius);
  if (guide != nullptr)
  {
    out.static_motion = guide->second;
  }
  else
  {
    out.fit = fitPeaks(out.correlation, radius, size, first_flow, occupied.quarter_place,
                       fine_width, fine_start, &out.first);
    out.static_motion = out.fit.motion;
  }

  // Around the static flow: what does not follow it?
  const auto base = here + rigidFlow(out.static_motion, occupied.quarter_place).to(device) / size;
  auto state =
      scatterCells(state_(gatherCells(current.context, quarter)).tanh(), quarter, side, side);
  auto residual = torch::zeros({quarter.size(0), 2}, source.options());
  Tensor at_static;
  for (int i = 0; i < iterations; ++i)
  {
    residual = residual.detach();
    const auto window = correlate(source, past.middle, base + residual, radius);
    at_static = i == 0 ? window : at_static;
    const auto step = update_(state, window, residual, quarter);
    state = step.state;
    residual = residual + step.change;
    out.residual.push_back(residual * size);
  }

  const auto map = segment_(torch::cat({state, current.context}, 1)).relu();
  const auto still = residual.detach();
  const auto peak = peakOffset(at_static, radius).detach();
  out.feature =
      cell_(torch::cat({gatherCells(map, quarter), still, still.abs(), at_static, peak}, 1)).relu();
  out.logit = cell_logit_(out.feature).squeeze(1);
  out.upsampling = upsampling_(gatherCells(state, quarter));
  return out;
}

namespace
{
/** Per point: where in the past fine map, and what past rays saw there. */
struct PointGeometry
{
  Tensor fine_cell;   //!< Q (int64), in the current fine map
  Tensor fine_place;  //!< Q x 2, static position in the past fine map [cells]
  Tensor rays;        //!< Q x BevRays::channels
  Tensor row;         //!< Q (int64), row of the point's cell at 1/4
};

PointGeometry pointGeometry(const BevScan& scan,
                            const DysegCells& occupied,
                            const BevRays& past_rays,
                            const PlanarMotion& static_motion,
                            const std::vector<std::int32_t>& which)
{
  const auto count = static_cast<std::int64_t>(which.size());
  PointGeometry g{torch::empty({count}, torch::kInt64), torch::empty({count, 2}),
                  torch::empty({count, BevRays::channels}), torch::empty({count}, torch::kInt64)};
  auto* cell = g.fine_cell.data_ptr<std::int64_t>();
  auto* place = g.fine_place.data_ptr<float>();
  auto* rays = g.rays.data_ptr<float>();
  auto* row = g.row.data_ptr<std::int64_t>();
  const Eigen::Matrix2f R = Eigen::Rotation2Dd(static_motion.yaw).toRotationMatrix().cast<float>();
  const Eigen::Vector2f t = static_motion.translation.cast<float>();
  const float size = 2 * scan.cell_size;
  const int width = scan.cells / 2;
  for (std::size_t q = 0; q < which.size(); ++q)
  {
    const auto i = static_cast<std::size_t>(which[q]);
    const auto& p = scan.points[i];
    const int x = scan.cell[i] % scan.cells / 2;
    const int y = scan.cell[i] / scan.cells / 2;
    cell[q] = y * width + x;
    const Eigen::Vector2f centre =
        scan.corner +
        size * Eigen::Vector2f(static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F);
    const Eigen::Vector2f there = (R * centre + t - scan.corner) / size;
    place[2 * q] = there.x() - 0.5F;
    place[2 * q + 1] = there.y() - 0.5F;
    const Eigen::Vector2f flat = R * p.head<2>() + t;
    past_rays.compare(Eigen::Vector3f(flat.x(), flat.y(), p.z()), rays + q * BevRays::channels);
    row[q] = occupied.row_of_point[i];
  }
  return g;
}
}  // namespace

Tensor DysegNetImpl::points(const BevScan& scan,
                            const DysegCells& occupied,
                            const DysegEncoding& current,
                            const DysegEncoding& past,
                            const BevRays& past_rays,
                            const DysegCellsOut& cells,
                            const std::vector<std::int32_t>& which)
{
  const auto device = current.middle.device();
  const auto g = pointGeometry(scan, occupied, past_rays, cells.static_motion, which);
  const auto row = g.row.to(device);
  const auto index = toTensor(which).to(device);
  const auto source =
      current.fine.reshape({-1, options_.fine_channels}).index_select(0, g.fine_cell.to(device));
  const auto place = g.fine_place.to(device);
  const auto residual = cells.residual.back().detach().index_select(0, row);
  const auto moved = place + residual / (2 * scan.cell_size);
  const auto features = featuresOf(scan).to(device);
  const auto input = torch::cat(
      {cells.feature.index_select(0, row), residual,
       cells.logit.detach().index_select(0, row).unsqueeze(1),
       correlate(source, past.fine, place, options_.fine_radius),
       correlate(source, past.fine, moved, options_.fine_radius),
       current.points.index_select(0, index), features.index_select(0, index), g.rays.to(device)},
      1);
  return point_logit_(point_second_(point_first_(input).relu()).relu()).squeeze(1);
}

Tensor DysegNetImpl::pointFlow(const BevScan& scan,
                               const DysegCells& occupied,
                               const DysegCellsOut& cells,
                               const std::vector<std::int32_t>& which) const
{
  const auto device = cells.logit.device();
  std::vector<std::int32_t> row(which.size());
  std::vector<std::int32_t> coarse(which.size());
  std::vector<std::int32_t> sub(which.size());
  constexpr int factor = subcells;
  for (std::size_t q = 0; q < which.size(); ++q)
  {
    const auto i = static_cast<std::size_t>(which[q]);
    const int x = scan.cell[i] % scan.cells;
    const int y = scan.cell[i] / scan.cells;
    row[q] = occupied.row_of_point[i];
    coarse[q] = y / factor * (scan.cells / factor) + x / factor;
    sub[q] = y % factor * factor + x % factor;
  }
  const std::int64_t side = scan.cells / factor;
  const auto flow = scatterCells(cells.residual.back(), occupied.quarter.to(device), side, side)
                        .squeeze(0)
                        .permute({1, 2, 0});
  return upsampleFlow(flow, cells.upsampling, toTensor(row).to(device), toTensor(coarse).to(device),
                      toTensor(sub).to(device), factor);
}
}  // namespace dyslam
