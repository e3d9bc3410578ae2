// SPDX-License-Identifier: BSD-3-Clause
#include "TrainingLoop.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/Printable.h>
#include <dyslam/nets/Threads.h>
#include <dyslam/train/DataText.h>
#include <dyslam/train/NetworkWeights.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace dyslam
{
namespace
{
constexpr const char* checkpoint_file = "checkpoint.safetensors";  // in the folder of output
constexpr const char* before_decay_file = "checkpoint_before_decay.safetensors";
constexpr const char* validation_file = "validation.csv";

double minutesSince(std::chrono::steady_clock::time_point begin)
{
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() / 60;
}
}  // namespace

TrainingLoop::TrainingLoop(TrainingLoopSetup setup, TrainingTask& task)
    : setup_(std::move(setup)),
      task_(task),
      parameters_(setup_.optimizer->param_groups().front().params())
{
}

void TrainingLoop::requireFreshFolder() const
{
  if (std::filesystem::exists(file(checkpoint_file)))
  {
    throw UserError(file(checkpoint_file) +
                    ": is there already; add --resume or choose another folder");
  }
  if (std::filesystem::exists(file(setup_.weights_file)))
  {
    throw UserError(file(setup_.weights_file) + ": is there already; choose another folder");
  }
}

void TrainingLoop::resume()
{
  const std::string path = file(checkpoint_file);
  if (!std::filesystem::exists(path))
  {
    throw UserError(path + ": no such file; there is no training in this folder");
  }
  const TensorFile checkpoint(path);
  loadWeights(checkpoint);
  loadOptimizerState(checkpoint, *setup_.optimizer);
  step_ = checkpoint.tensor("step").item<std::int64_t>();
  if (setup_.checkpoint_has_minutes)
  {
    minutes_before_ = checkpoint.tensor("minutes").item<double>();
  }
}

void TrainingLoop::requireNotBeyondEnd() const
{
  if (step_ > setup_.steps)
  {
    throw UserError(file(checkpoint_file) + ": is of step " + std::to_string(step_) +
                    ", but [train] steps = " + std::to_string(setup_.steps) + "; set more steps");
  }
}

void TrainingLoop::loadWeights(const TensorFile& checkpoint)
{
  checkpoint.loadWeights(setup_.network_prefix, *setup_.network);
  checkpoint.loadWeights("mean.", *setup_.mean);
  if (setup_.loss != nullptr)
  {
    checkpoint.loadWeights("loss.", *setup_.loss);
  }
}

void TrainingLoop::begin()
{
  pool_ = std::make_unique<ThreadPool>(setup_.threads);
  std::vector<std::vector<torch::Tensor>> of_copies;
  for (int i = 0; i < pool_->size(); ++i)
  {
    of_copies.push_back(task_.addCopy());
  }
  gradients_ = std::make_unique<PairGradients>(parameters_, std::move(of_copies));
  task_.beginPairs(step_);
  pool_->forChunks(static_cast<std::size_t>(setup_.batch), 1,
                   [&](std::size_t i, std::size_t, std::size_t)
                   {
                     useTorchThreads(1);  // torch uses this thread only
                     task_.preparePair(step_, i);
                   });
}

double TrainingLoop::trainStep()
{
  task_.beginPairs(step_ + 1);
  gradients_->computeStep(
      *pool_, static_cast<std::size_t>(setup_.batch),
      [&](std::size_t i, std::size_t copy)
      {
        useTorchThreads(1);
        task_.backward(step_, i, copy);
      },
      [&](std::size_t i)
      {
        useTorchThreads(1);
        task_.preparePair(step_ + 1, i);
      });
  if (std::none_of(parameters_.begin(), parameters_.end(),
                   [](const torch::Tensor& parameter) { return parameter.grad().defined(); }))
  {
    return 0;  // no pair has a loss
  }
  setup_.optimizer->param_groups().front().options().set_lr(
      setup_.rate.rateAt(step_, setup_.steps));
  const double norm = clippedStep(*setup_.optimizer, setup_.clip);
  if (std::isfinite(norm))
  {
    updateMean(*setup_.mean, *setup_.network, step_, setup_.ema_decay);
  }
  return norm;
}

bool TrainingLoop::run(const std::function<void(const std::string&)>& report,
                       const std::function<bool()>& stopped)
{
  start_ = Clock::now();
  saved_ = start_;
  first_step_ = step_;
  begin();
  makeFolder(setup_.folder, "choose another --output");
  beginLog(file(setup_.log_file), setup_.log_header, step_);
  validated_step_ = beginLog(file(validation_file), setup_.validation_header, step_);
  while (step_ < setup_.steps)
  {
    if (stopped && stopped())
    {
      save();
      report("stopped at step " + std::to_string(step_) + "; --resume continues from here");
      return false;
    }
    const double gradient = trainStep();
    ++step_;
    task_.log(gradient);
    if (setup_.validate_every > 0 && step_ % setup_.validate_every == 0)
    {
      validate();
    }
    if (checkpointDue())
    {
      save();
    }
    if (step_ == setup_.rate.firstOfDecay(setup_.steps))
    {
      writeCheckpoint(file(before_decay_file));
    }
  }
  save();
  return true;
}

bool TrainingLoop::checkpointDue() const
{
  return setup_.checkpoint_every > 0 ? step_ % setup_.checkpoint_every == 0
                                     : minutesSince(saved_) > setup_.checkpoint_minutes;
}

void TrainingLoop::save()
{
  if (saved_step_ == step_)
  {
    return;
  }
  task_.saveWeights();
  writeCheckpoint(file(checkpoint_file));
  saved_step_ = step_;
  saved_ = Clock::now();
}

void TrainingLoop::writeCheckpoint(const std::string& path) const
{
  TensorFile checkpoint;
  checkpoint.setWeights(setup_.network_prefix, *setup_.network);
  checkpoint.setWeights("mean.", *setup_.mean);
  if (setup_.loss != nullptr)
  {
    checkpoint.setWeights("loss.", *setup_.loss);
  }
  setOptimizerState(checkpoint, *setup_.optimizer);
  checkpoint.set("step", torch::tensor(step_, torch::kInt64));
  if (setup_.checkpoint_has_minutes)
  {
    checkpoint.set("minutes", torch::tensor(minutes(), torch::kFloat64));
  }
  checkpoint.write(path);
}

void TrainingLoop::validate()
{
  if (validated_step_ != step_)
  {
    validated_step_ = step_;
    task_.validate();
  }
}

double TrainingLoop::rate() const
{
  return setup_.rate.rateAt(step_ - 1, setup_.steps);
}

double TrainingLoop::minutes() const
{
  return minutes_before_ + minutesSince(start_);
}

std::string TrainingLoop::timing() const
{
  const double per_step =
      minutesSince(start_) / static_cast<double>(std::max<std::int64_t>(1, step_ - first_step_));
  return formatted("%.0f ms/pair  %.0f min left", 60e3 * per_step / setup_.batch,
                   per_step * static_cast<double>(setup_.steps - step_));
}
}  // namespace dyslam
