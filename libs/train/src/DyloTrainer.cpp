// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/core/Files.h>
#include <dyslam/core/Parallel.h>
#include <dyslam/core/PendingFile.h>
#include <dyslam/nets/Devices.h>
#include <dyslam/nets/DyloFile.h>
#include <dyslam/nets/TensorFile.h>
#include <dyslam/nets/Threads.h>
#include <dyslam/train/Augmentation.h>
#include <dyslam/train/DataText.h>
#include <dyslam/train/DyloLoss.h>
#include <dyslam/train/DyloTrainer.h>
#include <dyslam/train/NetworkWeights.h>
#include <dyslam/train/PairGradients.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <sstream>

#include "DyloPairs.h"
#include "DyloTrainOptions.h"
#include "DyloValidation.h"
#include "SimulatorPairSource.h"

namespace dyslam
{
namespace
{
using Clock = std::chrono::steady_clock;

constexpr const char* checkpoint_file = "/checkpoint.safetensors";  // in the folder of output
constexpr const char* before_decay_file = "/checkpoint_before_decay.safetensors";
constexpr const char* weights_file = "/dylo.safetensors";

double secondsSince(Clock::time_point begin)
{
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/** A thread's copy of what is trained. */
struct ThreadCopy
{
  DyloNetwork network{nullptr};
  DyloLoss loss{nullptr};
};

std::vector<torch::Tensor> parametersOf(const DyloNetwork& network, const DyloLoss& loss)
{
  std::vector<torch::Tensor> parameters = network->parameters();
  for (const torch::Tensor& parameter : loss->parameters())
  {
    parameters.push_back(parameter);
  }
  return parameters;
}

class Trainer
{
 public:
  Trainer(const Config& config, const DyloTrainRequest& request);
  void run();

 private:
  void save();
  void writeCheckpoint(const std::string& path);
  /** Loads a checkpoint. \param weights_only without the optimizer's state and the step */
  void load(const std::string& checkpoint, bool weights_only);
  void startFrom(const std::string& path);
  void validate();
  /** Makes the threads, their copies of the network, and the pairs of the first step. */
  void begin();
  [[nodiscard]] PreparedDyloPair preparePair(std::uint64_t index) const;
  /** Loss of a pair; adds to the gradients of the copy. */
  DyloLossImpl::Terms backward(ThreadCopy& copy, const PreparedDyloPair& pair) const;
  /** Sets the gradients of a step and prepares the pairs of the next one. */
  std::vector<DyloLossImpl::Terms> computeGradients();
  /** \param pairs those of the step. */
  void log(const std::vector<DyloLossImpl::Terms>& pairs, double gradient);

  const DyloTrainRequest& request_;
  TrainOptions options_;
  DataOptions data_;
  AugmentationOptions augmentation_;
  DyloNetwork network_{nullptr};
  DyloNetwork mean_{nullptr};  //!< exponential moving average of its weights
  DyloLoss loss_{nullptr};
  std::unique_ptr<torch::optim::Adam> optimizer_;
  std::unique_ptr<PairSource> source_;
  std::unique_ptr<ThreadPool> pool_;
  std::vector<ThreadCopy> copies_;  //!< one per thread
  std::unique_ptr<PairGradients> gradients_;
  std::vector<PreparedDyloPair> prepared_;  //!< the pairs of this step
  std::vector<Recording> validation_;
  torch::Device device_;
  std::int64_t step_ = 0;
  std::int64_t first_step_ = 0;
  Clock::time_point begin_;
};

Trainer::Trainer(const Config& config, const DyloTrainRequest& request)
    : request_(request), device_(deviceNamed(request.device, "--device"))
{
  ConfigLoader loader(config);
  options_ = loader.get<TrainOptions>("train");
  const auto shape = loader.get<DyloNetworkOptions>("network");
  const auto loss = loader.get<DyloLossOptions>("loss");
  augmentation_ = loader.get<AugmentationOptions>("augmentation");
  data_ = loader.get<DataOptions>("data");
  loader.requireAllUsed();

  useTorchThreads(options_.threads);
  torch::manual_seed(static_cast<std::uint64_t>(options_.seed));
  network_ = DyloNetwork(shape);
  mean_ = DyloNetwork(shape);
  loss_ = DyloLoss(loss);
  network_->to(device_);
  mean_->to(device_);
  copyWeights(*mean_, *network_, "");
  loss_->to(device_);
  optimizer_ = std::make_unique<torch::optim::Adam>(
      parametersOf(network_, loss_),
      torch::optim::AdamOptions(options_.rate.learning_rate).betas({0.9, 0.999}));

  if (request.validate_only && !request.start.empty())
  {
    startFrom(request.start);
  }
  else if (request.resume || request.validate_only)
  {
    load(request.output + checkpoint_file, false);
  }
  else if (std::filesystem::exists(request.output + checkpoint_file))
  {
    throw UserError(request.output + checkpoint_file +
                    ": is there already; add --resume or choose another folder");
  }
  else if (!request.start.empty())
  {
    startFrom(request.start);
  }
  if (!request.validate_only)
  {
    makeFolder(request.output, "choose another --output");
  }
  const std::string base = dataFolder(data_.base, "[data] base");
  const DataSplits splits = DataSplits::load(data_.splits, "[data] splits");
  validation_ = loadRecordings(data_.validation, base, splits, Split::validation);
  for (const std::string& item : listItems(data_.simulated_validation, '|'))
  {
    validation_.push_back(simulateRecording(item, splits));
  }
  if (!request.validate_only)
  {
    writeWhole(request.output + "/effective.ini", loader.effective().toIni());
    source_ = makeDyloPairSource(data_, augmentation_, base, splits,
                                 static_cast<std::uint64_t>(options_.seed));
  }
}

void Trainer::begin()
{
  pool_ = std::make_unique<ThreadPool>(options_.threads);
  std::vector<std::vector<torch::Tensor>> of_copies;
  for (int i = 0; i < pool_->size(); ++i)
  {
    ThreadCopy copy{DyloNetwork(network_->options()), DyloLoss(loss_->options())};
    copy.network->to(device_);
    copy.loss->to(device_);
    of_copies.push_back(parametersOf(copy.network, copy.loss));
    copies_.push_back(std::move(copy));
  }
  gradients_ = std::make_unique<PairGradients>(parametersOf(network_, loss_), std::move(of_copies));
  prepared_.resize(static_cast<std::size_t>(options_.batch));
  const auto first = static_cast<std::uint64_t>(step_) * prepared_.size();
  pool_->forChunks(prepared_.size(), 1,
                   [&](std::size_t i, std::size_t, std::size_t)
                   { prepared_[i] = preparePair(first + i); });
}

PreparedDyloPair Trainer::preparePair(std::uint64_t index) const
{
  return prepareDyloPair(source_->pair(index), options_.perturbed_starts,
                         static_cast<std::uint64_t>(options_.seed), index, device_);
}

DyloLossImpl::Terms Trainer::backward(ThreadCopy& copy, const PreparedDyloPair& pair) const
{
  useTorchThreads(1);  // of this thread
  const auto options = torch::dtype(torch::kFloat).device(device_);
  DyloNetwork& network = copy.network;
  const auto stages = network->forward(network->encode(pair.scan1), network->encode(pair.scan2),
                                       PoseTensors::from(pair.start, options));
  DyloLossImpl::Terms terms =
      copy.loss->forward(stages, pair.scan1, PoseTensors::from(pair.T_2_1, options), pair.labels);
  (terms.total / options_.batch).backward();
  for (torch::Tensor* term :
       {&terms.total, &terms.pose, &terms.flow, &terms.precision, &terms.moving, &terms.final_pose})
  {
    *term = term->detach();  // the graph is not needed for the log
  }
  return terms;
}

std::vector<DyloLossImpl::Terms> Trainer::computeGradients()
{
  const std::size_t batch = prepared_.size();
  const auto next_step = static_cast<std::uint64_t>(step_ + 1) * batch;
  std::vector<DyloLossImpl::Terms> terms(batch);
  std::vector<PreparedDyloPair> next(batch);
  gradients_->computeStep(
      *pool_, batch,
      [&](std::size_t i, std::size_t copy) { terms[i] = backward(copies_[copy], prepared_[i]); },
      [&](std::size_t i) { next[i] = preparePair(next_step + i); });
  prepared_ = std::move(next);
  return terms;
}

void Trainer::run()
{
  begin_ = Clock::now();
  first_step_ = step_;
  if (request_.validate_only)
  {
    validate();
    return;
  }
  beginLog(request_.output + "/log.csv",
           "step,learning_rate,loss,pose,flow,precision,moving,final_pose,gradient,first_stage_m,"
           "last_stage_m",
           step_);
  beginLog(request_.output + "/validation.csv",
           "step,recording,start,t_mean_m,t_rmse_m,r_mean_deg,r_rmse_deg,forward_ratio", step_);
  auto saved = Clock::now();
  request_.report("training on: " + source_->name());
  begin();
  while (step_ < options_.steps)
  {
    if (request_.stopped && request_.stopped())
    {
      save();
      request_.report("stopped at step " + std::to_string(step_) +
                      "; --resume continues from here");
      return;
    }
    const double rate = options_.rate.rateAt(step_, options_.steps);
    for (auto& group : optimizer_->param_groups())
    {
      static_cast<torch::optim::AdamOptions&>(group.options()).lr(rate);
    }
    const std::vector<DyloLossImpl::Terms> pairs = computeGradients();
    const double gradient = clippedStep(*optimizer_, options_.clip);
    updateMean(*mean_, *network_, step_, options_.ema_decay);
    ++step_;
    log(pairs, gradient);
    if (step_ % options_.validate_every == 0)
    {
      validate();
    }
    if (secondsSince(saved) > 60 * options_.checkpoint_minutes || step_ == options_.steps)
    {
      save();
      saved = Clock::now();
    }
    if (step_ == options_.rate.firstOfDecay(options_.steps))
    {
      writeCheckpoint(request_.output + before_decay_file);
    }
  }
}

void Trainer::log(const std::vector<DyloLossImpl::Terms>& pairs, double gradient)
{
  if (step_ % options_.report_every != 0)
  {
    return;
  }
  using Terms = DyloLossImpl::Terms;
  const auto count = static_cast<double>(pairs.size());
  const auto mean = [&](torch::Tensor Terms::*term)
  {
    double sum = 0;
    for (const Terms& pair : pairs)
    {
      sum += (pair.*term).item<double>();
    }
    return sum / count;
  };
  double first_error = 0;
  double last_error = 0;
  for (const Terms& pair : pairs)
  {
    first_error += pair.translation_error.front() / count;
    last_error += pair.translation_error.back() / count;
  }
  const double loss = mean(&Terms::total);
  std::ostringstream row;
  row << step_ << ',' << options_.rate.rateAt(step_ - 1, options_.steps) << ',' << loss << ','
      << mean(&Terms::pose) << ',' << mean(&Terms::flow) << ',' << mean(&Terms::precision) << ','
      << mean(&Terms::moving) << ',' << mean(&Terms::final_pose) << ',' << gradient << ','
      << first_error << ',' << last_error;
  appendRows(request_.output + "/log.csv", {row.str()});
  const auto done = static_cast<double>(step_ - first_step_);
  const double per_step = secondsSince(begin_) / done;
  char line[240];
  std::snprintf(line, sizeof line,
                "step %lld/%d  loss %.3f  t %.3f -> %.4f m  |g| %.2f  %.0f ms/pair  %.0f min left",
                static_cast<long long>(step_), options_.steps, loss, first_error, last_error,
                gradient, 1e3 * per_step / options_.batch,
                per_step * static_cast<double>(options_.steps - step_) / 60);
  request_.report(line);
}

void Trainer::validate()
{
  if (validation_.empty())
  {
    return;
  }
  useTorchThreads(options_.threads);
  if (!request_.mask_folder.empty())
  {
    makeFolder(request_.mask_folder);
  }
  const auto rows = validateDylo(mean_, validation_, device_, request_.mask_folder);
  const std::string when = request_.validate_only && !request_.start.empty()
                               ? "validation of " + request_.start
                               : "validation at step " + std::to_string(step_);
  request_.report(when + "\n" + validationTable(rows));
  if (request_.validate_only)
  {
    return;
  }
  std::vector<std::string> lines;
  for (const ValidationRow& row : rows)
  {
    for (const bool predicted : {false, true})
    {
      const MotionErrors& e = predicted ? row.predicted_start : row.network;
      std::ostringstream line;
      line << step_ << ',' << row.recording << ',' << (predicted ? "prediction" : "standing") << ','
           << e.translation_mean << ',' << e.translation_rmse << ',' << e.rotation_mean_deg << ','
           << e.rotation_rmse_deg << ',' << e.forward_ratio;
      lines.push_back(line.str());
    }
  }
  appendRows(request_.output + "/validation.csv", lines);
}

void Trainer::save()
{
  writeCheckpoint(request_.output + checkpoint_file);
  saveDylo(mean_, request_.output + weights_file);
}

void Trainer::writeCheckpoint(const std::string& path)
{
  TensorFile checkpoint;
  checkpoint.setWeights("network.", *network_);
  checkpoint.setWeights("mean.", *mean_);
  checkpoint.setWeights("loss.", *loss_);
  setOptimizerState(checkpoint, *optimizer_);
  checkpoint.set("step", torch::tensor(step_, torch::kInt64));
  checkpoint.write(path);
}

/** Loads a checkpoint of the same network, or the common layers of a model. */
void Trainer::startFrom(const std::string& path)
{
  if (!isDyloModel(path))
  {
    load(path, true);
    return;
  }
  const torch::NoGradGuard no_grad;
  const auto own = network_->named_parameters();
  std::size_t taken = 0;
  for (const auto& given : loadDylo(path)->named_parameters())
  {
    const torch::Tensor* mine = own.find(given.key());
    if (mine != nullptr && mine->sizes() == given.value().sizes())
    {
      torch::Tensor(*mine).copy_(given.value());
      ++taken;
    }
  }
  if (taken == 0)
  {
    throw UserError(path + ": fits none of the [network]'s layers; give weights of a like one");
  }
  copyWeights(*mean_, *network_, path);
  request_.report("started from " + path + ": " + std::to_string(taken) + " of " +
                  std::to_string(own.size()) + " tensors");
}

void Trainer::load(const std::string& path, bool weights_only)
{
  if (!std::filesystem::exists(path))
  {
    throw UserError(path + ": no such file; " +
                    (weights_only ? "give a checkpoint.safetensors or a dylo.safetensors"
                                  : "there is no training in this folder to continue"));
  }
  const TensorFile checkpoint(path);
  checkpoint.loadWeights("network.", *network_);
  checkpoint.loadWeights("mean.", *mean_);
  checkpoint.loadWeights("loss.", *loss_);
  if (!weights_only)
  {
    loadOptimizerState(checkpoint, *optimizer_);
    step_ = checkpoint.tensor("step").item<std::int64_t>();
  }
}
}  // namespace

void trainDylo(const Config& config, const DyloTrainRequest& request)
{
  Trainer(config, request).run();
}
}  // namespace dyslam
