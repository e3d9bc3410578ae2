// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/core/Files.h>
#include <dyslam/core/Parallel.h>
#include <dyslam/nets/Devices.h>
#include <dyslam/nets/DysegFile.h>
#include <dyslam/nets/DysegModel.h>
#include <dyslam/nets/TensorFile.h>
#include <dyslam/nets/Threads.h>
#include <dyslam/train/DataText.h>
#include <dyslam/train/DysegLosses.h>
#include <dyslam/train/DysegScores.h>
#include <dyslam/train/DysegTrainer.h>
#include <dyslam/train/NetworkWeights.h>
#include <dyslam/train/PairGradients.h>
#include <torch/torch.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "DysegCrop.h"
#include "DysegPairs.h"
#include "DysegValidation.h"

namespace dyslam
{
namespace
{
namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr double clip_norm = 2;
constexpr int report_every = 20;  // steps

constexpr const char* checkpoint_file = "checkpoint.safetensors";  // in the folder of output
constexpr const char* before_decay_file = "checkpoint_before_decay.safetensors";
constexpr const char* weights_file = "dyseg.safetensors";
constexpr const char* score_names =
    "set,iou,precision,recall,epe_static_m,epe_moving_m,own_motion_m,own_motion_rad";

/** A pair of a step, with the random numbers that its loss draws. */
struct PreparedPair
{
  DysegSample sample;
  Eigen::Vector2f centre = Eigen::Vector2f::Zero();
  RandomDraws draws{0, 0};
};

/** Adds the terms of a loss, each divided by `divisor`; not its total. */
void addTerms(const DysegLoss& loss, int divisor, DysegLoss& sum)
{
  sum.matching += loss.matching / divisor;
  sum.flow += loss.flow / divisor;
  sum.static_probability += loss.static_probability / divisor;
  sum.cell += loss.cell / divisor;
  sum.point += loss.point / divisor;
}

/** The network's inputs are computed on the grid; only its extent may differ.
 * \throws UserError naming the file, the key and both values. */
void requireSameGrid(const BevOptions& of_weights, const BevOptions& grid, const std::string& file)
{
  const struct
  {
    const char* key;
    double of_weights;
    double given;
  } fields[] = {{"cell_size", of_weights.cell_size, grid.cell_size},
                {"ground_clearance", of_weights.ground_clearance, grid.ground_clearance},
                {"max_height", of_weights.max_height, grid.max_height}};
  for (const auto& field : fields)
  {
    if (field.of_weights != field.given)
    {
      char values[160];
      std::snprintf(values, sizeof(values),
                    ": trained with [grid] %s = %g, not %g; set it to %g, or train from scratch",
                    field.key, field.of_weights, field.given, field.of_weights);
      throw UserError(file + values);
    }
  }
}
}  // namespace

struct DysegTrainer::Impl
{
  DysegTrainerOptions options;
  DysegAugmentOptions augmentation;
  DysegLossOptions loss_options;
  BevOptions grid;
  BevOptions crop;
  std::string folder;
  DysegNet net{nullptr};
  DysegNet mean{nullptr};  //!< exponential moving average of the weights
  torch::Device device = torch::kCPU;
  std::unique_ptr<torch::optim::AdamW> optimizer;
  int step = 0;
  int first_step = 0;  //!< of this run of the program
  int saved_step = -1;
  int validated_step = -1;
  double minutes_before = 0;
  Clock::time_point start = Clock::now();

  std::unique_ptr<DysegPairs> pairs;
  std::unique_ptr<ThreadPool> pool;
  std::vector<DysegNet> copies;  //!< of the network, one per thread
  std::unique_ptr<PairGradients> gradients;
  std::vector<PreparedPair> prepared;  //!< the pairs of this step
  std::vector<DysegValidationSet> validation;

  [[nodiscard]] double minutes() const
  {
    return minutes_before + std::chrono::duration<double>(Clock::now() - start).count() / 60;
  }
  [[nodiscard]] std::string file(const char* name) const { return folder + "/" + name; }
  /** Makes the threads, their copies of the network, and the pairs of the first step. */
  void begin();
  [[nodiscard]] PreparedPair preparePair(int of_step, std::size_t number) const;
  /** Loss of a pair; adds to the gradients of `network`. */
  DysegLoss backward(DysegNet& network, PreparedPair& pair) const;
  DysegLoss trainStep();
  /** One line for the user. \param sum of the losses of the last `counted` steps. */
  [[nodiscard]] std::string progress(const DysegLoss& sum, int counted) const;
  /** The same as a row of train.csv. */
  [[nodiscard]] std::string logRow(const DysegLoss& sum, int counted) const;
  void save();
  void writeCheckpoint(const std::string& path);
  /** Saves and evaluates the weights, and appends the scores to validation.csv; once per step. */
  void validateNow(const std::function<void(const std::string&)>& report);
  /** Rows "set,scores" of the weights in a file. */
  std::vector<std::string> evaluate(const std::string& weights);
};

PreparedPair DysegTrainer::Impl::preparePair(int of_step, std::size_t number) const
{
  PreparedPair pair;
  pair.draws =
      RandomDraws(static_cast<std::uint64_t>(options.seed),
                  static_cast<std::uint64_t>(of_step) * DysegTrainerOptions::max_batch + number);
  pair.sample = pairs->draw(pair.draws);
  augment(augmentation, pair.draws, pair.sample);
  pair.centre = drawCentre(pair.sample, grid, crop, options.crop_reach, pair.draws);
  return pair;
}

void DysegTrainer::Impl::begin()
{
  pool = std::make_unique<ThreadPool>(options.threads);
  copies.clear();
  std::vector<std::vector<torch::Tensor>> of_copies;
  for (int i = 0; i < pool->size(); ++i)
  {
    copies.emplace_back(net->options());
    copies.back()->to(device);
    of_copies.push_back(copies.back()->parameters());
  }
  gradients = std::make_unique<PairGradients>(net->parameters(), std::move(of_copies));
  pairs->prepare(step);
  prepared.resize(static_cast<std::size_t>(options.batch));
  pool->forChunks(prepared.size(), 1,
                  [&](std::size_t b, std::size_t, std::size_t)
                  { prepared[b] = preparePair(step, b); });
}

DysegLoss DysegTrainer::Impl::backward(DysegNet& network, PreparedPair& pair) const
{
  useTorchThreads(1);  // of this thread
  DysegLoss loss = dysegLoss(network, pair.sample, crop, pair.centre, loss_options, pair.draws);
  if (!loss.total.defined() || !loss.total.requires_grad() ||
      !std::isfinite(loss.total.item<double>()))
  {
    return {};
  }
  (loss.total / options.batch).backward();
  loss.total = loss.total.detach();
  return loss;
}

DysegLoss DysegTrainer::Impl::trainStep()
{
  const std::size_t batch = prepared.size();
  std::vector<DysegLoss> losses(batch);
  std::vector<PreparedPair> next(batch);
  pairs->prepare(step + 1);
  gradients->computeStep(
      *pool, batch,
      [&](std::size_t i, std::size_t copy) { losses[i] = backward(copies[copy], prepared[i]); },
      [&](std::size_t i) { next[i] = preparePair(step + 1, i); });
  prepared = std::move(next);
  DysegLoss mean_loss;
  bool has_loss = false;
  for (const DysegLoss& loss : losses)
  {
    has_loss = has_loss || loss.total.defined();
    addTerms(loss, options.batch, mean_loss);
  }
  if (!has_loss)
  {
    // Crops with too few points: no step, else momentum alone would change the weights.
    return mean_loss;
  }
  static_cast<torch::optim::AdamWOptions&>(optimizer->param_groups()[0].options())
      .lr(options.rate.rateAt(step, options.steps));
  if (std::isfinite(clippedStep(*optimizer, clip_norm)))
  {
    updateMean(*mean, *net, step, options.ema_decay);
  }
  return mean_loss;
}

std::string DysegTrainer::Impl::progress(const DysegLoss& sum, int counted) const
{
  const double minutes_now = std::chrono::duration<double>(Clock::now() - start).count() / 60;
  const double per_step = minutes_now / std::max(1, step - first_step);
  char line[240];
  std::snprintf(line, sizeof(line),
                "step %d/%d  matching %.3f  flow %.3f  static %.3f  cell %.3f  point %.3f  "
                "%.0f ms/pair  %.0f min left",
                step, options.steps, sum.matching / counted, sum.flow / counted,
                sum.static_probability / counted, sum.cell / counted, sum.point / counted,
                60e3 * per_step / options.batch, per_step * (options.steps - step));
  return line;
}

std::string DysegTrainer::Impl::logRow(const DysegLoss& sum, int counted) const
{
  char row[200];
  std::snprintf(row, sizeof(row), "%d,%.2f,%.6f,%.4f,%.4f,%.4f,%.4f,%.4f", step, minutes(),
                options.rate.rateAt(step - 1, options.steps), sum.matching / counted,
                sum.flow / counted, sum.static_probability / counted, sum.cell / counted,
                sum.point / counted);
  return row;
}

void DysegTrainer::Impl::save()
{
  if (saved_step == step)
  {
    return;
  }
  makeFolder(folder);
  saveDyseg({mean, grid}, file(weights_file));
  writeCheckpoint(file(checkpoint_file));
  saved_step = step;
}

void DysegTrainer::Impl::writeCheckpoint(const std::string& path)
{
  TensorFile checkpoint;
  checkpoint.setWeights("net.", *net);
  checkpoint.setWeights("mean.", *mean);
  setOptimizerState(checkpoint, *optimizer);
  checkpoint.set("step", torch::tensor(static_cast<std::int64_t>(step), torch::kInt64));
  checkpoint.set("minutes", torch::tensor(minutes(), torch::kFloat64));
  checkpoint.write(path);
}

std::vector<std::string> DysegTrainer::Impl::evaluate(const std::string& weights)
{
  // First the file: without it, the user need not wait for the validation data.
  const DysegModel model(weights, options.threads, device.is_cuda() ? "cuda" : "cpu");
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
    char scores[200];
    std::snprintf(scores, sizeof(scores), ",%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.5f", s.iou(),
                  s.precision(), s.recall(),
                  s.static_error / std::max<double>(1, static_cast<double>(s.static_cells)),
                  s.moving_error / std::max<double>(1, static_cast<double>(s.moving_cells)),
                  s.translation_error / static_cast<double>(s.pairs),
                  s.yaw_error / static_cast<double>(s.pairs));
    rows.push_back(set.name + scores);
  }
  return rows;
}

void DysegTrainer::Impl::validateNow(const std::function<void(const std::string&)>& report)
{
  if (validated_step == step)
  {
    return;
  }
  validated_step = step;
  save();
  report("validation at step " + std::to_string(step) + ": " + score_names);
  std::vector<std::string> rows;
  for (const std::string& row : evaluate(file(weights_file)))
  {
    rows.push_back(std::to_string(step) + "," + row);
    report("  " + row);
  }
  appendRows(file("validation.csv"), rows);
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
  impl_->folder = std::move(folder);
  torch::manual_seed(static_cast<std::uint64_t>(options.seed));
  impl_->device = deviceNamed(setup.device, "--device");
  impl_->net = DysegNet(network);
  impl_->mean = DysegNet(network);
  impl_->net->to(impl_->device);
  impl_->mean->to(impl_->device);
  copyWeights(*impl_->mean, *impl_->net, "");
  impl_->optimizer = std::make_unique<torch::optim::AdamW>(
      impl_->net->parameters(),
      torch::optim::AdamWOptions(options.rate.learning_rate).weight_decay(options.weight_decay));
}

DysegTrainer::~DysegTrainer() = default;

void DysegTrainer::requireFreshFolder() const
{
  if (fs::exists(impl_->file(checkpoint_file)))
  {
    throw UserError(impl_->file(checkpoint_file) +
                    ": is there already; add --resume or choose another folder");
  }
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
  const auto path = impl_->file(checkpoint_file);
  if (!fs::exists(path))
  {
    throw UserError(path + ": no such file; there is no training in this folder to continue");
  }
  const TensorFile checkpoint(path);
  checkpoint.loadWeights("net.", *impl_->net);
  checkpoint.loadWeights("mean.", *impl_->mean);
  loadOptimizerState(checkpoint, *impl_->optimizer);
  impl_->step = static_cast<int>(checkpoint.tensor("step").item<std::int64_t>());
  impl_->minutes_before = checkpoint.tensor("minutes").item<double>();
}

void DysegTrainer::validateOnly(const std::string& weights,
                                const std::function<void(const std::string&)>& report)
{
  report(std::string("validation: ") + score_names);
  for (const std::string& row :
       impl_->evaluate(weights.empty() ? impl_->file(weights_file) : weights))
  {
    report("  " + row);
  }
}

void DysegTrainer::run(const std::function<void(const std::string&)>& report,
                       const std::function<bool()>& stopped)
{
  Impl& t = *impl_;
  if (t.options.validate_every > 0)
  {
    // Missing data are reported now, not after hours.
    t.validation = makeDysegValidation(t.options);
  }
  t.pairs = std::make_unique<DysegPairs>(t.options);
  report("data: " + t.pairs->summary());
  t.start = Clock::now();
  t.first_step = t.step;
  t.begin();
  makeFolder(t.folder, "choose another --output");
  beginLog(t.file("train.csv"), "step,minutes,rate,matching,flow,static_probability,cell,point",
           t.step);
  t.validated_step = static_cast<int>(
      beginLog(t.file("validation.csv"), std::string("step,") + score_names, t.step));
  DysegLoss sum;
  int counted = 0;
  while (t.step < t.options.steps)
  {
    if (stopped && stopped())
    {
      t.save();
      report("stopped at step " + std::to_string(t.step) + "; --resume continues from here");
      return;
    }
    addTerms(t.trainStep(), 1, sum);
    ++counted;
    ++t.step;
    if (t.step % report_every == 0)
    {
      appendRows(t.file("train.csv"), {t.logRow(sum, counted)});
      report(t.progress(sum, counted));
      sum = DysegLoss();
      counted = 0;
    }
    if (t.step % t.options.checkpoint_every == 0)
    {
      t.save();
    }
    if (t.step == t.options.rate.firstOfDecay(t.options.steps))
    {
      t.writeCheckpoint(t.file(before_decay_file));
    }
    if (t.options.validate_every > 0 && t.step % t.options.validate_every == 0)
    {
      t.validateNow(report);
    }
  }
  t.save();
  if (t.options.validate_every > 0)
  {
    t.validateNow(report);
  }
}
}  // namespace dyslam
