// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/nets/GaussNewton.h>
#include <dyslam/nets/Grouping.h>

#include <cmath>

namespace dyslam::reference
{
Neighbours nearestInWindow(const torch::Tensor& points,
                           const torch::Tensor& valid,
                           const ScanTensors& scan,
                           std::size_t level,
                           std::int64_t half_rows,
                           std::int64_t half_cols,
                           std::int64_t count)
{
  const torch::NoGradGuard no_grad;
  const ScanTensors::Level& grid = scan.levels[level];
  const Window window = windowAround(points, scan, grid.rows, grid.cols, half_rows, half_cols);
  const torch::Tensor usable =
      grid.valid.index_select(0, window.index.reshape({-1})).reshape(window.index.sizes()) *
      window.inside * valid.unsqueeze(1);
  const torch::Tensor distance =
      (gather(grid.xyz, window.index) - points.unsqueeze(1)).square().sum(2) + (1 - usable) * 1e8;
  const torch::Tensor nearest = std::get<1>(distance.topk(count, 1, false, true));
  return {window.index.gather(1, nearest), usable.gather(1, nearest)};
}

torch::Tensor groupOffsets(const torch::Tensor& xyz,
                           const torch::Tensor& centre,
                           const torch::Tensor& index,
                           double spacing)
{
  const torch::Tensor unit = centre.norm(2, 1, true) * spacing + 0.2;
  return ((gather(xyz, index) - centre.unsqueeze(1)) / unit.unsqueeze(1)).clamp(-8, 8);
}

Candidates candidateGeometry(const torch::Tensor& warped,
                             const torch::Tensor& warped_normal,
                             const ScanTensors::Level& grid,
                             const torch::Tensor& index,
                             double spacing)
{
  const torch::NoGradGuard no_grad;
  const std::int64_t n = index.size(0);
  const std::int64_t k = index.size(1);
  const torch::Tensor q = gather(grid.xyz, index);
  const torch::Tensor normal = gather(grid.normal, index);
  const torch::Tensor d = groupOffsets(grid.xyz, warped, index, spacing);
  const torch::Tensor range = warped.norm(2, 1, true);
  Candidates result;
  result.geometry = torch::cat({d, d.norm(2, 2, true), (normal * d).sum(2, true),
                                (normal * warped_normal.unsqueeze(1)).sum(2, true),
                                (warped / (range + 1)).unsqueeze(1).expand({n, k, 3}),
                                (torch::log1p(range) / 4).unsqueeze(1).expand({n, k, 1})},
                               2);
  result.planes = torch::cat({normal, (normal * q).sum(2, true), q}, 2);
  return result;
}

Surfaces surfacesAround(const torch::Tensor& warped,
                        const torch::Tensor& warped_normal,
                        const torch::Tensor& valid,
                        const ScanTensors& scan)
{
  const torch::NoGradGuard no_grad;
  const torch::Tensor range = warped.norm(2, 1);
  // Windows about 0.8 m wide at any range.
  const torch::Tensor dilation =
      (0.1 / (range * (2 * M_PI / PreparedScan::columns)).clamp_min(1e-3))
          .round()
          .clamp(1, 16)
          .to(torch::kLong);
  const Window around =
      windowAround(warped, scan, scan.rows, PreparedScan::columns, 1, 4, dilation);
  const torch::Tensor usable =
      scan.image_valid.index_select(0, around.index.reshape({-1})).reshape(around.index.sizes()) *
      around.inside * valid.unsqueeze(1);
  const torch::Tensor d = gather(scan.image_xyz, around.index) - warped.unsqueeze(1);
  const torch::Tensor distance2 = d.square().sum(2);

  const torch::Tensor gate = 0.5 + 0.05 * range;
  torch::Tensor near = usable / (1 + distance2 / gate.square().unsqueeze(1));
  near = near * near.gt(0.1);
  const torch::Tensor weight_sum = near.sum(1);
  const torch::Tensor share = near / weight_sum.clamp_min(1e-6).unsqueeze(1);
  const torch::Tensor mean = (share.unsqueeze(2) * d).sum(1);
  const torch::Tensor centred = (d - mean.unsqueeze(1)) * share.sqrt().unsqueeze(2);
  const PlaneFit plane = fitPlanes(torch::matmul(centred.transpose(1, 2), centred));

  const torch::Tensor width = 0.087 + 0.0116 * range;
  const torch::Tensor used = near.gt(0).to(near.scalar_type());
  const torch::Tensor least = (distance2 + (1 - used) * 1e8).amin(1, true);
  torch::Tensor attention =
      used * torch::exp(-0.5 * (distance2 - least).clamp_min(0) / width.square().unsqueeze(1));
  attention = attention / attention.sum(1, true).clamp_min(1);
  const torch::Tensor to_surface = (attention.unsqueeze(2) * d).sum(1);

  Surfaces result;
  result.normal = plane.normal;
  result.target = warped + to_surface;
  result.offset = (plane.normal * result.target).sum(1);
  result.valid = valid * weight_sum.gt(1.5).to(valid.scalar_type());
  const torch::Tensor thickness = plane.spread.select(1, 0);
  result.thickness = thickness * valid;
  if (!warped_normal.defined())
  {
    return result;
  }
  const torch::Tensor residual = (plane.normal * to_surface).sum(1).abs();
  const torch::Tensor width1 = plane.spread.select(1, 1);
  result.features =
      torch::stack({torch::asinh(residual / 0.05) / 3, torch::asinh(residual / 0.5),
                    thickness / (width1 + thickness + 1e-3), torch::asinh(thickness / 0.05) / 3,
                    width1 / (plane.spread.select(1, 2) + 1e-3), to_surface.norm(2, 1) / gate,
                    weight_sum / 27, (plane.normal * warped).sum(1).abs() / (range + 1e-3),
                    (plane.normal * warped_normal).sum(1).abs(), torch::log1p(range) / 4},
                   1);
  return result;
}

torch::Tensor groupedLinear(const torch::Tensor& geometry,
                            const torch::Tensor& features,
                            const torch::Tensor& index,
                            const torch::Tensor& weight,
                            const torch::Tensor& bias,
                            double slope,
                            const torch::Tensor& own)
{
  const torch::Tensor x =
      features.defined() ? torch::cat({geometry, gather(features, index)}, 2) : geometry;
  torch::Tensor y = torch::matmul(x, weight.t()) + bias;
  if (own.defined())
  {
    y = y + own.unsqueeze(1);
  }
  return slope != 1 ? torch::leaky_relu(y, slope) : y;
}

torch::Tensor groupMax(const torch::Tensor& x, const torch::Tensor& usable)
{
  const torch::Tensor none = usable.sum(1, true).eq(0);
  return (x + (usable.unsqueeze(2) - 1) * 1e4).amax(1).masked_fill(none, 0);
}

torch::Tensor attendedSum(const torch::Tensor& attention, const torch::Tensor& values)
{
  return torch::bmm(attention.unsqueeze(1), values).squeeze(1);
}
}  // namespace dyslam::reference
