// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/nets/PointLinear.h>
#include <dyslam/nets/Threads.h>
#include <torch/torch.h>

#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "TensorViews.h"

namespace dyslam
{
namespace
{
constexpr std::int64_t block = 1024;

template <typename T>
void linearForward(const torch::Tensor& x,
                   const torch::Tensor& weight,
                   const torch::Tensor& bias,
                   T slope,
                   torch::Tensor& y)
{
  const auto in = viewOf<T>(x);
  const auto w = viewOf<T>(weight);
  const Eigen::Map<const Eigen::Matrix<T, 1, Eigen::Dynamic>> b(bias.data_ptr<T>(), bias.size(0));
  Eigen::Map<RowMajorMatrix<T>> out(y.data_ptr<T>(), y.size(0), y.size(1));
  const RowMajorMatrix<T> w_t = w.transpose();
  forBlocks(x.size(0), block,
            [&](std::int64_t first, std::int64_t count)
            {
              auto part = out.middleRows(first, count);
              part.noalias() = in.middleRows(first, count) * w_t;
              part.rowwise() += b;
              if (slope != T(1))
              {
                part = part.cwiseMax(slope * part);
              }
            });
}

template <typename T>
void linearBackward(const torch::Tensor& x,
                    const torch::Tensor& weight,
                    const torch::Tensor& y,
                    const torch::Tensor& grad,
                    T slope,
                    torch::Tensor& grad_x,
                    torch::Tensor& grad_weight,
                    torch::Tensor& grad_bias)
{
  const auto in = viewOf<T>(x);
  const auto w = viewOf<T>(weight);
  const auto out = viewOf<T>(y);
  const auto g = viewOf<T>(grad);
  Eigen::Map<RowMajorMatrix<T>> gx(grad_x.data_ptr<T>(), grad_x.size(0), grad_x.size(1));
  Eigen::Map<RowMajorMatrix<T>> gw(grad_weight.data_ptr<T>(), grad_weight.size(0),
                                   grad_weight.size(1));
  Eigen::Map<Eigen::Matrix<T, 1, Eigen::Dynamic>> gb(grad_bias.data_ptr<T>(), grad_bias.size(0));
  const std::int64_t rows = x.size(0);
  RowMajorMatrix<T> part;
  for (std::int64_t first = 0; first < rows; first += block)
  {
    const std::int64_t count = std::min(block, rows - first);
    part = g.middleRows(first, count);
    if (slope != T(1))
    {
      part.array() *=
          (out.middleRows(first, count).array() > T(0))
              .select(RowMajorMatrix<T>::Constant(count, y.size(1), T(1)).array(), slope);
    }
    gx.middleRows(first, count).noalias() = part * w;
    gw.noalias() += part.transpose() * in.middleRows(first, count);
    gb += part.colwise().sum();
  }
}

class PointLinearFunction : public torch::autograd::Function<PointLinearFunction>
{
 public:
  static torch::Tensor forward(torch::autograd::AutogradContext* context,
                               const torch::Tensor& x,
                               const torch::Tensor& weight,
                               const torch::Tensor& bias,
                               double slope)
  {
    torch::Tensor y = torch::empty({x.size(0), weight.size(0)}, x.options());
    if (x.scalar_type() == torch::kDouble)
    {
      linearForward<double>(x, weight, bias, slope, y);
    }
    else
    {
      linearForward<float>(x, weight, bias, static_cast<float>(slope), y);
    }
    context->save_for_backward({x, weight, y});
    context->saved_data["slope"] = slope;
    return y;
  }

  static torch::autograd::variable_list backward(torch::autograd::AutogradContext* context,
                                                 const torch::autograd::variable_list& grads)
  {
    const auto saved = context->get_saved_variables();
    const double slope = context->saved_data["slope"].toDouble();
    const torch::Tensor grad = grads[0].contiguous();
    torch::Tensor grad_x = torch::empty_like(saved[0]);
    torch::Tensor grad_weight = torch::zeros_like(saved[1]);
    torch::Tensor grad_bias = torch::zeros({saved[1].size(0)}, saved[1].options());
    if (grad.scalar_type() == torch::kDouble)
    {
      linearBackward<double>(saved[0], saved[1], saved[2], grad, slope, grad_x, grad_weight,
                             grad_bias);
    }
    else
    {
      linearBackward<float>(saved[0], saved[1], saved[2], grad, static_cast<float>(slope), grad_x,
                            grad_weight, grad_bias);
    }
    return {grad_x, grad_weight, grad_bias, torch::Tensor()};
  }
};
}  // namespace

torch::Tensor pointLinear(const torch::Tensor& x,
                          const torch::Tensor& weight,
                          const torch::Tensor& bias,
                          double slope)
{
  const auto sizes = x.sizes();
  const torch::Tensor flat = x.reshape({-1, sizes.back()});
  torch::Tensor y;
  if (x.device().is_cpu())
  {
    y = PointLinearFunction::apply(flat.contiguous(), weight.contiguous(), bias, slope);
  }
  else
  {
    y = torch::addmm(bias, flat, weight.t());
    y = slope != 1 ? torch::leaky_relu(y, slope) : y;
  }
  std::vector<std::int64_t> shape(sizes.begin(), sizes.end());
  shape.back() = weight.size(0);
  return y.reshape(shape);
}
}  // namespace dyslam
