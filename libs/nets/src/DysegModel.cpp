// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/nets/Devices.h>
#include <dyslam/nets/DysegFile.h>
#include <dyslam/nets/DysegModel.h>
#include <dyslam/nets/Threads.h>
#include <torch/torch.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace dyslam
{
namespace
{
/** Logit of a cell below which its points are not segmented individually. */
constexpr float min_cell_logit = -3.0F;

/** Least range difference of a free position, and largest of an occupied one, in the past scan [m].
 */
constexpr float min_free_margin = 0.6F;
constexpr float max_return_distance = 0.25F;

/** What `past` observed at the position of a point of the current scan. */
PastVisibility visibilityIn(const BevRays& past,
                            const PlanarMotion& motion,
                            const Eigen::Vector3f& p)
{
  const Eigen::Vector2f flat = p.head<2>() + motion.flowAt(p.head<2>());
  std::array<float, BevRays::channels> seen{};
  past.compare(Eigen::Vector3f(flat.x(), flat.y(), p.z()), seen.data());
  if (seen[2] == 0)
  {
    return PastVisibility::unknown;
  }
  if (2 * seen[0] > min_free_margin)
  {
    return PastVisibility::free;
  }
  return seen[1] < max_return_distance ? PastVisibility::occupied : PastVisibility::unknown;
}

float sigmoid(float x)
{
  return 1 / (1 + std::exp(-x));
}
}  // namespace

class DysegModel::Encoded
{
 public:
  Encoded(BevScan&& bev, std::size_t count) : scan(std::move(bev)), inputs(count) {}

  BevScan scan;
  DysegEncoding encoding;
  std::size_t inputs;
};

struct DysegModel::Impl
{
  explicit Impl(int threads) : pool(threads) {}

  DysegNetwork network;
  ThreadPool pool;
};

DysegModel::DysegModel(const std::string& file, int threads, const std::string& device)
    : impl_(std::make_unique<Impl>(threads))
{
  impl_->network = loadDyseg(file);
  impl_->network.net->to(deviceNamed(device, "dyseg_network.device"));
  impl_->network.net->eval();
}

DysegModel::DysegModel(const DysegNetworkOptions& network,
                       const BevOptions& grid,
                       std::uint64_t seed,
                       int threads)
    : impl_(std::make_unique<Impl>(threads))
{
  torch::manual_seed(seed);
  impl_->network.net = DysegNet(network);
  impl_->network.grid = grid;
}

DysegModel::~DysegModel() = default;
DysegModel::DysegModel(DysegModel&&) noexcept = default;
DysegModel& DysegModel::operator=(DysegModel&&) noexcept = default;

const BevOptions& DysegModel::grid() const
{
  return impl_->network.grid;
}

std::shared_ptr<const DysegModel::Encoded> DysegModel::encode(
    const std::vector<Eigen::Vector3f>& points) const
{
  torch::InferenceMode inference;
  const LoopsOnPool loops(impl_->pool);
  auto encoded = std::make_shared<Encoded>(makeBevScan(points, grid()), points.size());
  encoded->encoding = impl_->network.net->encode(encoded->scan);
  return encoded;
}

RigidFlowFit DysegModel::match(const Encoded& current,
                               const Encoded& past,
                               const PlanarPrior* guess) const
{
  torch::InferenceMode inference;
  const LoopsOnPool loops(impl_->pool);
  if (current.scan.size() == 0 || past.scan.size() == 0)
  {
    return {};
  }
  return impl_->network.net->match(current.scan, current.encoding, past.encoding, nullptr, guess)
      .fit;
}

std::vector<float> DysegModel::appearancePrior(const Encoded& scan) const
{
  std::vector<float> prior(scan.inputs, 1.0F);
  if (scan.scan.size() == 0)
  {
    return prior;
  }
  const auto logit = scan.encoding.static_logit.cpu().contiguous();
  const float* l = logit.data_ptr<float>();
  for (std::size_t i = 0; i < scan.scan.size(); ++i)
  {
    prior[scan.scan.source[i]] = sigmoid(l[scan.encoding.cells->level.quarter.row_of_point[i]]);
  }
  return prior;
}

DysegResult DysegModel::compare(const Encoded& current, const Encoded& past, int iterations) const
{
  return segment(current, past, match(current, past), iterations);
}

DysegResult DysegModel::segment(const Encoded& current,
                                const Encoded& past,
                                const RigidFlowFit& static_flow,
                                int iterations) const
{
  torch::InferenceMode inference;
  const LoopsOnPool loops(impl_->pool);
  DysegResult result;
  result.static_flow = static_flow;
  result.moving_probability.assign(current.inputs, 0.0F);
  result.past_visibility.assign(current.inputs, PastVisibility::unknown);
  const auto& scan = current.scan;
  if (scan.size() == 0 || past.scan.size() == 0)
  {
    return result;
  }
  auto& net = impl_->network.net;
  const auto cells = net->segmentCells(scan, current.encoding, past.encoding, static_flow.motion,
                                       std::max(1, iterations));
  const auto& occupied = *current.encoding.cells;
  const auto logit = cells.logit.cpu().contiguous();
  const auto residual = cells.residual.back().cpu().contiguous();
  const float* l = logit.data_ptr<float>();
  const float* r = residual.data_ptr<float>();
  result.cell_centre = occupied.quarter_centre;
  for (std::size_t i = 0; i < result.cell_centre.size(); ++i)
  {
    result.cell_flow.emplace_back(cells.static_motion.flowAt(result.cell_centre[i]) +
                                  Eigen::Vector2f(r[2 * i], r[2 * i + 1]));
    result.cell_moving_probability.push_back(sigmoid(l[i]));
  }

  std::vector<std::int32_t> indices;
  for (std::size_t i = 0; i < scan.size(); ++i)
  {
    if (l[occupied.level.quarter.row_of_point[i]] > min_cell_logit)
    {
      indices.push_back(static_cast<std::int32_t>(i));
    }
  }
  if (!indices.empty())
  {
    const auto logits =
        net->segmentPoints(scan, current.encoding, past.encoding, past.scan.rays, cells, indices)
            .cpu()
            .contiguous();
    const float* a = logits.data_ptr<float>();
    for (std::size_t q = 0; q < indices.size(); ++q)
    {
      const auto i = static_cast<std::size_t>(indices[q]);
      result.moving_probability[scan.source[i]] = sigmoid(a[q]);
      result.past_visibility[scan.source[i]] =
          visibilityIn(past.scan.rays, static_flow.motion, scan.points[i]);
    }
  }
  return result;
}
}  // namespace dyslam
