// SPDX-License-Identifier: BSD-3-Clause
#include <ATen/Parallel.h>
#include <dyslam/nets/CellLayers.h>
#include <dyslam/nets/PointLinear.h>
#include <torch/torch.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace dyslam
{
namespace
{
using torch::Tensor;
using torch::autograd::AutogradContext;
using torch::autograd::tensor_list;

class GatherRows : public torch::autograd::Function<GatherRows>
{
 public:
  static Tensor forward(AutogradContext* context, const Tensor& rows_in, const Tensor& table_in)
  {
    const auto rows = rows_in.contiguous();
    const auto table = table_in.contiguous();
    const auto channels = rows.size(1);
    const auto kernel = table.size(1);
    auto out = torch::empty({table.size(0), kernel * channels}, rows.options());
    const float* from = rows.data_ptr<float>();
    const auto* which = table.data_ptr<std::int32_t>();
    float* to = out.data_ptr<float>();
    at::parallel_for(0, table.size(0), 512,
                     [&](std::int64_t begin, std::int64_t end)
                     {
                       for (std::int64_t i = begin * kernel; i < end * kernel; ++i)
                       {
                         if (which[i] < 0)
                         {
                           std::fill_n(to + i * channels, channels, 0.0F);
                         }
                         else
                         {
                           std::copy_n(from + which[i] * channels, channels, to + i * channels);
                         }
                       }
                     });
    context->saved_data["rows"] = rows.size(0);
    context->save_for_backward({table});
    return out;
  }

  static tensor_list backward(AutogradContext* context, const tensor_list& gradients)
  {
    const auto gradient = gradients[0].contiguous();
    const auto table = context->get_saved_variables()[0];
    const auto channels = gradient.size(1) / table.size(1);
    auto out = torch::zeros({context->saved_data["rows"].toInt(), channels}, gradient.options());
    const auto* which = table.data_ptr<std::int32_t>();
    const float* from = gradient.data_ptr<float>();
    float* to = out.data_ptr<float>();
    for (std::int64_t i = 0; i < table.numel(); ++i)
    {
      if (which[i] >= 0)
      {
        float* row = to + which[i] * channels;
        const float* add = from + i * channels;
        for (std::int64_t c = 0; c < channels; ++c)
        {
          row[c] += add[c];
        }
      }
    }
    return {out, Tensor()};
  }
};

using Matrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Row = Eigen::Matrix<float, 1, Eigen::Dynamic>;
constexpr std::int64_t block = 256;  // cells gathered at a time, to stay in the cache

Eigen::Map<const Matrix> viewOf(const Tensor& t)
{
  return {t.data_ptr<float>(), t.size(0), t.size(1)};
}

/** The rows of `table` from `first` on, side by side, for some cells. */
void gatherBlock(const Eigen::Map<const Matrix>& rows,
                 const Tensor& table,
                 std::int64_t first,
                 Matrix& out)
{
  const auto kernel = table.size(1);
  const auto* which = table.data_ptr<std::int32_t>() + first * kernel;
  float* to = out.data();
  for (std::int64_t i = 0; i < out.rows() * kernel; ++i, to += rows.cols())
  {
    if (which[i] < 0)
    {
      std::fill_n(to, rows.cols(), 0.0F);
    }
    else
    {
      std::copy_n(rows.data() + which[i] * rows.cols(), rows.cols(), to);
    }
  }
}

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
    const auto in = viewOf(rows);
    const Matrix w_t = viewOf(weight).transpose();
    const Eigen::Map<const Row> b(bias.data_ptr<float>(), bias.size(0));
    Eigen::Map<Matrix> out(y.data_ptr<float>(), y.size(0), y.size(1));
    const auto leak = static_cast<float>(slope);
    const auto cells = table.size(0);
    at::parallel_for(0, (cells + block - 1) / block, 1,
                     [&](std::int64_t begin, std::int64_t end)
                     {
                       Matrix gathered;
                       for (std::int64_t k = begin; k < end; ++k)
                       {
                         const auto first = k * block;
                         const auto count = std::min(block, cells - first);
                         gathered.resize(count, weight.size(1));
                         gatherBlock(in, table, first, gathered);
                         auto part = out.middleRows(first, count);
                         part.noalias() = gathered * w_t;
                         part.rowwise() += b;
                         if (leak != 1.0F)
                         {
                           part = part.cwiseMax(leak * part);
                         }
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
    const auto in = viewOf(saved[0]);
    const auto w = viewOf(saved[2]);
    const auto y = viewOf(saved[3]);
    const auto g = viewOf(gradient);
    auto to_rows = torch::zeros_like(saved[0]);
    auto to_weight = torch::zeros_like(saved[2]);
    auto to_bias = torch::zeros({w.rows()}, gradient.options());
    Eigen::Map<Matrix> gw(to_weight.data_ptr<float>(), w.rows(), w.cols());
    Eigen::Map<Row> gb(to_bias.data_ptr<float>(), w.rows());
    float* gx = to_rows.data_ptr<float>();
    const auto* which = table.data_ptr<std::int32_t>();
    const auto channels = in.cols();
    const auto kernel = table.size(1);
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
      gatherBlock(in, table, first, gathered);
      gw.noalias() += part.transpose() * gathered;
      gb += part.colwise().sum();
      spread.noalias() = part * w;
      const float* from = spread.data();
      for (std::int64_t i = first * kernel; i < (first + count) * kernel; ++i, from += channels)
      {
        if (which[i] >= 0)
        {
          Eigen::Map<Row>(gx + which[i] * channels, channels) +=
              Eigen::Map<const Row>(from, channels);
        }
      }
    }
    return {to_rows, Tensor(), to_weight, to_bias, Tensor()};
  }
};

/** torch's own start of linear and convolution layers. */
void startParameters(Tensor& weight, Tensor& bias, std::int64_t fan_in)
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
    return GatherRows::apply(rows, table);
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
  startParameters(weight, bias, in);
}

Tensor RowLinearImpl::forward(const Tensor& rows, double slope)
{
  return pointLinear(rows, weight, bias, slope);
}

CellConvImpl::CellConvImpl(std::int64_t in, std::int64_t out)
{
  weight = register_parameter("weight", torch::empty({out, in, 3, 3}));
  bias = register_parameter("bias", torch::empty({out}));
  startParameters(weight, bias, 9 * in);
}

Tensor CellConvImpl::forward(const Tensor& rows, const Tensor& table, double slope)
{
  const auto flat = weight.permute({0, 2, 3, 1}).reshape({weight.size(0), -1});
  return gatheredLinear(rows, table, flat, bias, slope);
}
}  // namespace dyslam
