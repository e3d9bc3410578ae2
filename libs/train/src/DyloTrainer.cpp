// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/Printable.h>
#include <dyslam/nets/Devices.h>
#include <dyslam/nets/DyloFile.h>
#include <dyslam/nets/TensorFile.h>
#include <dyslam/nets/Threads.h>
#include <dyslam/train/Augmentation.h>
#include <dyslam/train/ChangedSettings.h>
#include <dyslam/train/DataText.h>
#include <dyslam/train/DyloLoss.h>
#include <dyslam/train/NetworkWeights.h>
#include <dyslam/train/TrainDylo.h>

#include <array>
#include <filesystem>
#include <memory>
#include <sstream>

#include "DyloPairs.h"
#include "DyloTrainOptions.h"
#include "DyloValidation.h"
#include "SimulatorPairSource.h"
#include "TrainingLoop.h"

namespace dyslam
{
namespace
{
constexpr const char* weights_file = "dylo.safetensors";  // in the folder of output
constexpr const char* log_file = "log.csv";

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

/** The options of a training. */
struct DyloTrainOptions
{
  TrainOptions train;
  DyloNetworkOptions network;
  DyloLossOptions loss;
  AugmentationOptions augmentation;
  DataOptions data;

  /** \return the effective config \throws UserError. */
  Config load(const Config& config)
  {
    return loadAll(config,
                   [this](ConfigLoader& loader)
                   {
                     train = loader.get<TrainOptions>("train");
                     network = loader.get<DyloNetworkOptions>("network");
                     loss = loader.get<DyloLossOptions>("loss");
                     augmentation = loader.get<AugmentationOptions>("augmentation");
                     data = loader.get<DataOptions>("data");
                   });
  }
};

class Trainer : public TrainingTask
{
 public:
  Trainer(const Config& config, const DyloTrainRequest& request);
  void run();

 private:
  [[nodiscard]] TrainingLoopSetup loopSetup() const;
  void loadWeights();
  void startFrom(const std::string& path);
  std::vector<torch::Tensor> addCopy() override;
  void preparePair(std::int64_t step, std::size_t pair) override;
  void backward(std::int64_t step, std::size_t number, std::size_t copy) override;
  void log(double gradient) override;
  void validate() override;
  void saveWeights() override { saveDylo(mean_, loop_->file(weights_file)); }

  const DyloTrainRequest& request_;
  DyloTrainOptions options_;
  DyloNetwork network_{nullptr};
  DyloNetwork mean_{nullptr};  //!< exponential moving average of the network's weights
  DyloLoss loss_{nullptr};
  std::unique_ptr<TrainingLoop> loop_;
  std::unique_ptr<PairSource> source_;
  std::vector<ThreadCopy> copies_;                      //!< one per thread
  std::array<std::vector<PreparedDyloPair>, 2> batch_;  //!< pairs of the even and of the odd steps
  std::vector<DyloLossImpl::Terms> terms_;              //!< losses of the pairs of this step
  std::vector<Recording> validation_;
  torch::Device device_;
};

Trainer::Trainer(const Config& config, const DyloTrainRequest& request)
    : request_(request), device_(deviceNamed(request.device, "--device"))
{
  const Config effective = options_.load(config);
  useTorchThreads(options_.train.threads);
  torch::manual_seed(static_cast<std::uint64_t>(options_.train.seed));
  batch_.fill(std::vector<PreparedDyloPair>(static_cast<std::size_t>(options_.train.batch)));
  terms_.resize(static_cast<std::size_t>(options_.train.batch));
  network_ = DyloNetwork(options_.network);
  mean_ = DyloNetwork(options_.network);
  loss_ = DyloLoss(options_.loss);
  network_->to(device_);
  mean_->to(device_);
  copyWeights(*mean_, *network_, "");
  loss_->to(device_);

  loop_ = std::make_unique<TrainingLoop>(loopSetup(), *this);
  loadWeights();
  const std::string base = dataFolder(options_.data.base, "[data] base");
  const DataSplits splits = DataSplits::load(options_.data.splits, "[data] splits");
  validation_ = loadRecordings(options_.data.validation, base, splits, Split::validation);
  for (const std::string& item : listItems(options_.data.simulated_validation, '|'))
  {
    validation_.push_back(simulateRecording(item, splits));
  }
  if (!request.validate_only)
  {
    source_ = makeDyloPairSource(options_.data, options_.augmentation, base, splits,
                                 static_cast<std::uint64_t>(options_.train.seed));
    writeSettings(effective, request);
  }
}

TrainingLoopSetup Trainer::loopSetup() const
{
  TrainingLoopSetup setup;
  setup.folder = request_.output;
  setup.weights_file = weights_file;
  setup.log_file = log_file;
  setup.log_header =
      "step,learning_rate,loss,pose,flow,precision,moving,final_pose,gradient,first_stage_m,"
      "last_stage_m";
  setup.validation_header =
      "step,recording,start,t_mean_m,t_rmse_m,r_mean_deg,r_rmse_deg,forward_ratio";
  setup.steps = options_.train.steps;
  setup.batch = options_.train.batch;
  setup.threads = options_.train.threads;
  setup.rate = options_.train.rate;
  setup.ema_decay = options_.train.ema_decay;
  setup.clip = options_.train.clip;
  setup.validate_every = options_.train.validate_every;
  setup.checkpoint_minutes = options_.train.checkpoint_minutes;
  setup.network_prefix = "network.";
  setup.network = network_.ptr();
  setup.mean = mean_.ptr();
  setup.loss = loss_.ptr();
  setup.optimizer = std::make_shared<torch::optim::Adam>(
      parametersOf(network_, loss_),
      torch::optim::AdamOptions(options_.train.rate.learning_rate).betas({0.9, 0.999}));
  return setup;
}

/** Starts from given weights, from the last checkpoint, or anew. */
void Trainer::loadWeights()
{
  if (request_.validate_only && !request_.start.empty())
  {
    startFrom(request_.start);
  }
  else if (request_.resume || request_.validate_only)
  {
    loop_->resume();
    if (request_.resume)
    {
      loop_->requireNotBeyondEnd();
    }
  }
  else
  {
    loop_->requireFreshFolder();
    if (!request_.start.empty())
    {
      startFrom(request_.start);
    }
  }
}

std::vector<torch::Tensor> Trainer::addCopy()
{
  ThreadCopy copy{DyloNetwork(network_->options()), DyloLoss(loss_->options())};
  copy.network->to(device_);
  copy.loss->to(device_);
  copies_.push_back(copy);
  return parametersOf(copy.network, copy.loss);
}

void Trainer::preparePair(std::int64_t step, std::size_t pair)
{
  std::vector<PreparedDyloPair>& batch = batch_[static_cast<std::size_t>(step % 2)];
  const std::uint64_t index = static_cast<std::uint64_t>(step) * batch.size() + pair;
  batch[pair] = prepareDyloPair(source_->pair(index), options_.train.perturbed_starts,
                                static_cast<std::uint64_t>(options_.train.seed), index, device_);
}

void Trainer::backward(std::int64_t step, std::size_t number, std::size_t copy)
{
  const PreparedDyloPair& pair = batch_[static_cast<std::size_t>(step % 2)][number];
  const auto options = torch::dtype(torch::kFloat).device(device_);
  DyloNetwork& network = copies_[copy].network;
  const auto stages = network->forward(network->encode(pair.scan1), network->encode(pair.scan2),
                                       PoseTensors::from(pair.start, options));
  DyloLossImpl::Terms terms = copies_[copy].loss->forward(
      stages, pair.scan1, PoseTensors::from(pair.T_2_1, options), pair.labels);
  (terms.total / options_.train.batch).backward();
  for (torch::Tensor* term :
       {&terms.total, &terms.pose, &terms.flow, &terms.precision, &terms.moving, &terms.final_pose})
  {
    *term = term->detach();  // the graph is not needed for the log
  }
  terms_[number] = std::move(terms);
}

void Trainer::run()
{
  if (request_.validate_only)
  {
    if (validation_.empty())
    {
      throw UserError(
          "--validate: there is nothing to validate on; set [data] validation or "
          "simulated_validation");
    }
    validate();
    return;
  }
  request_.report("training on: " + source_->name());
  if (loop_->run(request_.report, request_.stopped))
  {
    loop_->validate();
  }
}

void Trainer::log(double gradient)
{
  if (loop_->step() % options_.train.report_every != 0)
  {
    return;
  }
  using Terms = DyloLossImpl::Terms;
  const auto count = static_cast<double>(terms_.size());
  const auto mean = [&](torch::Tensor Terms::*term)
  {
    double sum = 0;
    for (const Terms& pair : terms_)
    {
      sum += (pair.*term).item<double>();
    }
    return sum / count;
  };
  double first_error = 0;
  double last_error = 0;
  for (const Terms& pair : terms_)
  {
    first_error += pair.translation_error.front() / count;
    last_error += pair.translation_error.back() / count;
  }
  const double loss = mean(&Terms::total);
  std::ostringstream row;
  row << loop_->step() << ',' << loop_->rate() << ',' << loss << ',' << mean(&Terms::pose) << ','
      << mean(&Terms::flow) << ',' << mean(&Terms::precision) << ',' << mean(&Terms::moving) << ','
      << mean(&Terms::final_pose) << ',' << gradient << ',' << first_error << ',' << last_error;
  appendRows(loop_->file(log_file), {row.str()});
  request_.report(formatted("step %lld/%d  loss %.3f  t %.3f -> %.4f m  |g| %.2f  ",
                            static_cast<long long>(loop_->step()), options_.train.steps, loss,
                            first_error, last_error, gradient) +
                  loop_->timing());
}

void Trainer::validate()
{
  if (validation_.empty())
  {
    return;
  }
  useTorchThreads(options_.train.threads);
  if (!request_.mask_folder.empty())
  {
    makeFolder(request_.mask_folder);
  }
  const auto rows = validateDylo(mean_, validation_, device_, request_.mask_folder);
  const std::string when = request_.validate_only && !request_.start.empty()
                               ? "validation of " + request_.start
                               : "validation at step " + std::to_string(loop_->step());
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
      line << loop_->step() << ',' << row.recording << ','
           << (predicted ? "prediction" : "standing") << ',' << e.translation.mean << ','
           << e.translation.rmse << ',' << e.rotation_deg.mean << ',' << e.rotation_deg.rmse << ','
           << e.forward_ratio;
      lines.push_back(line.str());
    }
  }
  appendRows(loop_->file("validation.csv"), lines);
}

/** Loads a checkpoint of the same network, or the common layers of a model. */
void Trainer::startFrom(const std::string& path)
{
  if (!isDyloModel(path))
  {
    if (!std::filesystem::exists(path))
    {
      throw UserError(path + ": no such file; give a checkpoint.safetensors or a dylo.safetensors");
    }
    loop_->loadWeights(TensorFile(path));
    return;
  }
  const torch::NoGradGuard no_grad;
  const DyloNetwork loaded = loadDylo(path);
  if (request_.validate_only)
  {
    requireSameNetwork(loaded->options(), network_->options(), path);
  }
  const auto own = network_->named_parameters();
  std::size_t taken = 0;
  for (const auto& given : loaded->named_parameters())
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
}  // namespace

void trainDylo(const Config& config, const DyloTrainRequest& request)
{
  Trainer(config, request).run();
}

Config dyloTrainDefaults()
{
  return DyloTrainOptions().load(Config());
}
}  // namespace dyslam
