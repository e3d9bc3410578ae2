// SPDX-License-Identifier: BSD-3-Clause
#include "DysegTrainer.h"

#include <dyslam/base/Error.h>
#include <dyslam/nets/Devices.h>
#include <dyslam/nets/DysegFile.h>
#include <dyslam/nets/DysegModel.h>
#include <dyslam/nets/Threads.h>
#include <dyslam/train/ChangedSettings.h>
#include <dyslam/train/DataText.h>
#include <dyslam/train/DysegLosses.h>
#include <dyslam/train/DysegScores.h>
#include <dyslam/train/NetworkWeights.h>
#include <dyslam/train/TrainDyseg.h>
#include <torch/torch.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "DysegCrop.h"
#include "DysegPairs.h"
#include "DysegValidation.h"
#include "TrainingLoop.h"

namespace dyslam
{
namespace
{
constexpr double clip_norm = 2;
constexpr int report_every = 20;  // steps between reports

constexpr const char* weights_file = "dyseg.safetensors";  // in the folder of output
constexpr const char* log_file = "train.csv";

/** A pair of a step, with the random numbers that its loss draws. */
struct PreparedPair
{
  DysegSample sample;
  Eigen::Vector2f centre = Eigen::Vector2f::Zero();
  RandomDraws draws{0, 0};
};

/** Adds the terms of a loss but its total, each divided by `divisor`. */
void addTerms(const DysegLoss& loss, int divisor, DysegLoss& sum)
{
  sum.matching += loss.matching / divisor;
  sum.flow += loss.flow / divisor;
  sum.static_probability += loss.static_probability / divisor;
  sum.cell += loss.cell / divisor;
  sum.point += loss.point / divisor;
}

/** \param otherwise what else the user can do \throws UserError naming the file, the key and both
 * values if they differ. */
void requireSameValue(const std::string& file,
                      const char* key,
                      double of_weights,
                      double given,
                      const char* otherwise)
{
  if (of_weights != given)
  {
    char values[160];
    std::snprintf(values, sizeof(values),
                  ": trained with [grid] %s = %g, not %g; set it to %g, or %s", key, of_weights,
                  given, of_weights, otherwise);
    throw UserError(file + values);
  }
}

/** Requires that weights were trained for this grid; only its extent may differ. \throws UserError
 * naming the file, the key and both values. */
void requireSameGrid(const BevOptions& of_weights,
                     const BevOptions& grid,
                     const std::string& file,
                     const char* otherwise = "train from scratch")
{
  const auto require = [&](const char* key, double own, double given)
  { requireSameValue(file, key, own, given, otherwise); };
  require("cell_size", of_weights.cell_size, grid.cell_size);
  require("ground_clearance", of_weights.ground_clearance, grid.ground_clearance);
  require("max_height", of_weights.max_height, grid.max_height);
}

/** Requires that weights, which are validated with the grid that they were trained for, were
 * trained for this one. \throws UserError as requireSameGrid(). */
void requireGridOfValidation(const BevOptions& of_weights,
                             const BevOptions& grid,
                             const std::string& file)
{
  const char* otherwise = "leave it out";
  requireSameGrid(of_weights, grid, file, otherwise);
  requireSameValue(file, "cells", of_weights.cells, grid.cells, otherwise);
}
}  // namespace

struct DysegTrainer::Impl : TrainingTask
{
  DysegTrainerOptions options;
  DysegAugmentOptions augmentation;
  DysegLossOptions loss_options;
  BevOptions grid;
  BevOptions crop;
  std::function<void(const std::string&)> report;
  DysegNet net{nullptr};
  DysegNet mean{nullptr};  //!< exponential moving average of the weights
  torch::Device device = torch::kCPU;
  std::unique_ptr<TrainingLoop> loop;

  std::unique_ptr<DysegPairs> pairs;
  std::vector<DysegNet> copies;                    //!< copies of the network, one per thread
  std::array<std::vector<PreparedPair>, 2> batch;  //!< pairs of the even and of the odd steps
  std::vector<DysegLoss> losses;                   //!< losses of the pairs of this step
  DysegLoss sum;                                   //!< sum of losses since the last row of the log
  int counted = 0;                                 //!< number of steps in `sum`
  std::vector<DysegValidationSet> validation;

  std::vector<torch::Tensor> addCopy() override;
  void beginPairs(std::int64_t step) override { pairs->prepare(static_cast<int>(step)); }
  void preparePair(std::int64_t step, std::size_t number) override;
  void backward(std::int64_t step, std::size_t number, std::size_t copy) override;
  void log(double gradient) override;
  /** One line of progress for the user. \param loss mean since the last line */
  [[nodiscard]] std::string progress(const DysegLoss& loss) const;
  /** A row of train.csv. \param loss mean since the last row */
  [[nodiscard]] std::string logRow(const DysegLoss& loss) const;
  void validate() override;
  void saveWeights() override { saveDyseg({mean, grid}, loop->file(weights_file)); }
  /** Rows "set,scores" of the validation of the weights in a file. \param given grid and network
   * that they must have been trained for; nothing: any */
  std::vector<std::string> evaluate(const std::string& weights, const GivenDysegShape& given = {});
};

std::vector<torch::Tensor> DysegTrainer::Impl::addCopy()
{
  copies.emplace_back(net->options());
  copies.back()->to(device);
  return copies.back()->parameters();
}

void DysegTrainer::Impl::preparePair(std::int64_t step, std::size_t number)
{
  PreparedPair& pair = batch[static_cast<std::size_t>(step % 2)][number];
  pair.draws =
      RandomDraws(static_cast<std::uint64_t>(options.seed),
                  static_cast<std::uint64_t>(step) * DysegTrainerOptions::max_batch + number);
  pair.sample = pairs->draw(pair.draws);
  augment(augmentation, pair.draws, pair.sample);
  pair.centre = drawCentre(pair.sample, grid, crop, options.crop_reach, pair.draws);
}

void DysegTrainer::Impl::backward(std::int64_t step, std::size_t number, std::size_t copy)
{
  PreparedPair& pair = batch[static_cast<std::size_t>(step % 2)][number];
  losses[number] = {};
  DysegLoss loss =
      dysegLoss(copies[copy], pair.sample, crop, pair.centre, loss_options, pair.draws);
  if (!loss.total.defined() || !loss.total.requires_grad() ||
      !std::isfinite(loss.total.item<double>()))
  {
    return;
  }
  (loss.total / options.batch).backward();
  loss.total.reset();  // the graph is not needed for the log
  losses[number] = loss;
}

void DysegTrainer::Impl::log(double /*gradient*/)
{
  DysegLoss of_step;
  for (const DysegLoss& loss : losses)
  {
    addTerms(loss, options.batch, of_step);
  }
  addTerms(of_step, 1, sum);
  ++counted;
  if (loop->step() % report_every == 0)
  {
    DysegLoss mean_loss;
    addTerms(sum, counted, mean_loss);
    appendRows(loop->file(log_file), {logRow(mean_loss)});
    report(progress(mean_loss));
    sum = DysegLoss();
    counted = 0;
  }
}

std::string DysegTrainer::Impl::progress(const DysegLoss& loss) const
{
  char line[200];
  std::snprintf(line, sizeof(line),
                "step %lld/%d  matching %.3f  flow %.3f  static %.3f  cell %.3f  point %.3f  ",
                static_cast<long long>(loop->step()), options.steps, loss.matching, loss.flow,
                loss.static_probability, loss.cell, loss.point);
  return line + loop->timing();
}

std::string DysegTrainer::Impl::logRow(const DysegLoss& loss) const
{
  char row[200];
  std::snprintf(row, sizeof(row), "%lld,%.2f,%.6f,%.4f,%.4f,%.4f,%.4f,%.4f",
                static_cast<long long>(loop->step()), loop->minutes(), loop->rate(), loss.matching,
                loss.flow, loss.static_probability, loss.cell, loss.point);
  return row;
}

std::vector<std::string> DysegTrainer::Impl::evaluate(const std::string& weights,
                                                      const GivenDysegShape& given)
{
  // The file is read first: if it is missing, the user need not wait for the validation data.
  const DysegModel model(weights, options.threads, device.is_cuda() ? "cuda" : "cpu");
  if (given.grid)
  {
    requireGridOfValidation(model.grid(), *given.grid, weights);
  }
  if (given.network)
  {
    requireSameNetwork(loadDyseg(weights).net->options(), *given.network, weights, "leave it out");
  }
  if (validation.empty())
  {
    validation = makeDysegValidation(options);
  }
  std::vector<std::string> rows;
  for (const DysegValidationSet& set : validation)
  {
    DysegScores s;
    for (const DysegSample& sample : set.samples)
    {
      const PlanarPrior guess{PlanarMotion::fromPose(sample.T_past_current)};
      s.add(scorePair(model, sample, set.with_guess ? &guess : nullptr));
    }
    rows.push_back(set.name + scoreFields(s));
  }
  return rows;
}

void DysegTrainer::Impl::validate()
{
  loop->save();
  const std::string step = std::to_string(loop->step());
  report("validation at step " + step + ": " + dyseg_score_names);
  std::vector<std::string> rows;
  for (const std::string& row : evaluate(loop->file(weights_file)))
  {
    rows.push_back(step + "," + row);
    report("  " + row);
  }
  appendRows(loop->file("validation.csv"), rows);
}

DysegTrainer::DysegTrainer(const DysegTrainerSetup& setup, std::string folder)
    : impl_(std::make_unique<Impl>())
{
  const DysegTrainerOptions& options = setup.train;
  const DysegNetworkOptions& network = setup.network;
  validate(options, "train");
  checkDysegValidation(options);
  useTorchThreads(options.threads);
  impl_->options = options;
  impl_->augmentation = setup.augmentation;
  impl_->loss_options = setup.loss;
  impl_->grid = setup.grid;
  impl_->crop = setup.grid;
  impl_->crop.cells = std::min(options.crop, setup.grid.cells);
  torch::manual_seed(static_cast<std::uint64_t>(options.seed));
  impl_->device = deviceNamed(setup.device, "--device");
  impl_->batch.fill(std::vector<PreparedPair>(static_cast<std::size_t>(options.batch)));
  impl_->losses.resize(static_cast<std::size_t>(options.batch));
  impl_->net = DysegNet(network);
  impl_->mean = DysegNet(network);
  impl_->net->to(impl_->device);
  impl_->mean->to(impl_->device);
  copyWeights(*impl_->mean, *impl_->net, "");

  TrainingLoopSetup loop;
  loop.folder = std::move(folder);
  loop.weights_file = weights_file;
  loop.log_file = log_file;
  loop.log_header = "step,minutes,rate,matching,flow,static_probability,cell,point";
  loop.validation_header = std::string("step,") + dyseg_score_names;
  loop.steps = options.steps;
  loop.batch = options.batch;
  loop.threads = options.threads;
  loop.rate = options.rate;
  loop.ema_decay = options.ema_decay;
  loop.clip = clip_norm;
  loop.validate_every = options.validate_every;
  loop.checkpoint_every = options.checkpoint_every;
  loop.checkpoint_has_minutes = true;
  loop.network_prefix = "net.";
  loop.network = impl_->net.ptr();
  loop.mean = impl_->mean.ptr();
  loop.optimizer = std::make_shared<torch::optim::AdamW>(
      impl_->net->parameters(),
      torch::optim::AdamWOptions(options.rate.learning_rate).weight_decay(options.weight_decay));
  impl_->loop = std::make_unique<TrainingLoop>(std::move(loop), *impl_);
}

DysegTrainer::~DysegTrainer() = default;

void DysegTrainer::requireFreshFolder() const
{
  impl_->loop->requireFreshFolder();
}

void DysegTrainer::startFrom(const std::string& weights)
{
  const auto loaded = loadDyseg(weights);
  requireSameGrid(loaded.grid, impl_->grid, weights);
  for (auto* net : {&impl_->net, &impl_->mean})
  {
    copyWeights(**net, *loaded.net, weights);
  }
}

void DysegTrainer::resume()
{
  impl_->loop->resume();
  impl_->loop->requireNotBeyondEnd();
  // The checkpoint does not have the grid; the weights that were saved with it do.
  const std::string weights = impl_->loop->file(weights_file);
  if (std::filesystem::exists(weights))
  {
    requireSameGrid(loadDyseg(weights).grid, impl_->grid, weights);
  }
}

void DysegTrainer::validateOnly(const std::string& weights,
                                const GivenDysegShape& given,
                                const std::function<void(const std::string&)>& report)
{
  report(std::string("validation: ") + dyseg_score_names);
  for (const std::string& row :
       impl_->evaluate(weights.empty() ? impl_->loop->file(weights_file) : weights, given))
  {
    report("  " + row);
  }
}

void DysegTrainer::loadData()
{
  Impl& t = *impl_;
  if (t.options.validate_every > 0 && t.loop->step() < t.options.steps)
  {
    // Missing data are reported now, not after hours.
    t.validation = makeDysegValidation(t.options);
  }
  t.pairs = std::make_unique<DysegPairs>(t.options);
}

void DysegTrainer::run(const std::function<void(const std::string&)>& report,
                       const std::function<bool()>& stopped)
{
  Impl& t = *impl_;
  if (!t.pairs)
  {
    loadData();
  }
  report("data: " + t.pairs->summary());
  t.report = report;
  if (t.loop->run(report, stopped) && t.options.validate_every > 0)
  {
    t.loop->validate();
  }
}

void trainDyseg(const Config& config, const TrainRequest& request)
{
  DysegTrainerSetup setup;
  const Config effective = setup.load(config);
  setup.device = request.device;
  setup.train.data = dataFolder(setup.train.data, "[train] data");
  DysegTrainer trainer(setup, request.output);
  if (request.validate_only)
  {
    GivenDysegShape given;
    if (!config.section("grid").empty())
    {
      given.grid = setup.grid;
    }
    if (!config.section("network").empty())
    {
      given.network = setup.network;
    }
    trainer.validateOnly(request.start, given, request.report);
    return;
  }
  if (request.resume)
  {
    trainer.resume();
  }
  else
  {
    trainer.requireFreshFolder();
    if (!request.start.empty())
    {
      trainer.startFrom(request.start);
    }
  }
  trainer.loadData();  // before anything is written: settings that fail leave the folder as it is
  writeSettings(effective, request);
  trainer.run(request.report, request.stopped);
}
}  // namespace dyslam
