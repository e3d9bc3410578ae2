// SPDX-License-Identifier: BSD-3-Clause
#include "DysegTrainer.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Printable.h>
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
    throw UserError(file + formatted(": trained with [grid] %s = %g, not %g; set it to %g, or %s",
                                     key, of_weights, given, of_weights, otherwise));
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

/** Checks the settings and sets the number of torch's threads. \return device of the network
 * \throws UserError. */
torch::Device checkedDevice(const DysegTrainerSetup& setup)
{
  validate(setup.train, "train");
  checkDysegValidation(setup.train);
  useTorchThreads(setup.train.threads);
  return deviceNamed(setup.device, "--device");
}

/** The weights of a file, for validation. \throws UserError. */
DysegModel modelOf(const std::string& weights, int threads, const torch::Device& device)
{
  return DysegModel(weights, threads, device.is_cuda() ? "cuda" : "cpu");
}

/** Rows "set,scores" of a validation. */
std::vector<std::string> scoreRows(const DysegModel& model,
                                   const std::vector<DysegValidationSet>& validation)
{
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
}  // namespace

struct DysegTrainer::Impl : TrainingTask
{
  /** Checks the settings and makes the network with random weights. \throws UserError. */
  Impl(const DysegTrainerSetup& setup, std::string folder);
  /** Takes the weights of a file. \throws UserError if they do not fit. */
  void loadWeights(const std::string& weights);
  /** Goes on from the folder's checkpoint. \throws UserError if there is none or it does not fit.
   */
  void loadCheckpoint();
  /** Reads the data of training and validation. \throws UserError. */
  void loadData();

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
  return formatted("step %lld/%d  matching %.3f  flow %.3f  static %.3f  cell %.3f  point %.3f  ",
                   static_cast<long long>(loop->step()), options.steps, loss.matching, loss.flow,
                   loss.static_probability, loss.cell, loss.point) +
         loop->timing();
}

std::string DysegTrainer::Impl::logRow(const DysegLoss& loss) const
{
  return formatted("%lld,%.2f,%.6f,%.4f,%.4f,%.4f,%.4f,%.4f", static_cast<long long>(loop->step()),
                   loop->minutes(), loop->rate(), loss.matching, loss.flow, loss.static_probability,
                   loss.cell, loss.point);
}

void DysegTrainer::Impl::validate()
{
  loop->save();
  const std::string step = std::to_string(loop->step());
  report("validation at step " + step + ": " + dyseg_score_names);
  std::vector<std::string> rows;
  const DysegModel model = modelOf(loop->file(weights_file), options.threads, device);
  if (validation.empty())
  {
    validation = makeDysegValidation(options);  // of a training that was resumed at its last step
  }
  for (const std::string& row : scoreRows(model, validation))
  {
    rows.push_back(step + "," + row);
    report("  " + row);
  }
  appendRows(loop->file("validation.csv"), rows);
}

DysegTrainer::Impl::Impl(const DysegTrainerSetup& setup, std::string folder)
    : options(setup.train),
      augmentation(setup.augmentation),
      loss_options(setup.loss),
      grid(setup.grid),
      crop(setup.grid),
      device(checkedDevice(setup))
{
  crop.cells = std::min(options.crop, grid.cells);
  torch::manual_seed(static_cast<std::uint64_t>(options.seed));
  batch.fill(std::vector<PreparedPair>(static_cast<std::size_t>(options.batch)));
  losses.resize(static_cast<std::size_t>(options.batch));
  net = DysegNet(setup.network);
  mean = DysegNet(setup.network);
  net->to(device);
  mean->to(device);
  copyWeights(*mean, *net, "");

  TrainingLoopSetup loop_setup;
  loop_setup.folder = std::move(folder);
  loop_setup.weights_file = weights_file;
  loop_setup.log_file = log_file;
  loop_setup.log_header = "step,minutes,rate,matching,flow,static_probability,cell,point";
  loop_setup.validation_header = std::string("step,") + dyseg_score_names;
  loop_setup.steps = options.steps;
  loop_setup.batch = options.batch;
  loop_setup.threads = options.threads;
  loop_setup.rate = options.rate;
  loop_setup.ema_decay = options.ema_decay;
  loop_setup.clip = clip_norm;
  loop_setup.validate_every = options.validate_every;
  loop_setup.checkpoint_every = options.checkpoint_every;
  loop_setup.checkpoint_has_minutes = true;
  loop_setup.network_prefix = "net.";
  loop_setup.network = net.ptr();
  loop_setup.mean = mean.ptr();
  loop_setup.optimizer = std::make_shared<torch::optim::AdamW>(
      net->parameters(),
      torch::optim::AdamWOptions(options.rate.learning_rate).weight_decay(options.weight_decay));
  loop = std::make_unique<TrainingLoop>(std::move(loop_setup), *this);
}

void DysegTrainer::Impl::loadWeights(const std::string& weights)
{
  const auto loaded = loadDyseg(weights);
  requireSameGrid(loaded.grid, grid, weights);
  for (auto* own : {&net, &mean})
  {
    copyWeights(**own, *loaded.net, weights);
  }
}

void DysegTrainer::Impl::loadCheckpoint()
{
  loop->resume();
  loop->requireNotBeyondEnd();
  // The checkpoint does not have the grid; the weights that were saved with it do.
  const std::string weights = loop->file(weights_file);
  if (std::filesystem::exists(weights))
  {
    requireSameGrid(loadDyseg(weights).grid, grid, weights);
  }
}

void DysegTrainer::Impl::loadData()
{
  if (options.validate_every > 0 && loop->step() < options.steps)
  {
    // Missing data are reported now, not after hours.
    validation = makeDysegValidation(options);
  }
  pairs = std::make_unique<DysegPairs>(options);
}

DysegTrainer DysegTrainer::begin(const DysegTrainerSetup& setup,
                                 std::string folder,
                                 const std::string& weights)
{
  auto impl = std::make_unique<Impl>(setup, std::move(folder));
  impl->loop->requireFreshFolder();
  if (!weights.empty())
  {
    impl->loadWeights(weights);
  }
  impl->loadData();
  return DysegTrainer(std::move(impl));
}

DysegTrainer DysegTrainer::resume(const DysegTrainerSetup& setup, std::string folder)
{
  auto impl = std::make_unique<Impl>(setup, std::move(folder));
  impl->loadCheckpoint();
  impl->loadData();
  return DysegTrainer(std::move(impl));
}

DysegTrainer::DysegTrainer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

DysegTrainer::~DysegTrainer() = default;

void DysegTrainer::run(const std::function<void(const std::string&)>& report,
                       const std::function<bool()>& stopped)
{
  Impl& t = *impl_;
  report("data: " + t.pairs->summary());
  t.report = report;
  if (t.loop->run(report, stopped) && t.options.validate_every > 0)
  {
    t.loop->validate();
  }
}

void validateDyseg(const DysegTrainerSetup& setup,
                   const std::string& folder,
                   const std::string& weights,
                   const GivenDysegShape& given,
                   const std::function<void(const std::string&)>& report)
{
  const torch::Device device = checkedDevice(setup);
  report(std::string("validation: ") + dyseg_score_names);
  const std::string file = weights.empty() ? folder + "/" + weights_file : weights;
  // The file is read first: if it is missing, the user need not wait for the validation data.
  const DysegModel model = modelOf(file, setup.train.threads, device);
  if (given.grid)
  {
    requireGridOfValidation(model.grid(), *given.grid, file);
  }
  if (given.network)
  {
    requireSameNetwork(loadDyseg(file).net->options(), *given.network, file, "leave it out");
  }
  for (const std::string& row : scoreRows(model, makeDysegValidation(setup.train)))
  {
    report("  " + row);
  }
}

void trainDyseg(const Config& config, const TrainRequest& request)
{
  DysegTrainerSetup setup;
  const Config effective = setup.load(config);
  setup.device = request.device;
  setup.train.data = dataFolder(setup.train.data, "[train] data");
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
    validateDyseg(setup, request.output, request.start, given, request.report);
    return;
  }
  // Complete before anything is written: settings that fail leave the folder as it is.
  DysegTrainer trainer = request.resume ? DysegTrainer::resume(setup, request.output)
                                        : DysegTrainer::begin(setup, request.output, request.start);
  writeSettings(effective, request);
  trainer.run(request.report, request.stopped);
}
}  // namespace dyslam
