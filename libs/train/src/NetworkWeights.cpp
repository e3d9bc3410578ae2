// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/train/NetworkWeights.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <sstream>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace dyslam
{
namespace
{
using State = std::decay_t<decltype(std::declval<torch::optim::Optimizer&>().state())>;

/** Key of a parameter in the optimizer's state: its address, or its address as text, depending on
 * the version of torch. */
template <typename Key = State::key_type>
Key keyOf(const torch::Tensor& parameter)
{
  if constexpr (std::is_same_v<Key, std::string>)
  {
    std::ostringstream address;
    address << parameter.unsafeGetTensorImpl();
    return address.str();
  }
  else
  {
    return parameter.unsafeGetTensorImpl();
  }
}

std::vector<torch::Tensor> parametersOf(torch::optim::Optimizer& optimizer)
{
  std::vector<torch::Tensor> parameters;
  for (const auto& group : optimizer.param_groups())
  {
    parameters.insert(parameters.end(), group.params().begin(), group.params().end());
  }
  return parameters;
}

std::string prefixOf(std::size_t parameter)
{
  return "optimizer." + std::to_string(parameter) + ".";
}

template <typename ParamState>
void setState(TensorFile& file, torch::optim::Optimizer& optimizer)
{
  const std::vector<torch::Tensor> parameters = parametersOf(optimizer);
  for (std::size_t i = 0; i < parameters.size(); ++i)
  {
    const auto found = optimizer.state().find(keyOf(parameters[i]));
    if (found != optimizer.state().end())  // otherwise no gradient yet
    {
      const auto& state = static_cast<const ParamState&>(*found->second);
      file.set(prefixOf(i) + "step", torch::tensor(state.step(), torch::kInt64));
      file.set(prefixOf(i) + "exp_avg", state.exp_avg());
      file.set(prefixOf(i) + "exp_avg_sq", state.exp_avg_sq());
    }
  }
}

torch::Tensor stored(const TensorFile& file, const std::string& name, const torch::Tensor& like)
{
  const torch::Tensor& value = file.tensor(name);
  if (value.sizes() != like.sizes())
  {
    throw UserError(file.path() + ": " + name + " is of a network of another size");
  }
  return value.to(like.device(), like.scalar_type(), false, true);
}

template <typename ParamState>
void loadState(const TensorFile& file, torch::optim::Optimizer& optimizer)
{
  const std::vector<torch::Tensor> parameters = parametersOf(optimizer);
  for (std::size_t i = 0; i < parameters.size(); ++i)
  {
    if (!file.has(prefixOf(i) + "step"))
    {
      continue;
    }
    auto state = std::make_unique<ParamState>();
    state->step(file.tensor(prefixOf(i) + "step").template item<std::int64_t>());
    state->exp_avg(stored(file, prefixOf(i) + "exp_avg", parameters[i]));
    state->exp_avg_sq(stored(file, prefixOf(i) + "exp_avg_sq", parameters[i]));
    optimizer.state()[keyOf(parameters[i])] = std::move(state);
  }
}
}  // namespace

void requireSameNetwork(const Options& of_weights,
                        const Options& given,
                        const std::string& file,
                        const std::string& otherwise)
{
  const std::string section = "network";
  Config trained;
  Config asked;
  save(of_weights, trained, section);
  save(given, asked, section);
  for (const auto& [key, value] : trained.section(section))
  {
    const std::string& other = asked.section(section).at(key).text;
    if (value.text != other)
    {
      throw UserError(file + ": trained with [" + section + "] " + key + " = " + value.text +
                      ", not " + other + "; set it to " + value.text +
                      (otherwise.empty() ? "" : ", or " + otherwise));
    }
  }
}

void copyWeights(torch::nn::Module& to, const torch::nn::Module& from, const std::string& file)
{
  const torch::NoGradGuard no_grad;
  const auto theirs = from.named_parameters();
  for (auto& weight : to.named_parameters())
  {
    const torch::Tensor* given = theirs.find(weight.key());
    if (given == nullptr || given->sizes() != weight.value().sizes())
    {
      throw UserError(file + ": " + weight.key() +
                      " is missing or of another shape; give weights of a network with the same "
                      "[network] settings");
    }
    weight.value().copy_(*given);
  }
}

void updateMean(torch::nn::Module& mean,
                const torch::nn::Module& now,
                std::int64_t step,
                double decay)
{
  const torch::NoGradGuard no_grad;
  const double done = static_cast<double>(step);
  const double keep = std::min(decay, (1 + done) / (10 + done));
  const auto from = now.parameters();
  const auto to = mean.parameters();
  for (std::size_t i = 0; i < to.size(); ++i)
  {
    to[i].mul_(keep).add_(from[i], 1 - keep);
  }
}

double clippedStep(torch::optim::Optimizer& optimizer, double clip)
{
  const double norm = torch::nn::utils::clip_grad_norm_(parametersOf(optimizer), clip);
  if (std::isfinite(norm))
  {
    optimizer.step();
  }
  else
  {
    optimizer.zero_grad();
  }
  return norm;
}

void setOptimizerState(TensorFile& file, torch::optim::Optimizer& optimizer)
{
  dynamic_cast<torch::optim::AdamW*>(&optimizer) != nullptr
      ? setState<torch::optim::AdamWParamState>(file, optimizer)
      : setState<torch::optim::AdamParamState>(file, optimizer);
}

void loadOptimizerState(const TensorFile& file, torch::optim::Optimizer& optimizer)
{
  dynamic_cast<torch::optim::AdamW*>(&optimizer) != nullptr
      ? loadState<torch::optim::AdamWParamState>(file, optimizer)
      : loadState<torch::optim::AdamParamState>(file, optimizer);
}
}  // namespace dyslam
