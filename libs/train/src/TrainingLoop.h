// SPDX-License-Identifier: BSD-3-Clause
// Includes torch.
#pragma once

#include <dyslam/base/Parallel.h>
#include <dyslam/nets/TensorFile.h>
#include <dyslam/train/LearningRate.h>
#include <dyslam/train/PairGradients.h>
#include <torch/torch.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace dyslam
{
/** The parts of a training that depend on the network: pairs, losses, log and validation. */
class TrainingTask
{
 public:
  virtual ~TrainingTask() = default;
  /** Makes one more copy of the trained modules. \return its parameters, in the optimizer's order
   */
  virtual std::vector<torch::Tensor> addCopy() = 0;
  /** Called before the pairs of `step` are prepared: during the previous step, or at the start of
   * the training. */
  virtual void beginPairs(std::int64_t /*step*/) {}
  /** Prepares a pair, by its index in the batch. Threads call it at the same time, also while the
   * pairs of the previous step are trained on. */
  virtual void preparePair(std::int64_t step, std::size_t pair) = 0;
  /** Adds the gradients of a pair of this step to the gradients of a copy. Threads call it at the
   * same time. */
  virtual void backward(std::int64_t step, std::size_t pair, std::size_t copy) = 0;
  /** Called after each step. \param gradient norm of all gradients, before it is limited. */
  virtual void log(double gradient) = 0;
  /** Evaluates the mean of the weights and logs the scores. */
  virtual void validate() = 0;
  /** Writes the mean of the weights as a model. */
  virtual void saveWeights() = 0;
};

struct TrainingLoopSetup
{
  std::string folder;        //!< folder of the results
  std::string weights_file;  //!< name of the model in `folder`
  std::string log_file;      //!< name of the log in `folder`
  std::string log_header, validation_header;
  std::int64_t steps = 0;
  int batch = 1;    //!< pairs in a step
  int threads = 1;  //!< pairs computed at a time
  LearningRateOptions rate;
  double ema_decay = 0;                 //!< decay of the exponential moving average of the weights
  double clip = 0;                      //!< largest norm of the gradients
  int validate_every = 0;               //!< steps between validations; 0: none
  int checkpoint_every = 0;             //!< steps between checkpoints; 0: by time
  double checkpoint_minutes = 0;        //!< time between checkpoints [min]
  bool checkpoint_has_minutes = false;  //!< checkpoints contain the time trained so far
  std::string network_prefix;           //!< prefix of the network's weights in a checkpoint
  std::shared_ptr<torch::nn::Module> network;
  std::shared_ptr<torch::nn::Module> mean;  //!< exponential moving average of the network's weights
  std::shared_ptr<torch::nn::Module> loss;  //!< loss with trained parameters; null if it has none
  std::shared_ptr<torch::optim::Optimizer> optimizer;  //!< has one group of parameters
};

/** The steps of a training, with its learning rate, checkpoints and validations.
 *
 * A training that was stopped and resumed gives the same weights; so does any number of threads. A
 * step whose gradients are not finite changes neither the weights nor their mean.
 */
class TrainingLoop
{
 public:
  /** \param task outlives the loop. */
  TrainingLoop(TrainingLoopSetup setup, TrainingTask& task);

  /** Makes sure that no training is overwritten. \throws UserError if the folder holds a checkpoint
   * or a model. */
  void requireFreshFolder() const;
  /** Resumes from the folder's checkpoint. \throws UserError if there is none or it does not fit.
   */
  void resume();
  /** \throws UserError if the checkpoint that was resumed is of more steps than the training has.
   */
  void requireNotBeyondEnd() const;
  /** Loads the weights of a checkpoint, without the optimizer's state and the step. \throws
   * UserError. */
  void loadWeights(const TensorFile& checkpoint);
  /** Trains to the last step and saves; called once.
   * \param stopped is polled before each step: true saves and ends; null for never.
   * \return false if it was stopped. \throws UserError. */
  bool run(const std::function<void(const std::string&)>& report,
           const std::function<bool()>& stopped);
  /** Saves weights and checkpoint; once per step. */
  void save();
  /** Validates once per step, also over runs of the program. */
  void validate();

  /** Number of steps done. */
  [[nodiscard]] std::int64_t step() const { return step_; }
  /** Learning rate of the last step. */
  [[nodiscard]] double rate() const;
  /** Time trained, in all runs of the program [min]. */
  [[nodiscard]] double minutes() const;
  /** Text for the user: time per pair and time left. */
  [[nodiscard]] std::string timing() const;
  [[nodiscard]] std::string file(const std::string& name) const
  {
    return setup_.folder + "/" + name;
  }

 private:
  using Clock = std::chrono::steady_clock;

  /** Makes the threads, their copies of the network, and the pairs of the first step. */
  void begin();
  /** \return norm of the gradients before it is limited. */
  double trainStep();
  [[nodiscard]] bool checkpointDue() const;
  void writeCheckpoint(const std::string& path) const;

  TrainingLoopSetup setup_;
  TrainingTask& task_;
  std::vector<torch::Tensor> parameters_;
  std::unique_ptr<ThreadPool> pool_;
  std::unique_ptr<PairGradients> gradients_;
  std::int64_t step_ = 0;
  std::int64_t first_step_ = 0;  //!< first step of this run of the program
  std::int64_t saved_step_ = -1;
  std::int64_t validated_step_ = -1;
  double minutes_before_ = 0;
  Clock::time_point start_ = Clock::now();
  Clock::time_point saved_ = start_;
};
}  // namespace dyslam
