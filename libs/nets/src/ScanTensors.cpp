// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/nets/ScanTensors.h>

#include <algorithm>
#include <cmath>

namespace dyslam
{
namespace
{
torch::Tensor pointTensor(const std::vector<Eigen::Vector3f>& points)
{
  static_assert(sizeof(Eigen::Vector3f) == 3 * sizeof(float));
  torch::Tensor tensor = torch::empty({static_cast<std::int64_t>(points.size()), 3});
  if (!points.empty())
  {
    std::copy_n(points.front().data(), 3 * points.size(), tensor.data_ptr<float>());
  }
  return tensor;
}

/** [N] image cell of each node; -1 for empty ones. */
torch::Tensor cellsOf(const PreparedScan::Level& level)
{
  torch::Tensor cell = torch::empty({static_cast<std::int64_t>(level.size())}, torch::kLong);
  std::copy(level.cell.begin(), level.cell.end(), cell.data_ptr<std::int64_t>());
  return cell;
}
}  // namespace

void updatePoints(const PreparedScan& scan, ScanTensors& tensors)
{
  const torch::Device device = tensors.image_xyz.device();
  const torch::Tensor image = pointTensor(scan.points);
  for (std::size_t l = 0; l < PreparedScan::level_count; ++l)
  {
    ScanTensors::Level& level = tensors.levels[l];
    const torch::Tensor xyz = image.index_select(0, cellsOf(scan.levels[l]).clamp_min(0));
    level.xyz = xyz.to(device) * level.valid.unsqueeze(1);
  }
  tensors.image_xyz = image.to(device);
}

ScanTensors toTensors(const PreparedScan& scan, torch::Device device)
{
  ScanTensors tensors;
  tensors.rows = scan.rows;
  tensors.image_xyz = pointTensor(scan.points);
  torch::Tensor valid = torch::empty({static_cast<std::int64_t>(scan.source.size())});
  std::transform(scan.source.begin(), scan.source.end(), valid.data_ptr<float>(),
                 [](std::int32_t source) { return source >= 0 ? 1.F : 0.F; });
  tensors.image_valid = valid;
  torch::Tensor rows = torch::empty({PreparedScan::slope_bins}, torch::kLong);
  std::copy(scan.row_of_slope.begin(), scan.row_of_slope.end(), rows.data_ptr<std::int64_t>());
  tensors.row_of_slope = rows.to(device);

  const torch::Tensor normals = pointTensor(scan.normals);
  const torch::Tensor planarity =
      torch::tensor(at::ArrayRef<float>(scan.planarity.data(), scan.planarity.size()));
  std::size_t offset = 0;
  for (std::size_t l = 0; l < PreparedScan::level_count; ++l)
  {
    const PreparedScan::Level& level = scan.levels[l];
    ScanTensors::Level& out = tensors.levels[l];
    out.rows = level.rows;
    out.cols = level.cols;
    const torch::Tensor cell = cellsOf(level);
    out.valid = cell.ge(0).to(torch::kFloat);
    out.xyz = tensors.image_xyz.index_select(0, cell.clamp_min(0)) * out.valid.unsqueeze(1);
    if (l == 1)
    {
      out.normal = normals;
      out.planarity = planarity;
    }
    else if (l > 1)
    {
      torch::Tensor node = torch::empty({static_cast<std::int64_t>(level.size())}, torch::kLong);
      std::copy_n(scan.first_level_of.begin() + static_cast<std::ptrdiff_t>(offset), level.size(),
                  node.data_ptr<std::int64_t>());
      offset += level.size();
      node.clamp_min_(0);
      out.normal = normals.index_select(0, node) * out.valid.unsqueeze(1);
      out.planarity = planarity.index_select(0, node) * out.valid;
    }
    if (l > 0)
    {
      out.normal = out.normal.to(device);
      out.planarity = out.planarity.to(device);
    }
    out.xyz = out.xyz.to(device);
    out.valid = out.valid.to(device);
  }
  tensors.image_xyz = tensors.image_xyz.to(device);
  tensors.image_valid = tensors.image_valid.to(device);
  return tensors;
}

PoseTensors PoseTensors::identity(const torch::TensorOptions& options)
{
  return {torch::eye(3, options), torch::zeros({3}, options)};
}

PoseTensors PoseTensors::from(const Pose& pose, const torch::TensorOptions& options)
{
  torch::Tensor rotation = torch::empty({3, 3}, torch::kDouble);
  torch::Tensor translation = torch::empty({3}, torch::kDouble);
  Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(rotation.data_ptr<double>()) =
      pose.linear();
  Eigen::Map<Eigen::Vector3d>(translation.data_ptr<double>()) = pose.translation();
  return {rotation.to(options), translation.to(options)};
}

Pose PoseTensors::toPose() const
{
  const torch::Tensor r = rotation.detach().to(torch::kCPU, torch::kDouble).contiguous();
  const torch::Tensor t = translation.detach().to(torch::kCPU, torch::kDouble).contiguous();
  Pose pose = Pose::Identity();
  pose.linear() =
      Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(r.data_ptr<double>());
  pose.translation() = Eigen::Map<const Eigen::Vector3d>(t.data_ptr<double>());
  return orthonormalised(pose);
}

torch::Tensor PoseTensors::apply(const torch::Tensor& points) const
{
  return torch::matmul(points, rotation.t()) + translation;
}

PoseTensors PoseTensors::operator*(const PoseTensors& other) const
{
  return {torch::matmul(rotation, other.rotation),
          torch::mv(rotation, other.translation) + translation};
}

PoseTensors PoseTensors::detached() const
{
  return {rotation.detach(), translation.detach()};
}

Window windowAround(const torch::Tensor& points,
                    const ScanTensors& scan,
                    std::int64_t rows,
                    std::int64_t cols,
                    std::int64_t half_rows,
                    std::int64_t half_cols,
                    const torch::Tensor& dilation)
{
  const torch::NoGradGuard no_grad;
  const torch::Tensor x = points.select(1, 0);
  const torch::Tensor y = points.select(1, 1);
  const torch::Tensor slope = points.select(1, 2) / torch::hypot(x, y).clamp_min(1e-3);
  const torch::Tensor bin = ((slope + 1) * (PreparedScan::slope_bins / 2))
                                .clamp(0, PreparedScan::slope_bins - 1)
                                .to(torch::kLong);
  const torch::Tensor image_row = scan.row_of_slope.index_select(0, bin);
  const torch::Tensor row = torch::floor_divide(image_row * rows, scan.rows);
  const torch::Tensor turn = (M_PI - torch::atan2(y, x)) * (static_cast<double>(cols) / (2 * M_PI));
  const torch::Tensor col = turn.to(torch::kLong).clamp(0, cols - 1);

  const auto integers = col.options();
  const torch::Tensor row_offset =
      torch::arange(-half_rows, half_rows + 1, integers).repeat_interleave(2 * half_cols + 1);
  torch::Tensor col_offset =
      torch::arange(-half_cols, half_cols + 1, integers).repeat({2 * half_rows + 1}).unsqueeze(0);
  if (dilation.defined())
  {
    col_offset = col_offset * dilation.unsqueeze(1);
  }
  const torch::Tensor window_row = row.unsqueeze(1) + row_offset.unsqueeze(0);
  const torch::Tensor window_col = torch::remainder(col.unsqueeze(1) + col_offset, cols);
  Window window;
  window.inside = window_row.ge(0).logical_and(window_row.lt(rows)).to(points.scalar_type());
  window.index = window_row.clamp(0, rows - 1) * cols + window_col;
  return window;
}

Window windowBetween(std::int64_t from_rows,
                     std::int64_t from_cols,
                     std::int64_t to_rows,
                     std::int64_t to_cols,
                     std::int64_t window_rows,
                     std::int64_t window_cols,
                     torch::Device device)
{
  // First node of the window of `count` nodes with the centre nearest to that of `node`.
  const auto start = [](std::int64_t node, std::int64_t from, std::int64_t to, std::int64_t count)
  {
    const double middle =
        (static_cast<double>(node) + 0.5) * static_cast<double>(from) / static_cast<double>(to);
    return static_cast<std::int64_t>(std::floor(middle - 0.5 * static_cast<double>(count) + 0.5));
  };
  const std::int64_t nodes = to_rows * to_cols;
  const std::int64_t window = window_rows * window_cols;
  torch::Tensor index = torch::empty({nodes, window}, torch::kLong);
  torch::Tensor inside = torch::empty({nodes, window});
  auto index_at = index.accessor<std::int64_t, 2>();
  auto inside_at = inside.accessor<float, 2>();
  for (std::int64_t node = 0; node < nodes; ++node)
  {
    const std::int64_t row0 = start(node / to_cols, from_rows, to_rows, window_rows);
    const std::int64_t col0 = start(node % to_cols, from_cols, to_cols, window_cols);
    for (std::int64_t k = 0; k < window; ++k)
    {
      const std::int64_t row = row0 + k / window_cols;
      const std::int64_t col = (col0 + k % window_cols + 2 * from_cols) % from_cols;
      const bool in_grid = row >= 0 && row < from_rows;
      index_at[node][k] = std::min(std::max<std::int64_t>(row, 0), from_rows - 1) * from_cols + col;
      inside_at[node][k] = in_grid ? 1.F : 0.F;
    }
  }
  return {index.to(device), inside.to(device)};
}

torch::Tensor gather(const torch::Tensor& values, const torch::Tensor& index)
{
  return values.index_select(0, index.reshape({-1}))
      .reshape({index.size(0), index.size(1), values.size(1)});
}
}  // namespace dyslam
