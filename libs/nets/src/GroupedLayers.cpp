// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/nets/Grouping.h>
#include <dyslam/nets/Threads.h>

#include <Eigen/Core>
#include <algorithm>
#include <limits>

#include "TensorViews.h"

namespace dyslam
{
namespace
{
constexpr std::int64_t block = 1024;  //!< group members per block

using Matrix = RowMajorMatrix<float>;
using Row = Eigen::Matrix<float, 1, Eigen::Dynamic>;

/** The product with the features is computed once per node and then gathered: nodes are fewer. */
class GroupedLinearFunction : public torch::autograd::Function<GroupedLinearFunction>
{
 public:
  static torch::Tensor forward(torch::autograd::AutogradContext* context,
                               const torch::Tensor& geometry,
                               const torch::Tensor& features,
                               const torch::Tensor& index,
                               const torch::Tensor& weight,
                               const torch::Tensor& bias,
                               const torch::Tensor& own,
                               double slope)
  {
    const std::int64_t g = geometry.size(1);
    const std::int64_t out = weight.size(0);
    const std::int64_t group = own.numel() > 0 ? geometry.size(0) / own.size(0) : 0;
    torch::Tensor y = torch::empty({geometry.size(0), out});
    const auto w = viewOf<float>(weight);
    const Matrix w_geometry = w.leftCols(g).transpose();
    Matrix per_node;
    if (features.numel() > 0)
    {
      per_node.noalias() = viewOf<float>(features) * w.rightCols(w.cols() - g).transpose();
    }
    const auto in = viewOf<float>(geometry);
    const Eigen::Map<const Row> b(bias.data_ptr<float>(), out);
    Eigen::Map<Matrix> result(y.data_ptr<float>(), y.size(0), out);
    const std::int64_t* node = index.data_ptr<std::int64_t>();
    const auto of_group = viewOf<float>(own);
    const auto leak = static_cast<float>(slope);
    forBlocks(geometry.size(0), block,
              [&](std::int64_t begin, std::int64_t count)
              {
                auto part = result.middleRows(begin, count);
                part.noalias() = in.middleRows(begin, count) * w_geometry;
                for (std::int64_t i = 0; i < count; ++i)
                {
                  auto row = part.row(i);
                  row += b;
                  if (per_node.size() > 0)
                  {
                    row += per_node.row(node[begin + i]);
                  }
                  if (group > 0)
                  {
                    row += of_group.row((begin + i) / group);
                  }
                  row = row.cwiseMax(leak * row);
                }
              });
    context->save_for_backward({geometry, features, index, weight, y});
    context->saved_data["group"] = group;
    context->saved_data["slope"] = slope;
    return y;
  }

  static torch::autograd::variable_list backward(torch::autograd::AutogradContext* context,
                                                 const torch::autograd::variable_list& grads)
  {
    const auto saved = context->get_saved_variables();
    const auto leak = static_cast<float>(context->saved_data["slope"].toDouble());
    const torch::Tensor grad_in = grads[0].contiguous();
    const auto in = viewOf<float>(saved[0]);
    const auto w = viewOf<float>(saved[3]);
    const auto y = viewOf<float>(saved[4]);
    const auto g = viewOf<float>(grad_in);
    const std::int64_t* node = saved[2].data_ptr<std::int64_t>();
    const bool has_features = saved[1].numel() > 0;
    const std::int64_t geometry = in.cols();
    const std::int64_t group = context->saved_data["group"].toInt();
    torch::Tensor grad_geometry;
    if (saved[0].requires_grad())
    {
      grad_geometry = torch::empty_like(saved[0]);
    }
    torch::Tensor grad_own = torch::zeros({group > 0 ? in.rows() / group : 0, w.rows()});
    Eigen::Map<Matrix> go(grad_own.data_ptr<float>(), grad_own.size(0), w.rows());
    torch::Tensor grad_features = torch::zeros_like(saved[1]);
    torch::Tensor grad_weight = torch::zeros_like(saved[3]);
    torch::Tensor grad_bias = torch::zeros({w.rows()});
    Eigen::Map<Matrix> gw(grad_weight.data_ptr<float>(), w.rows(), w.cols());
    Eigen::Map<Row> gb(grad_bias.data_ptr<float>(), w.rows());
    Matrix per_node;
    if (has_features)
    {
      per_node = Matrix::Zero(saved[1].size(0), w.rows());
    }
    Matrix part;
    for (std::int64_t begin = 0; begin < in.rows(); begin += block)
    {
      const std::int64_t count = std::min(block, in.rows() - begin);
      part = g.middleRows(begin, count);
      for (std::int64_t i = 0; i < count; ++i)
      {
        auto row = part.row(i).array();
        row *= (y.row(begin + i).array() > 0).select(Row::Ones(w.rows()).array(), leak);
        if (has_features)
        {
          per_node.row(node[begin + i]) += part.row(i);
        }
        if (group > 0)
        {
          go.row((begin + i) / group) += part.row(i);
        }
      }
      if (grad_geometry.defined())
      {
        Eigen::Map<Matrix>(grad_geometry.data_ptr<float>() + begin * geometry, count, geometry)
            .noalias() = part * w.leftCols(geometry);
      }
      gw.leftCols(geometry).noalias() += part.transpose() * in.middleRows(begin, count);
      gb += part.colwise().sum();
    }
    if (has_features)
    {
      const auto features = viewOf<float>(saved[1]);
      gw.rightCols(w.cols() - geometry).noalias() = per_node.transpose() * features;
      Eigen::Map<Matrix>(grad_features.data_ptr<float>(), features.rows(), features.cols())
          .noalias() = per_node * w.rightCols(w.cols() - geometry);
    }
    return {
        grad_geometry, has_features ? grad_features : torch::Tensor(), torch::Tensor(), grad_weight,
        grad_bias,     group > 0 ? grad_own : torch::Tensor(),         torch::Tensor()};
  }
};

/** groupMax() without gradients, which does not need the argmax. */
torch::Tensor groupMaxWithoutGradients(const torch::Tensor& x, const torch::Tensor& usable)
{
  const std::int64_t n = x.size(0);
  const std::int64_t k = x.size(1);
  const std::int64_t c = x.size(2);
  torch::Tensor result = torch::empty({n, c});
  const float* in = x.data_ptr<float>();
  const float* use = usable.data_ptr<float>();
  float* out = result.data_ptr<float>();
  forRows(n, 64,
          [&](std::int64_t begin, std::int64_t end)
          {
            for (std::int64_t i = begin; i < end; ++i)
            {
              constexpr float none = std::numeric_limits<float>::lowest();
              Eigen::Map<Row> largest(out + i * c, c);
              largest.setConstant(none);
              for (std::int64_t j = i * k; j < (i + 1) * k; ++j)
              {
                if (use[j] != 0)
                {
                  largest = largest.cwiseMax(Eigen::Map<const Row>(in + j * c, c));
                }
              }
              if (largest[0] == none)
              {
                largest.setZero();
              }
            }
          });
  return result;
}

class AttendedSumFunction : public torch::autograd::Function<AttendedSumFunction>
{
 public:
  static torch::Tensor forward(torch::autograd::AutogradContext* context,
                               const torch::Tensor& attention,
                               const torch::Tensor& values)
  {
    const std::int64_t n = values.size(0);
    const std::int64_t k = values.size(1);
    const std::int64_t c = values.size(2);
    torch::Tensor result = torch::empty({n, c});
    const float* share = attention.data_ptr<float>();
    const float* in = values.data_ptr<float>();
    float* out = result.data_ptr<float>();
    forRows(n, 64,
            [&](std::int64_t begin, std::int64_t end)
            {
              for (std::int64_t i = begin; i < end; ++i)
              {
                Eigen::Map<Row> sum(out + i * c, c);
                sum.setZero();
                for (std::int64_t j = i * k; j < (i + 1) * k; ++j)
                {
                  sum += share[j] * Eigen::Map<const Row>(in + j * c, c);
                }
              }
            });
    context->save_for_backward({attention, values});
    return result;
  }

  static torch::autograd::variable_list backward(torch::autograd::AutogradContext* context,
                                                 const torch::autograd::variable_list& grads)
  {
    const auto saved = context->get_saved_variables();
    const torch::Tensor grad = grads[0].contiguous();
    const std::int64_t k = saved[1].size(1);
    const std::int64_t c = saved[1].size(2);
    torch::Tensor grad_attention = torch::empty_like(saved[0]);
    torch::Tensor grad_values;
    if (saved[1].requires_grad())
    {
      grad_values = torch::empty_like(saved[1]);
    }
    const float* share = saved[0].data_ptr<float>();
    const float* in = saved[1].data_ptr<float>();
    for (std::int64_t j = 0; j < saved[0].numel(); ++j)
    {
      const Eigen::Map<const Row> g(grad.data_ptr<float>() + j / k * c, c);
      grad_attention.data_ptr<float>()[j] = g.dot(Eigen::Map<const Row>(in + j * c, c));
      if (grad_values.defined())
      {
        Eigen::Map<Row>(grad_values.data_ptr<float>() + j * c, c) = share[j] * g;
      }
    }
    return {grad_attention, grad_values};
  }
};

class GroupMaxFunction : public torch::autograd::Function<GroupMaxFunction>
{
 public:
  static torch::Tensor forward(torch::autograd::AutogradContext* context,
                               const torch::Tensor& x,
                               const torch::Tensor& usable)
  {
    const std::int64_t n = x.size(0);
    const std::int64_t k = x.size(1);
    const std::int64_t c = x.size(2);
    torch::Tensor result = torch::zeros({n, c});
    torch::Tensor from = torch::full({n, c}, -1, torch::kInt);
    const float* in = x.data_ptr<float>();
    const float* use = usable.data_ptr<float>();
    float* out = result.data_ptr<float>();
    std::int32_t* place = from.data_ptr<std::int32_t>();
    forRows(n, 64,
            [&](std::int64_t begin, std::int64_t end)
            {
              for (std::int64_t i = begin; i < end; ++i)
              {
                for (std::int64_t j = 0; j < k; ++j)
                {
                  if (use[i * k + j] == 0)
                  {
                    continue;
                  }
                  const float* value = in + (i * k + j) * c;
                  for (std::int64_t a = 0; a < c; ++a)
                  {
                    const bool better = place[i * c + a] < 0 || value[a] > out[i * c + a];
                    out[i * c + a] = better ? value[a] : out[i * c + a];
                    place[i * c + a] = better ? static_cast<std::int32_t>(j) : place[i * c + a];
                  }
                }
              }
            });
    context->save_for_backward({from});
    context->saved_data["places"] = k;
    return result;
  }

  static torch::autograd::variable_list backward(torch::autograd::AutogradContext* context,
                                                 const torch::autograd::variable_list& grads)
  {
    const torch::Tensor from = context->get_saved_variables()[0];
    const torch::Tensor grad = grads[0].contiguous();
    const std::int64_t n = from.size(0);
    const std::int64_t c = from.size(1);
    const std::int64_t k = context->saved_data["places"].toInt();
    torch::Tensor result = torch::zeros({n, k, c});
    const std::int32_t* place = from.data_ptr<std::int32_t>();
    const float* g = grad.data_ptr<float>();
    float* out = result.data_ptr<float>();
    for (std::int64_t i = 0; i < n; ++i)
    {
      for (std::int64_t a = 0; a < c; ++a)
      {
        if (place[i * c + a] >= 0)
        {
          out[(i * k + place[i * c + a]) * c + a] = g[i * c + a];
        }
      }
    }
    return {result, torch::Tensor()};
  }
};
}  // namespace

torch::Tensor groupedLinear(const torch::Tensor& geometry,
                            const torch::Tensor& features,
                            const torch::Tensor& index,
                            const torch::Tensor& weight,
                            const torch::Tensor& bias,
                            double slope,
                            const torch::Tensor& own)
{
  if (!onCpu(geometry))
  {
    return reference::groupedLinear(geometry, features, index, weight, bias, slope, own);
  }
  const std::int64_t n = geometry.size(0);
  const std::int64_t k = geometry.size(1);
  const torch::Tensor none = torch::empty({0, 0});
  const torch::Tensor flat = geometry.reshape({n * k, geometry.size(2)}).contiguous();
  const torch::Tensor nodes =
      features.defined() ? index.contiguous() : torch::empty({0}, torch::kLong);
  return GroupedLinearFunction::apply(flat, features.defined() ? features.contiguous() : none,
                                      nodes, weight.contiguous(), bias,
                                      own.defined() ? own.contiguous() : none, slope)
      .reshape({n, k, weight.size(0)});
}

torch::Tensor groupMax(const torch::Tensor& x, const torch::Tensor& usable)
{
  if (!onCpu(x))
  {
    return reference::groupMax(x, usable);
  }
  if (!torch::GradMode::is_enabled())
  {
    return groupMaxWithoutGradients(x.contiguous(), usable.contiguous());
  }
  return GroupMaxFunction::apply(x.contiguous(), usable.contiguous());
}

torch::Tensor attendedSum(const torch::Tensor& attention, const torch::Tensor& values)
{
  if (!onCpu(values))
  {
    return reference::attendedSum(attention, values);
  }
  return AttendedSumFunction::apply(attention.contiguous(), values.contiguous());
}
}  // namespace dyslam
