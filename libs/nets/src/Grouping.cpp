// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/FastAngle.h>
#include <dyslam/nets/Grouping.h>
#include <dyslam/nets/Threads.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "TensorViews.h"

namespace dyslam
{
namespace
{
constexpr std::int64_t grain = 256;

using Point = Eigen::Map<const Eigen::Vector3f>;

Point pointAt(const float* data, std::int64_t i)
{
  return Point(data + 3 * i);
}

/** Projection of a direction into scan 2's image: row and fraction of a revolution. */
struct ImagePosition
{
  std::int64_t row = 0;
  float turn = 0;  //!< [0, 1)

  ImagePosition(const Eigen::Vector3f& p, const std::int64_t* row_of_slope)
  {
    const float flat = std::max(p.head<2>().norm(), 1e-3F);
    row = row_of_slope[slopeBin(p.z() / flat)];
    turn = 0.5F - turnsOf(p.y(), p.x());
  }
  [[nodiscard]] std::int64_t col(std::int64_t cols) const
  {
    return std::clamp<std::int64_t>(
        static_cast<std::int64_t>(std::max(0.F, turn * static_cast<float>(cols))), 0, cols - 1);
  }
};

std::int64_t wrapColumn(std::int64_t col, std::int64_t cols)
{
  return col < 0 ? col + cols : (col >= cols ? col - cols : col);
}
}  // namespace

Neighbours nearestInWindow(const torch::Tensor& points,
                           const torch::Tensor& valid,
                           const ScanTensors& scan,
                           std::size_t level,
                           std::int64_t half_rows,
                           std::int64_t half_cols,
                           std::int64_t count)
{
  if (!onCpu(points))
  {
    return reference::nearestInWindow(points, valid, scan, level, half_rows, half_cols, count);
  }
  const torch::NoGradGuard no_grad;
  const ScanTensors::Level& grid = scan.levels[level];
  const torch::Tensor p_all = points.contiguous();
  const std::int64_t n = points.size(0);
  Neighbours result{torch::zeros({n, count}, torch::kLong), torch::zeros({n, count})};
  const float* p_data = p_all.data_ptr<float>();
  const float* q_data = grid.xyz.data_ptr<float>();
  const float* q_valid = grid.valid.data_ptr<float>();
  const torch::Tensor valid_all = valid.contiguous();
  const float* p_valid = valid_all.data_ptr<float>();
  const std::int64_t* row_of_slope = scan.row_of_slope.data_ptr<std::int64_t>();
  std::int64_t* index = result.index.data_ptr<std::int64_t>();
  float* usable = result.usable.data_ptr<float>();
  forRows(n, grain,
          [&](std::int64_t begin, std::int64_t end)
          {
            std::vector<std::pair<float, std::int64_t>> found;
            for (std::int64_t i = begin; i < end; ++i)
            {
              const Eigen::Vector3f p = pointAt(p_data, i);
              if (p_valid[i] == 0 || !p.allFinite())
              {
                continue;
              }
              const ImagePosition place(p, row_of_slope);
              const std::int64_t row0 = place.row * grid.rows / scan.rows;
              const std::int64_t col0 = place.col(grid.cols);
              found.clear();
              for (std::int64_t row = std::max<std::int64_t>(0, row0 - half_rows);
                   row <= std::min(grid.rows - 1, row0 + half_rows); ++row)
              {
                for (std::int64_t col = col0 - half_cols; col <= col0 + half_cols; ++col)
                {
                  const std::int64_t node = row * grid.cols + wrapColumn(col, grid.cols);
                  if (q_valid[node] != 0)
                  {
                    found.emplace_back((pointAt(q_data, node) - p).squaredNorm(), node);
                  }
                }
              }
              const auto kept =
                  std::min<std::size_t>(found.size(), static_cast<std::size_t>(count));
              std::partial_sort(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(kept),
                                found.end());
              for (std::size_t k = 0; k < kept; ++k)
              {
                index[i * count + static_cast<std::int64_t>(k)] = found[k].second;
                usable[i * count + static_cast<std::int64_t>(k)] = 1;
              }
            }
          });
  return result;
}

torch::Tensor groupOffsets(const torch::Tensor& xyz,
                           const torch::Tensor& centre,
                           const torch::Tensor& index,
                           double spacing)
{
  if (!onCpu(xyz))
  {
    return reference::groupOffsets(xyz, centre, index, spacing);
  }
  const torch::NoGradGuard no_grad;
  const std::int64_t n = index.size(0);
  const std::int64_t k = index.size(1);
  torch::Tensor result = torch::empty({n, k, 3});
  const torch::Tensor centres = centre.contiguous();
  const torch::Tensor from = xyz.contiguous();
  const torch::Tensor nodes = index.contiguous();
  const float* c_data = centres.data_ptr<float>();
  const float* q_data = from.data_ptr<float>();
  const std::int64_t* node = nodes.data_ptr<std::int64_t>();
  float* out = result.data_ptr<float>();
  forRows(n, grain,
          [&](std::int64_t begin, std::int64_t end)
          {
            for (std::int64_t i = begin; i < end; ++i)
            {
              const Eigen::Vector3f c = pointAt(c_data, i);
              const float scale = 1 / (c.norm() * static_cast<float>(spacing) + 0.2F);
              for (std::int64_t j = i * k; j < (i + 1) * k; ++j)
              {
                Eigen::Map<Eigen::Vector3f>(out + 3 * j) =
                    ((pointAt(q_data, node[j]) - c) * scale).cwiseMax(-8).cwiseMin(8);
              }
            }
          });
  return result;
}

Candidates candidateGeometry(const torch::Tensor& warped,
                             const torch::Tensor& warped_normal,
                             const ScanTensors::Level& grid,
                             const torch::Tensor& index,
                             double spacing)
{
  if (!onCpu(warped))
  {
    return reference::candidateGeometry(warped, warped_normal, grid, index, spacing);
  }
  const torch::NoGradGuard no_grad;
  const std::int64_t n = index.size(0);
  const std::int64_t k = index.size(1);
  Candidates result{torch::empty({n, k, Candidates::geometry_size}), torch::empty({n, k, 7})};
  const torch::Tensor points = warped.contiguous();
  const torch::Tensor normals = warped_normal.contiguous();
  const float* p_data = points.data_ptr<float>();
  const float* n_data = normals.data_ptr<float>();
  const float* q_data = grid.xyz.data_ptr<float>();
  const float* m_data = grid.normal.data_ptr<float>();
  const torch::Tensor nodes = index.contiguous();
  const std::int64_t* node = nodes.data_ptr<std::int64_t>();
  float* geometry = result.geometry.data_ptr<float>();
  float* planes = result.planes.data_ptr<float>();
  forRows(n, grain,
          [&](std::int64_t begin, std::int64_t end)
          {
            for (std::int64_t i = begin; i < end; ++i)
            {
              const Eigen::Vector3f p = pointAt(p_data, i);
              const Eigen::Vector3f own = pointAt(n_data, i);
              const float range = p.norm();
              const float scale = 1 / (range * static_cast<float>(spacing) + 0.2F);
              const Eigen::Vector3f direction = p / (range + 1);
              const float depth = std::log1p(range) / 4;
              for (std::int64_t j = i * k; j < (i + 1) * k; ++j)
              {
                const Eigen::Vector3f q = pointAt(q_data, node[j]);
                const Eigen::Vector3f m = pointAt(m_data, node[j]);
                const Eigen::Vector3f d = ((q - p) * scale).cwiseMax(-8).cwiseMin(8);
                float* g = geometry + Candidates::geometry_size * j;
                Eigen::Map<Eigen::Vector3f>{g} = d;
                g[3] = d.norm();
                g[4] = m.dot(d);
                g[5] = m.dot(own);
                Eigen::Map<Eigen::Vector3f>(g + 6) = direction;
                g[9] = depth;
                float* plane = planes + 7 * j;
                Eigen::Map<Eigen::Vector3f>{plane} = m;
                plane[3] = m.dot(q);
                Eigen::Map<Eigen::Vector3f>(plane + 4) = q;
              }
            }
          });
  return result;
}

namespace
{
/** The full-resolution image of scan 2 as plain arrays. */
struct ImageView
{
  const float* xyz;
  const float* valid;
  const std::int64_t* row_of_slope;
  std::int64_t rows;
};

struct Surface
{
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();
  Eigen::Vector3f spread = Eigen::Vector3f::Zero();
  Eigen::Vector3f to_surface = Eigen::Vector3f::Zero();
  float weight_sum = 0;
};

/** Largest distance of a surface from the point [m]. */
float gateAt(float range)
{
  return 0.5F + 0.05F * range;
}

Surface surfaceAround(const Eigen::Vector3f& p, const ImageView& image)
{
  const float range = p.norm();
  constexpr std::int64_t cols = PreparedScan::columns;
  const ImagePosition place(p, image.row_of_slope);
  const std::int64_t col0 = place.col(cols);
  const float step =
      std::max(range * (2 * static_cast<float>(M_PI) / static_cast<float>(cols)), 1e-3F);
  const auto dilation =
      std::clamp<std::int64_t>(static_cast<std::int64_t>(std::nearbyint(0.1F / step)), 1, 16);
  const float gate = gateAt(range);
  const float width = 0.087F + 0.0116F * range;

  // Offsets from p to the points of the window within the gate; unused entries are far away.
  constexpr int places = 32;
  using Places = Eigen::Array<float, places, 1>;
  Places x = Places::Zero();
  Places y = Places::Zero();
  Places z = Places::Zero();
  Places distance2 = Places::Constant(1e12F);
  int count = 0;
  for (std::int64_t row = std::max<std::int64_t>(0, place.row - 1);
       row <= std::min(image.rows - 1, place.row + 1); ++row)
  {
    for (std::int64_t k = -4; k <= 4; ++k)
    {
      const std::int64_t cell = row * cols + wrapColumn(col0 + k * dilation, cols);
      const Eigen::Vector3f d = pointAt(image.xyz, cell) - p;
      const float d2 = d.squaredNorm();
      if (image.valid[cell] != 0 && d2 < 9 * gate * gate)
      {
        x[count] = d.x();
        y[count] = d.y();
        z[count] = d.z();
        distance2[count++] = d2;
      }
    }
  }
  Surface surface;
  if (count == 0)
  {
    return surface;
  }
  const Places near = (1 + distance2 / (gate * gate)).inverse();
  surface.weight_sum = near.sum();
  // Weights relative to the nearest point's, so that those of a distant surface do not underflow.
  const Places attention = (-0.5F / (width * width) * (distance2 - distance2.minCoeff())).exp();
  surface.to_surface =
      Eigen::Vector3f((attention * x).sum(), (attention * y).sum(), (attention * z).sum()) /
      std::max(attention.sum(), 1.F);
  const Places share = near / surface.weight_sum;
  const Places sx = share * x;
  const Places sy = share * y;
  const Places sz = share * z;
  const Eigen::Vector3f mean(sx.sum(), sy.sum(), sz.sum());
  Eigen::Matrix3f covariance;
  covariance << (sx * x).sum(), (sx * y).sum(), (sx * z).sum(),  //
      0, (sy * y).sum(), (sy * z).sum(),                         //
      0, 0, (sz * z).sum();
  covariance =
      Eigen::Matrix3f(covariance.selfadjointView<Eigen::Upper>()) - mean * mean.transpose();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver;
  solver.computeDirect(covariance);
  surface.spread = solver.eigenvalues().cwiseMax(0).cwiseSqrt();
  surface.normal = solver.eigenvectors().col(0);
  if (!surface.normal.allFinite())
  {
    surface.normal.setZero();
  }
  return surface;
}

/** Surfaces::features of a point `p` with its own normal. */
std::array<float, Surfaces::feature_size> describe(const Surface& s,
                                                   const Eigen::Vector3f& p,
                                                   const Eigen::Vector3f& own_normal)
{
  const float range = p.norm();
  const float residual = std::abs(s.normal.dot(s.to_surface));
  return {std::asinh(residual / 0.05F) / 3,
          std::asinh(residual / 0.5F),
          s.spread[0] / (s.spread[1] + s.spread[0] + 1e-3F),
          std::asinh(s.spread[0] / 0.05F) / 3,
          s.spread[1] / (s.spread[2] + 1e-3F),
          s.to_surface.norm() / gateAt(range),
          s.weight_sum / 27,
          std::abs(s.normal.dot(p)) / (range + 1e-3F),
          std::abs(s.normal.dot(own_normal)),
          std::log1p(range) / 4};
}
}  // namespace

Surfaces surfacesAround(const torch::Tensor& warped,
                        const torch::Tensor& warped_normal,
                        const torch::Tensor& valid,
                        const ScanTensors& scan)
{
  if (!onCpu(warped))
  {
    return reference::surfacesAround(warped, warped_normal, valid, scan);
  }
  const torch::NoGradGuard no_grad;
  const std::int64_t n = warped.size(0);
  Surfaces result{torch::zeros({n, 3}), torch::zeros({n, 3}), torch::zeros({n}), {},
                  torch::zeros({n}),    torch::zeros({n})};
  const torch::Tensor points = warped.contiguous();
  const float* p_data = points.data_ptr<float>();
  torch::Tensor normals;
  const float* n_data = nullptr;
  float* features = nullptr;
  if (warped_normal.defined())
  {
    normals = warped_normal.contiguous();
    n_data = normals.data_ptr<float>();
    result.features = torch::zeros({n, Surfaces::feature_size});
    features = result.features.data_ptr<float>();
  }
  const torch::Tensor valid_all = valid.contiguous();
  const float* p_valid = valid_all.data_ptr<float>();
  const ImageView image{scan.image_xyz.data_ptr<float>(), scan.image_valid.data_ptr<float>(),
                        scan.row_of_slope.data_ptr<std::int64_t>(), scan.rows};
  float* normal = result.normal.data_ptr<float>();
  float* target = result.target.data_ptr<float>();
  float* offset = result.offset.data_ptr<float>();
  float* thickness = result.thickness.data_ptr<float>();
  float* found = result.valid.data_ptr<float>();
  forRows(n, grain,
          [&](std::int64_t begin, std::int64_t end)
          {
            for (std::int64_t i = begin; i < end; ++i)
            {
              const Eigen::Vector3f p = pointAt(p_data, i);
              if (p_valid[i] == 0 || !p.allFinite())
              {
                continue;
              }
              const Surface s = surfaceAround(p, image);
              const Eigen::Vector3f y = p + s.to_surface;
              Eigen::Map<Eigen::Vector3f>(normal + 3 * i) = s.normal;
              Eigen::Map<Eigen::Vector3f>(target + 3 * i) = y;
              offset[i] = s.normal.dot(y);
              thickness[i] = s.spread[0];
              found[i] = s.weight_sum > 1.5F ? 1.F : 0.F;
              if (features != nullptr)
              {
                const auto values = describe(s, p, pointAt(n_data, i));
                std::copy(values.begin(), values.end(), features + Surfaces::feature_size * i);
              }
            }
          });
  return result;
}
}  // namespace dyslam
