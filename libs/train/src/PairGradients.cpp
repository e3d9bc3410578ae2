// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/train/PairGradients.h>

#include <numeric>
#include <stdexcept>
#include <utility>

namespace dyslam
{
PairGradients::PairGradients(std::vector<torch::Tensor> parameters,
                             std::vector<std::vector<torch::Tensor>> copies)
    : parameters_(std::move(parameters)), copies_(std::move(copies)), free_(copies_.size())
{
  std::iota(free_.begin(), free_.end(), std::size_t{0});
  for (auto& copy : copies_)
  {
    for (std::size_t i = 0; i < parameters_.size(); ++i)
    {
      copy[i].set_data(parameters_[i].detach());
    }
  }
}

void PairGradients::begin(std::size_t pairs)
{
  gradients_.assign(pairs, std::vector<torch::Tensor>(parameters_.size()));
}

void PairGradients::compute(std::size_t pair, const std::function<void(std::size_t copy)>& backward)
{
  std::size_t copy = 0;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (free_.empty())
    {
      throw std::logic_error("PairGradients: more threads than copies of the network");
    }
    copy = free_.back();
    free_.pop_back();
  }
  const auto give_back = [&]
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    free_.push_back(copy);
  };
  try
  {
    backward(copy);
  }
  catch (...)
  {
    give_back();
    throw;
  }
  for (std::size_t i = 0; i < parameters_.size(); ++i)
  {
    std::swap(gradients_[pair][i], copies_[copy][i].mutable_grad());
  }
  give_back();
}

void PairGradients::finish()
{
  for (std::size_t i = 0; i < parameters_.size(); ++i)
  {
    torch::Tensor sum;
    for (auto& of_pair : gradients_)
    {
      torch::Tensor& gradient = of_pair[i];
      if (!gradient.defined())
      {
        continue;
      }
      if (sum.defined())
      {
        sum.add_(gradient);
      }
      else
      {
        sum = std::move(gradient);
      }
    }
    parameters_[i].mutable_grad() = sum;
  }
}

void PairGradients::computeStep(
    ThreadPool& pool,
    std::size_t pairs,
    const std::function<void(std::size_t pair, std::size_t copy)>& backward,
    const std::function<void(std::size_t pair)>& prepare)
{
  begin(pairs);
  pool.forChunks(2 * pairs, 1,
                 [&](std::size_t i, std::size_t, std::size_t)
                 {
                   if (i >= pairs)
                   {
                     prepare(i - pairs);
                     return;
                   }
                   compute(i, [&](std::size_t copy) { backward(i, copy); });
                 });
  finish();
}
}  // namespace dyslam
