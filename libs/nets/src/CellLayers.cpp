// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/nets/CellLayers.h>
#include <dyslam/nets/PointLinear.h>
#include <dyslam/nets/Threads.h>
#include <torch/torch.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "OccupiedProducts.h"
#include "TensorViews.h"

namespace dyslam
{
namespace
{
using torch::Tensor;
using torch::autograd::AutogradContext;
using torch::autograd::tensor_list;

using Matrix = RowMajorMatrix<float>;
using Row = Eigen::Matrix<float, 1, Eigen::Dynamic>;
constexpr std::int64_t block = 256;  // cells per block, to fit the cache

/** Concatenated rows of `table` for `count` cells from `first` on, zeros for -1. */
void gatherBlock(
    const Tensor& rows, const Tensor& table, std::int64_t first, std::int64_t count, float* to)
{
  const auto kernel = table.size(1);
  const auto channels = rows.size(1);
  const float* from = rows.data_ptr<float>();
  const auto* indices = table.data_ptr<std::int32_t>() + first * kernel;
  for (std::int64_t i = 0; i < count * kernel; ++i, to += channels)
  {
    if (indices[i] < 0)
    {
      std::fill_n(to, channels, 0.0F);
    }
    else
    {
      std::copy_n(from + indices[i] * channels, channels, to);
    }
  }
}

/** Adds the gradients to the rows they were gathered from: the transpose of gatherBlock(). */
void scatterBlock(
    const float* from, const Tensor& table, std::int64_t first, std::int64_t count, Tensor& rows)
{
  const auto kernel = table.size(1);
  const auto channels = rows.size(1);
  float* to = rows.data_ptr<float>();
  const auto* indices = table.data_ptr<std::int32_t>() + first * kernel;
  for (std::int64_t i = 0; i < count * kernel; ++i, from += channels)
  {
    if (indices[i] >= 0)
    {
      Eigen::Map<Row>(to + indices[i] * channels, channels) +=
          Eigen::Map<const Row>(from, channels);
    }
  }
}

class GatherRows : public torch::autograd::Function<GatherRows>
{
 public:
  static Tensor forward(AutogradContext* context, const Tensor& rows, const Tensor& table)
  {
    auto out = torch::empty({table.size(0), table.size(1) * rows.size(1)}, rows.options());
    gatherBlock(rows, table, 0, table.size(0), out.data_ptr<float>());
    context->saved_data["rows"] = rows.size(0);
    context->save_for_backward({table});
    return out;
  }

  static tensor_list backward(AutogradContext* context, const tensor_list& gradients)
  {
    const auto gradient = gradients[0].contiguous();
    const auto table = context->get_saved_variables()[0];
    auto out = torch::zeros({context->saved_data["rows"].toInt(), gradient.size(1) / table.size(1)},
                            gradient.options());
    scatterBlock(gradient.data_ptr<float>(), table, 0, table.size(0), out);
    return {out, Tensor()};
  }
};

class GatheredLinear : public torch::autograd::Function<GatheredLinear>
{
 public:
  static Tensor forward(AutogradContext* context,
                        const Tensor& rows,
                        const Tensor& table,
                        const Tensor& weight,
                        const Tensor& bias,
                        double slope)
  {
    auto y = torch::empty({table.size(0), weight.size(0)}, rows.options());
    const Eigen::Map<const Row> b(bias.data_ptr<float>(), bias.size(0));
    Eigen::Map<Matrix> out(y.data_ptr<float>(), y.size(0), y.size(1));
    const auto leak = static_cast<float>(slope);
    const OccupiedProducts products(rows.data_ptr<float>(), rows.size(1), weight.data_ptr<float>(),
                                    table.size(1), weight.size(0));
    constexpr std::int64_t rows_at_once = 64;  // number of rows whose sums stay in the L1 cache
    forBlocks(table.size(0), rows_at_once,
              [&](std::int64_t first, std::int64_t count)
              {
                Matrix sums(count, products.width());
                sums.setZero();
                products.addTo(table.data_ptr<std::int32_t>() + first * table.size(1), count,
                               sums.data());
                auto part = out.middleRows(first, count);
                part = sums.leftCols(out.cols());
                part.rowwise() += b;
                if (leak != 1.0F)
                {
                  part = part.cwiseMax(leak * part);
                }
              });
    context->save_for_backward({rows, table, weight, y});
    context->saved_data["slope"] = slope;
    return y;
  }

  static tensor_list backward(AutogradContext* context, const tensor_list& gradients)
  {
    const auto saved = context->get_saved_variables();
    const auto leak = static_cast<float>(context->saved_data["slope"].toDouble());
    const auto& table = saved[1];
    const auto gradient = gradients[0].contiguous();
    const auto w = viewOf<float>(saved[2]);
    const auto y = viewOf<float>(saved[3]);
    const auto g = viewOf<float>(gradient);
    auto to_rows = torch::zeros_like(saved[0]);
    auto to_weight = torch::zeros_like(saved[2]);
    auto to_bias = torch::zeros({w.rows()}, gradient.options());
    Eigen::Map<Matrix> gw(to_weight.data_ptr<float>(), w.rows(), w.cols());
    Eigen::Map<Row> gb(to_bias.data_ptr<float>(), w.rows());
    Matrix gathered;
    Matrix part;
    Matrix spread;
    for (std::int64_t first = 0; first < table.size(0); first += block)
    {
      const auto count = std::min(block, table.size(0) - first);
      part = g.middleRows(first, count);
      if (leak != 1.0F)
      {
        part.array() *= (y.middleRows(first, count).array() > 0)
                            .select(Matrix::Constant(count, w.rows(), 1.0F).array(), leak);
      }
      gathered.resize(count, w.cols());
      gatherBlock(saved[0], table, first, count, gathered.data());
      gw.noalias() += part.transpose() * gathered;
      gb += part.colwise().sum();
      spread.noalias() = part * w;
      scatterBlock(spread.data(), table, first, count, to_rows);
    }
    return {to_rows, Tensor(), to_weight, to_bias, Tensor()};
  }
};

/** torch's default initialisation of linear and convolution layers. */
void initialiseParameters(Tensor& weight, Tensor& bias, std::int64_t fan_in)
{
  torch::NoGradGuard no_gradient;
  const double bound = 1 / std::sqrt(static_cast<double>(fan_in));
  weight.uniform_(-bound, bound);
  bias.uniform_(-bound, bound);
}
}  // namespace

Tensor gatherRows(const Tensor& rows, const Tensor& table)
{
  if (!rows.is_cuda())
  {
    return GatherRows::apply(rows.contiguous(), table.contiguous());
  }
  const auto padded = torch::cat({rows, torch::zeros({1, rows.size(1)}, rows.options())});
  const auto index = table.to(torch::kInt64).reshape({-1});
  const auto found = padded.index_select(0, index.masked_fill(index.lt(0), rows.size(0)));
  return found.view({table.size(0), table.size(1) * rows.size(1)});
}

Tensor gatheredLinear(
    const Tensor& rows, const Tensor& table, const Tensor& weight, const Tensor& bias, double slope)
{
  if (!rows.is_cuda())
  {
    return GatheredLinear::apply(rows.contiguous(), table.contiguous(), weight.contiguous(), bias,
                                 slope);
  }
  const auto y = torch::addmm(bias, gatherRows(rows, table), weight.t());
  return slope != 1 ? torch::leaky_relu(y, slope) : y;
}

Tensor tableTensor(const std::vector<std::int32_t>& table, std::int64_t width)
{
  return torch::from_blob(const_cast<std::int32_t*>(table.data()),
                          {static_cast<std::int64_t>(table.size()) / width, width}, torch::kInt32)
      .clone();
}

RowLinearImpl::RowLinearImpl(std::int64_t in, std::int64_t out)
{
  weight = register_parameter("weight", torch::empty({out, in}));
  bias = register_parameter("bias", torch::empty({out}));
  initialiseParameters(weight, bias, in);
}

Tensor RowLinearImpl::forward(const Tensor& rows, double slope)
{
  return pointLinear(rows, weight, bias, slope);
}

CellConvImpl::CellConvImpl(std::int64_t in, std::int64_t out)
{
  weight = register_parameter("weight", torch::empty({out, in, 3, 3}));
  bias = register_parameter("bias", torch::empty({out}));
  initialiseParameters(weight, bias, 9 * in);
}

Tensor CellConvImpl::forward(const Tensor& rows, const Tensor& table, double slope)
{
  const auto flat = weight.permute({0, 2, 3, 1}).reshape({weight.size(0), -1});
  return gatheredLinear(rows, table, flat, bias, slope);
}
}  // namespace dyslam
