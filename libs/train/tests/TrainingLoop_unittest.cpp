// SPDX-License-Identifier: BSD-3-Clause
#include "TrainingLoop.h"

#include <dyslam/base/Error.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <limits>
#include <string>

namespace dyslam
{
namespace
{
/** Trains y = w x + b towards larger values, with gradients that are not numbers in one step. */
struct LineTask : TrainingTask
{
  torch::nn::Linear line{1, 1};
  torch::nn::Linear mean{1, 1};
  std::vector<torch::nn::Linear> copies;
  std::int64_t nan_step = -1;
  bool no_loss = false;
  std::vector<float> weights, means;  //!< after each step
  int validated = 0;
  int saved = 0;

  std::vector<torch::Tensor> addCopy() override
  {
    copies.emplace_back(1, 1);
    return copies.back()->parameters();
  }
  void preparePair(std::int64_t /*step*/, std::size_t /*pair*/) override {}
  void backward(std::int64_t step, std::size_t /*pair*/, std::size_t copy) override
  {
    if (no_loss)
    {
      return;
    }
    const float x = step == nan_step ? std::numeric_limits<float>::quiet_NaN() : 1;
    (-copies[copy](torch::full({1, 1}, x))).sum().backward();
  }
  void log(double /*gradient*/) override
  {
    weights.push_back(line->weight.item<float>());
    means.push_back(mean->weight.item<float>());
  }
  void validate() override { ++validated; }
  void saveWeights() override { ++saved; }
};

TrainingLoopSetup setupFor(const LineTask& task, const std::string& name, int steps)
{
  TrainingLoopSetup setup;
  setup.folder = testing::TempDir() + "training_loop_" + name;
  std::filesystem::remove_all(setup.folder);
  setup.weights_file = "line.safetensors";
  setup.log_file = "log.csv";
  setup.log_header = "step";
  setup.validation_header = "step";
  setup.steps = steps;
  setup.batch = 2;
  setup.ema_decay = 0.5;
  setup.clip = 1;
  setup.validate_every = 2;
  setup.checkpoint_every = 2;
  setup.network_prefix = "net.";
  setup.network = task.line.ptr();
  setup.mean = task.mean.ptr();
  setup.optimizer = std::make_shared<torch::optim::Adam>(task.line->parameters());
  return setup;
}

TEST(TrainingLoop, AStepWithGradientsThatAreNotFiniteChangesNeitherWeightsNorMean)
{
  LineTask task;
  task.nan_step = 1;
  TrainingLoop loop(setupFor(task, "nan", 3), task);
  EXPECT_TRUE(loop.run([](const std::string&) {}, nullptr));
  ASSERT_EQ(task.weights.size(), 3U);
  EXPECT_EQ(task.weights[1], task.weights[0]);
  EXPECT_EQ(task.means[1], task.means[0]);
  EXPECT_GT(task.weights[2], task.weights[1]);
  EXPECT_NE(task.means[2], task.means[1]);
}

TEST(TrainingLoop, AStepWithoutALossChangesNeitherWeightsNorMean)
{
  LineTask task;
  task.no_loss = true;
  const float weight = task.line->weight.item<float>();
  const float mean = task.mean->weight.item<float>();
  TrainingLoop loop(setupFor(task, "no_loss", 1), task);
  EXPECT_TRUE(loop.run([](const std::string&) {}, nullptr));
  EXPECT_EQ(task.weights.at(0), weight);
  EXPECT_EQ(task.means.at(0), mean);
}

TEST(TrainingLoop, ValidatesAndSavesAsOftenAsAsked)
{
  LineTask task;
  TrainingLoop loop(setupFor(task, "cadence", 5), task);
  EXPECT_TRUE(loop.run([](const std::string&) {}, nullptr));
  EXPECT_EQ(task.validated, 2);
  EXPECT_EQ(task.saved, 3) << "after steps 2, 4 and 5";
  loop.validate();
  loop.validate();
  loop.save();
  EXPECT_EQ(task.validated, 3);
  EXPECT_EQ(task.saved, 3) << "once per step";
}

TEST(TrainingLoop, ACheckpointOfMoreStepsIsRefused)
{
  LineTask task;
  TrainingLoopSetup setup = setupFor(task, "longer", 2);
  TrainingLoop(setup, task).run([](const std::string&) {}, nullptr);
  TrainingLoop same(setup, task);
  same.resume();
  EXPECT_NO_THROW(same.requireNotBeyondEnd());
  setup.steps = 1;
  TrainingLoop fewer(setup, task);
  fewer.resume();
  EXPECT_THROW(fewer.requireNotBeyondEnd(), UserError);
}

TEST(TrainingLoop, ACheckpointOrAModelIsNotOverwritten)
{
  for (const std::string name : {"checkpoint.safetensors", "line.safetensors"})
  {
    LineTask task;
    const TrainingLoopSetup setup = setupFor(task, "kept", 1);
    const TrainingLoop loop(setup, task);
    EXPECT_NO_THROW(loop.requireFreshFolder());
    std::filesystem::create_directories(setup.folder);
    std::ofstream(setup.folder + "/log.csv") << "step\n";
    EXPECT_NO_THROW(loop.requireFreshFolder());
    std::ofstream(setup.folder + "/" + name) << "x";
    EXPECT_THROW(loop.requireFreshFolder(), UserError) << name;
  }
}
}  // namespace
}  // namespace dyslam
