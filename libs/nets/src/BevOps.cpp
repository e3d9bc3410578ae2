// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/nets/BevOps.h>
#include <dyslam/nets/CellLayers.h>
#include <dyslam/nets/Threads.h>
#include <torch/torch.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace dyslam
{
namespace
{
using torch::Tensor;
using torch::autograd::AutogradContext;
using torch::autograd::tensor_list;

class PillarMax : public torch::autograd::Function<PillarMax>
{
 public:
  static Tensor forward(AutogradContext* context,
                        const Tensor& features,
                        const Tensor& cell,
                        std::int64_t cells)
  {
    const auto channels = features.size(1);
    const auto values = features.contiguous();
    auto out = torch::zeros({cells, channels}, values.options());
    const bool wanted = features.requires_grad();
    auto winner = wanted ? torch::full({cells, channels}, -1, torch::kInt32) : Tensor();
    const float* in = values.data_ptr<float>();
    const auto* to = cell.data_ptr<std::int32_t>();
    auto* best = out.data_ptr<float>();
    auto* argmax = wanted ? winner.data_ptr<std::int32_t>() : nullptr;
    for (std::int64_t i = 0; i < features.size(0); ++i)
    {
      const float* f = in + i * channels;
      float* b = best + to[i] * channels;
      if (argmax == nullptr)
      {
        for (std::int64_t c = 0; c < channels; ++c)
        {
          b[c] = f[c] > b[c] ? f[c] : b[c];
        }
        continue;
      }
      for (std::int64_t c = 0; c < channels; ++c)
      {
        if (f[c] > b[c])
        {
          b[c] = f[c];
          argmax[to[i] * channels + c] = static_cast<std::int32_t>(i);
        }
      }
    }
    context->saved_data["points"] = features.size(0);
    if (wanted)
    {
      context->save_for_backward({winner, cell});
    }
    return out;
  }

  static tensor_list backward(AutogradContext* context, const tensor_list& gradients)
  {
    const auto saved = context->get_saved_variables();
    const auto gradient = gradients[0].contiguous();
    const auto channels = gradient.size(1);
    auto out = torch::zeros({context->saved_data["points"].toInt(), channels}, gradient.options());
    const auto* argmax = saved[0].data_ptr<std::int32_t>();
    const auto* cell = saved[1].data_ptr<std::int32_t>();
    const float* g = gradient.data_ptr<float>();
    float* o = out.data_ptr<float>();
    for (std::int64_t i = 0; i < out.size(0); ++i)
    {
      const std::int64_t base = cell[i] * channels;
      for (std::int64_t c = 0; c < channels; ++c)
      {
        if (argmax[base + c] == i)
        {
          o[i * channels + c] = g[base + c];
        }
      }
    }
    return {out, Tensor(), Tensor()};
  }
};

/** Upper left corner of one cell's window in the target, with the bilinear weights. */
struct CorrelationWindow
{
  std::int64_t x = 0;
  std::int64_t y = 0;
  float fx = 0;
  float fy = 0;
};

CorrelationWindow windowAt(const float* centre, int radius)
{
  // Clamped, so that the conversion to integers is defined.
  constexpr float far_away = 1e6F;
  const float cx = std::isfinite(centre[0]) ? std::clamp(centre[0], -far_away, far_away) : far_away;
  const float cy = std::isfinite(centre[1]) ? std::clamp(centre[1], -far_away, far_away) : far_away;
  CorrelationWindow w;
  w.x = static_cast<std::int64_t>(std::floor(cx)) - radius;
  w.y = static_cast<std::int64_t>(std::floor(cy)) - radius;
  w.fx = cx - std::floor(cx);
  w.fy = cy - std::floor(cy);
  return w;
}

constexpr std::size_t largest_window = 21 * 21;  // cells of a window of radius 10

using RowArray = Eigen::Map<Eigen::ArrayXf>;
using ConstRow = Eigen::Map<const Eigen::ArrayXf>;

/** SparseMap as plain arrays. */
struct WindowTarget
{
  const float* rows;
  const float* empty;  //!< features of an empty cell
  const std::int32_t* index;
  std::int64_t height;
  std::int64_t width;
  std::int64_t channels;
};

/** Dot products of a cell's features with those of the (2 radius + 2)^2 cells around the window's
 * sampling positions.
 *
 * \tparam channels compile-time constant, to keep the features in registers; or Eigen::Dynamic */
template <int channels>
void windowProducts(const float* source,
                    const WindowTarget& target,
                    const CorrelationWindow& w,
                    std::int64_t side,
                    float* out)
{
  using Features = Eigen::Array<float, channels, 1>;
  using ConstFeatures = Eigen::Map<const Features>;
  const Features source_features =
      ConstFeatures(source, target.channels) / std::sqrt(static_cast<float>(target.channels));
  const float empty_product =
      (source_features * ConstFeatures(target.empty, target.channels)).sum();
  const auto first = std::clamp<std::int64_t>(-w.x, 0, side);
  const auto last = std::clamp<std::int64_t>(target.width - w.x, first, side);
  for (std::int64_t y = w.y; y < w.y + side; ++y, out += side)
  {
    if (y < 0 || y >= target.height)
    {
      std::fill_n(out, side, 0.0F);
      continue;
    }
    std::fill_n(out, first, 0.0F);
    std::fill(out + last, out + side, 0.0F);
    const std::int32_t* row = target.index + y * target.width;
    for (std::int64_t x = first; x < last; ++x)
    {
      const auto cell = row[w.x + x];
      out[x] = cell < 0 ? empty_product
                        : (source_features *
                           ConstFeatures(target.rows + cell * target.channels, target.channels))
                              .sum();
    }
  }
}

class Correlate : public torch::autograd::Function<Correlate>
{
 public:
  static Tensor forward(AutogradContext* context,
                        const Tensor& source_in,
                        const Tensor& target_in,
                        const Tensor& index_in,
                        const Tensor& empty_in,
                        const Tensor& centre_in,
                        std::int64_t radius_in)
  {
    const auto source = source_in.contiguous();
    const auto target = target_in.contiguous();
    const auto index = index_in.contiguous();
    const auto empty = empty_in.contiguous();
    const auto centre = centre_in.contiguous();
    const int radius = static_cast<int>(radius_in);
    const std::int64_t side = 2 * radius + 1;
    const auto channels = source.size(1);
    const auto height = index.size(0);
    const auto width = index.size(1);
    auto out = torch::empty({source.size(0), side * side}, source.options());
    const WindowTarget map = {target.data_ptr<float>(),
                              empty.data_ptr<float>(),
                              index.data_ptr<std::int32_t>(),
                              height,
                              width,
                              channels};
    const auto products = channels == 32   ? &windowProducts<32>
                          : channels == 16 ? &windowProducts<16>
                                           : &windowProducts<Eigen::Dynamic>;
    const float* s = source.data_ptr<float>();
    const float* c = centre.data_ptr<float>();
    float* o = out.data_ptr<float>();
    forRows(source.size(0), 128,
            [&](std::int64_t begin, std::int64_t end)
            {
              std::vector<float> dots(static_cast<std::size_t>((side + 1) * (side + 1)));
              for (std::int64_t i = begin; i < end; ++i)
              {
                const CorrelationWindow w = windowAt(c + 2 * i, radius);
                products(s + i * channels, map, w, side + 1, dots.data());
                for (std::int64_t y = 0; y < side; ++y)
                {
                  const float* upper = &dots[static_cast<std::size_t>(y * (side + 1))];
                  const float* lower = upper + side + 1;
                  for (std::int64_t x = 0; x < side; ++x)
                  {
                    o[(i * side + y) * side + x] =
                        (1 - w.fy) * ((1 - w.fx) * upper[x] + w.fx * upper[x + 1]) +
                        w.fy * ((1 - w.fx) * lower[x] + w.fx * lower[x + 1]);
                  }
                }
              }
            });
    context->saved_data["radius"] = radius_in;
    context->save_for_backward({source, target, index, centre, empty});
    return out;
  }

  static tensor_list backward(AutogradContext* context, const tensor_list& gradients)
  {
    const auto saved = context->get_saved_variables();
    const auto& source = saved[0];
    const auto& target = saved[1];
    const auto& index = saved[2];
    const auto gradient = gradients[0].contiguous();
    const int radius = static_cast<int>(context->saved_data["radius"].toInt());
    const std::int64_t side = 2 * radius + 1;
    const auto channels = source.size(1);
    const auto height = index.size(0);
    const auto width = index.size(1);
    auto to_source = torch::zeros_like(source);
    auto to_target = torch::zeros_like(target);
    auto to_empty = torch::zeros_like(saved[4]);
    const ConstRow empty_features(saved[4].data_ptr<float>(), channels);
    RowArray empty_gradient(to_empty.data_ptr<float>(), channels);
    const float scale = 1.0F / std::sqrt(static_cast<float>(channels));
    const float* g = gradient.data_ptr<float>();
    const float* s = source.data_ptr<float>();
    const float* t = target.data_ptr<float>();
    const auto* row = index.data_ptr<std::int32_t>();
    float* gs = to_source.data_ptr<float>();
    float* gt = to_target.data_ptr<float>();
    std::vector<float> corners(static_cast<std::size_t>((side + 1) * (side + 1)));
    for (std::int64_t i = 0; i < source.size(0); ++i)
    {
      const CorrelationWindow w = windowAt(saved[3].data_ptr<float>() + 2 * i, radius);
      std::fill(corners.begin(), corners.end(), 0.0F);
      for (std::int64_t y = 0; y < side; ++y)
      {
        float* upper = &corners[static_cast<std::size_t>(y * (side + 1))];
        float* lower = upper + side + 1;
        for (std::int64_t x = 0; x < side; ++x)
        {
          const float v = g[(i * side + y) * side + x] * scale;
          upper[x] += (1 - w.fy) * (1 - w.fx) * v;
          upper[x + 1] += (1 - w.fy) * w.fx * v;
          lower[x] += w.fy * (1 - w.fx) * v;
          lower[x + 1] += w.fy * w.fx * v;
        }
      }
      const ConstRow source_features(s + i * channels, channels);
      RowArray source_gradient(gs + i * channels, channels);
      float on_empty = 0;
      for (std::int64_t y = 0; y <= side; ++y)
      {
        for (std::int64_t x = 0; x <= side; ++x)
        {
          const auto tx = w.x + x;
          const auto ty = w.y + y;
          if (tx < 0 || ty < 0 || tx >= width || ty >= height)
          {
            continue;
          }
          const float v = corners[static_cast<std::size_t>(y * (side + 1) + x)];
          const auto place = row[ty * width + tx] * channels;
          if (place < 0)
          {
            on_empty += v;
            continue;
          }
          source_gradient += v * ConstRow(t + place, channels);
          RowArray(gt + place, channels) += v * source_features;
        }
      }
      source_gradient += on_empty * empty_features;
      empty_gradient += on_empty * source_features;
    }
    return {to_source, to_target, Tensor(), to_empty, Tensor(), Tensor()};
  }
};

Tensor pillarMaxOnDevice(const Tensor& features, const Tensor& cell, std::int64_t cells)
{
  const auto index = cell.to(torch::kInt64).unsqueeze(1).expand_as(features);
  return torch::zeros({cells, features.size(1)}, features.options())
      .scatter_reduce(0, index, features, "amax", true);
}

Tensor windowOffsets(int radius, const torch::TensorOptions& options)
{
  const auto line = torch::arange(-radius, radius + 1, options);
  const auto grid = torch::meshgrid({line, line}, "ij");
  return torch::stack({grid[1].reshape({-1}), grid[0].reshape({-1})}, 1);
}
}  // namespace

Tensor pillarMax(const Tensor& features, const Tensor& cell, std::int64_t cells)
{
  return features.is_cuda() ? pillarMaxOnDevice(features, cell, cells)
                            : PillarMax::apply(features, cell, cells);
}

Tensor correlate(const Tensor& source, const SparseMap& target, const Tensor& centre, int radius)
{
  return source.is_cuda()
             ? correlateReference(source, target, centre, radius)
             : Correlate::apply(source, target.rows, target.index, target.empty, centre, radius);
}

Tensor correlateReference(const Tensor& source,
                          const SparseMap& target,
                          const Tensor& centre,
                          int radius)
{
  namespace F = torch::nn::functional;
  const auto height = target.index.size(0);
  const auto width = target.index.size(1);
  const auto table = target.index.view({-1, 1});
  const auto rows =
      gatherRows(target.rows, table) + table.lt(0).to(target.rows.dtype()) * target.empty;
  const auto map = rows.view({1, height, width, -1}).permute({0, 3, 1, 2});
  const auto offsets = windowOffsets(radius, source.options());
  const auto places = centre.detach().unsqueeze(1) + offsets.unsqueeze(0);  // N x K x 2
  // grid_sample without aligned corners: cell i's centre is at (2 i + 1) / size - 1.
  const auto size =
      torch::tensor({static_cast<float>(width), static_cast<float>(height)}, source.options());
  const auto grid = (2 * places + 1) / size - 1;
  const auto sampled =
      F::grid_sample(map, grid.unsqueeze(0),
                     F::GridSampleFuncOptions().align_corners(false).padding_mode(torch::kZeros));
  return torch::einsum("nc,cnk->nk", {source, sampled.squeeze(0)}) /
         std::sqrt(static_cast<double>(source.size(1)));
}

Tensor peakOffset(const Tensor& correlation_in, int radius)
{
  torch::NoGradGuard no_gradient;
  if (correlation_in.is_cuda() || radius > 10)
  {
    return peakOffsetReference(correlation_in, radius);
  }
  const auto correlation = correlation_in.contiguous();
  const int side = 2 * radius + 1;
  auto out = torch::empty({correlation.size(0), 3}, correlation.options());
  const float* c = correlation.data_ptr<float>();
  float* o = out.data_ptr<float>();
  forRows(correlation.size(0), 256,
          [&](std::int64_t begin, std::int64_t end)
          {
            // Fixed alignment: otherwise the order of the sums differs from run
            // to run.
            alignas(64) std::array<float, largest_window> memory;
            Eigen::Map<Eigen::ArrayXf, Eigen::Aligned64> share(memory.data(), side * side);
            for (std::int64_t i = begin; i < end; ++i)
            {
              const ConstRow row(c + i * side * side, side * side);
              const float highest = row.maxCoeff();
              const auto best = std::find(row.begin(), row.end(), highest) - row.begin();
              share = (row - highest).exp();
              const int bx = static_cast<int>(best) % side;
              const int by = static_cast<int>(best) / side;
              Eigen::Array3f sum = Eigen::Array3f::Zero();
              for (int y = std::max(0, by - 1); y <= std::min(side - 1, by + 1); ++y)
              {
                for (int x = std::max(0, bx - 1); x <= std::min(side - 1, bx + 1); ++x)
                {
                  const Eigen::Array3f at(static_cast<float>(x - radius),
                                          static_cast<float>(y - radius), 1);
                  sum += share[y * side + x] * at;
                }
              }
              o[3 * i] = sum[0] / sum[2];
              o[3 * i + 1] = sum[1] / sum[2];
              o[3 * i + 2] = sum[2] / share.sum();
            }
          });
  return out;
}

Tensor peakOffsetReference(const Tensor& correlation, int radius)
{
  const auto offsets = windowOffsets(radius, correlation.options());
  const auto best = offsets.index_select(0, correlation.argmax(1));
  const auto near = (offsets.unsqueeze(0) - best.unsqueeze(1)).norm(2, 2).le(1.5);
  const auto probability = correlation.softmax(1) * near;
  const auto mass = probability.sum(1, true);
  return torch::cat({probability.mm(offsets) / mass.clamp_min(1e-9), mass}, 1);
}
}  // namespace dyslam
