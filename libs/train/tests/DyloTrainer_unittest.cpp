// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/PendingFile.h>
#include <dyslam/nets/DyloFile.h>
#include <dyslam/train/DataText.h>
#include <dyslam/train/TrainDylo.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "DyloValidation.h"

namespace dyslam
{
namespace
{
/** A training of a tiny network on simulated pairs, at a constant learning rate, so that the number
 * of steps changes nothing else. */
Config tiny(int steps)
{
  return Config::fromText(
      "[train]\nbatch = 1\nlearning_rate = 0.001\nwarmup_steps = 1\ndecay_start = 1\nsteps = " +
          std::to_string(steps) +
          "\n[network]\nwidth = 0.125\n[data]\nbase = .\nsimulator_weight = 1\nmax_gap = 1\n",
      "test");
}

std::string freshFolder(const std::string& name)
{
  const std::string folder = testing::TempDir() + "dylo_trainer_" + name;
  std::filesystem::remove_all(folder);
  return folder;
}

DyloTrainRequest requestFor(const std::string& folder)
{
  DyloTrainRequest request;
  request.output = folder;
  request.report = [](const std::string&) {};
  return request;
}

TEST(DyloValidation, StatisticsOfTheErrorsOfMotions)
{
  const Pose quarter_turn = poseFromYpr(0, 0, 0, M_PI / 2, 0, 0);
  std::vector<Pose> truths(4, Pose::Identity());
  std::vector<Pose> estimates(4, Pose::Identity());
  for (std::size_t i = 0; i < truths.size(); ++i)
  {
    truths[i].translation().x() = 10;
    const double forward = i == 3 ? 17 : 10 + static_cast<double>(i);
    estimates[i].translation().x() = forward;  // errors 0, 1, 2, 7
  }
  estimates[1].linear() = quarter_turn.linear();
  const MotionErrors errors = motionErrors(estimates, truths);
  EXPECT_DOUBLE_EQ(2.5, errors.translation.mean);
  EXPECT_DOUBLE_EQ(1.5, errors.translation.median);
  EXPECT_DOUBLE_EQ(0, errors.translation.min);
  EXPECT_DOUBLE_EQ(7, errors.translation.max);
  EXPECT_DOUBLE_EQ(std::sqrt(54.0 / 4), errors.translation.rmse);
  EXPECT_NEAR(90.0 / 4, errors.rotation_deg.mean, 1e-9);
  EXPECT_NEAR(45, errors.rotation_deg.rmse, 1e-9);
  EXPECT_DOUBLE_EQ(1.25, errors.forward_ratio);

  estimates[0].translation().y() = std::nan("");  // of a network that diverged
  EXPECT_TRUE(std::isnan(motionErrors(estimates, truths).translation.median));
  EXPECT_EQ(0U, motionErrors({}, {}).translation.count);
}

TEST(DyloTrainer, AStoppedTrainingGoesOnExactly)
{
  const std::string whole = freshFolder("whole");
  const std::string parts = freshFolder("parts");
  DyloTrainRequest request = requestFor(whole);
  trainDylo(tiny(4), request);
  request.output = parts;
  trainDylo(tiny(2), request);
  const DyloNetwork halfway = loadDylo(parts + "/dylo.safetensors");
  request.resume = true;
  trainDylo(tiny(4), request);
  const auto expected = loadDylo(whole + "/dylo.safetensors")->named_parameters();
  const auto resumed = loadDylo(parts + "/dylo.safetensors")->named_parameters();
  bool learned = false;
  for (const auto& parameter : expected)
  {
    EXPECT_TRUE(torch::equal(parameter.value(), resumed[parameter.key()])) << parameter.key();
    learned =
        learned || !torch::equal(parameter.value(), halfway->named_parameters()[parameter.key()]);
  }
  EXPECT_TRUE(learned);
}

TEST(DyloTrainer, AnyNumberOfThreadsGivesTheSameWeights)
{
  const auto train = [](int threads)
  {
    Config config = tiny(2);
    config.set("train.batch=3");
    config.set("train.threads=" + std::to_string(threads));
    const std::string folder = freshFolder("threads_" + std::to_string(threads));
    trainDylo(config, requestFor(folder));
    return readWhole(folder + "/dylo.safetensors");
  };
  EXPECT_EQ(train(1), train(4));
}

/** With a learning rate near 0, pairs have the same losses in two steps as in one step of twice the
 * batch. */
TEST(DyloTrainer, LogsTheMeanOfABatch)
{
  const auto losses = [](int batch, int steps)
  {
    Config config = tiny(steps);
    config.set("train.batch=" + std::to_string(batch));
    config.set("train.learning_rate=0.0000000000001");
    config.set("train.report_every=1");
    const std::string folder = freshFolder("batch_of_" + std::to_string(batch));
    trainDylo(config, requestFor(folder));
    std::vector<double> column;
    const std::vector<std::string> rows = listItems(readWhole(folder + "/log.csv"), '\n');
    for (std::size_t i = 1; i < rows.size(); ++i)
    {
      column.push_back(numberOf(splitFields(rows[i], ',').at(2)));
    }
    return column;
  };
  const std::vector<double> single = losses(1, 2);
  ASSERT_EQ(single.size(), 2U);
  EXPECT_NE(single[0], single[1]);
  const std::vector<double> both = losses(2, 1);
  ASSERT_EQ(both.size(), 1U);
  const double mean = 0.5 * (single[0] + single[1]);
  EXPECT_NEAR(both[0], mean, 1e-3 * std::abs(mean));
}

TEST(DyloTrainer, StartsFromTheLayersThatAModelShares)
{
  const std::string given = freshFolder("given");
  trainDylo(tiny(1), requestFor(given));
  DyloTrainRequest request = requestFor(freshFolder("other_head"));
  request.start = given + "/dylo.safetensors";
  std::string said;
  request.report = [&said](const std::string& line) { said += line + "\n"; };
  Config config = tiny(1);
  config.set("network.head=regression");
  config.set("train.learning_rate=0.0000000000001");
  trainDylo(config, request);
  EXPECT_NE(said.find("started from"), std::string::npos) << said;
  const auto before = loadDylo(request.start)->named_parameters();
  const auto after = loadDylo(request.output + "/dylo.safetensors")->named_parameters();
  std::size_t shared = 0;
  for (const auto& parameter : after)
  {
    const torch::Tensor* source = before.find(parameter.key());
    if (source != nullptr && source->sizes() == parameter.value().sizes())
    {
      ++shared;
      EXPECT_TRUE(torch::allclose(parameter.value(), *source, 1e-5, 1e-6)) << parameter.key();
    }
  }
  EXPECT_GT(shared, 50U);
  EXPECT_LT(shared, after.size()) << "the head is its own";
}

/** As tiny(), with learning rate decay after half of the steps. */
Config decaying(int steps)
{
  Config config = tiny(steps);
  config.set("train.decay_start=0.5");
  return config;
}

TEST(DyloTrainer, IsLengthenedFromTheCheckpointBeforeTheDecay)
{
  const std::string whole = freshFolder("long");
  trainDylo(decaying(4), requestFor(whole));
  const std::string shorter = freshFolder("short");
  trainDylo(decaying(2), requestFor(shorter));
  const std::string lengthened = freshFolder("lengthened");
  std::filesystem::create_directories(lengthened);
  std::filesystem::copy_file(shorter + "/checkpoint_before_decay.safetensors",
                             lengthened + "/checkpoint.safetensors");
  DyloTrainRequest request = requestFor(lengthened);
  request.resume = true;
  trainDylo(decaying(4), request);
  const auto expected = loadDylo(whole + "/dylo.safetensors")->named_parameters();
  for (const auto& parameter : loadDylo(lengthened + "/dylo.safetensors")->named_parameters())
  {
    EXPECT_TRUE(torch::equal(parameter.value(), expected[parameter.key()])) << parameter.key();
  }
}

TEST(DyloTrainer, WritesTheRunningMeanOfTheWeights)
{
  Config last = tiny(2);
  last.set("train.ema_decay=0");
  const std::string without = freshFolder("without_mean");
  trainDylo(last, requestFor(without));
  const std::string with = freshFolder("with_mean");
  trainDylo(tiny(2), requestFor(with));
  const auto a = loadDylo(without + "/dylo.safetensors")->named_parameters();
  bool differ = false;
  for (const auto& mean : loadDylo(with + "/dylo.safetensors")->named_parameters())
  {
    differ = differ || !torch::equal(mean.value(), a[mean.key()]);
  }
  EXPECT_TRUE(differ);
}

TEST(DyloTrainer, DoesNotOverwriteATraining)
{
  const std::string folder = freshFolder("kept");
  DyloTrainRequest request = requestFor(folder);
  trainDylo(tiny(1), request);
  EXPECT_THROW(trainDylo(tiny(1), request), UserError);
  request.resume = true;
  Config wider = tiny(2);
  wider.set("network.width=0.25");
  EXPECT_THROW(trainDylo(wider, request), UserError) << "the checkpoint is of another shape";
  request.output = freshFolder("none");
  EXPECT_THROW(trainDylo(tiny(1), request), UserError);
}

TEST(DyloTrainer, MissingDataLeaveTheFolderAsItIs)
{
  Config config = tiny(1);
  config.set("data.recordings_weight=1");
  config.set("data.recordings=nowhere/velodyne;nowhere/poses.txt;0;9");
  DyloTrainRequest request = requestFor(freshFolder("missing_data"));
  EXPECT_THROW(trainDylo(config, request), UserError);
  EXPECT_FALSE(std::filesystem::exists(request.output));
  trainDylo(tiny(1), request);
  const std::string before = readWhole(request.output + "/effective.ini");
  request.resume = true;
  EXPECT_THROW(trainDylo(config, request), UserError);
  EXPECT_EQ(readWhole(request.output + "/effective.ini"), before);
}

TEST(DyloTrainer, ValidatesTheResult)
{
  Config config = tiny(2);
  config.set("data.simulated_validation=campus;VLP16;0;9004;2");
  DyloTrainRequest request = requestFor(freshFolder("validated"));
  trainDylo(config, request);
  const auto steps = [&]
  {
    std::vector<std::string> column;
    for (const std::string& row : listItems(readWhole(request.output + "/validation.csv"), '\n'))
    {
      column.push_back(splitFields(row, ',').front());
    }
    return column;
  };
  EXPECT_EQ(steps(), (std::vector<std::string>{"step", "2", "2"}));
  request.resume = true;
  trainDylo(config, request);
  EXPECT_EQ(steps().size(), 3U) << "once";
}

TEST(DyloTrainer, ValidationNeedsRecordings)
{
  DyloTrainRequest request = requestFor(freshFolder("not_validated"));
  trainDylo(tiny(1), request);
  request.validate_only = true;
  EXPECT_THROW(trainDylo(tiny(1), request), UserError);
}

TEST(DyloTrainer, ValidatesAModelOnlyWithItsOwnSettings)
{
  const std::string trained = freshFolder("model_to_validate");
  trainDylo(tiny(1), requestFor(trained));
  DyloTrainRequest request;
  request.start = trained + "/dylo.safetensors";
  request.validate_only = true;
  std::string said;
  request.report = [&said](const std::string& line) { said += line + "\n"; };
  Config config = tiny(1);
  config.set("data.simulated_validation=campus;VLP16;0;9004;2");
  trainDylo(config, request);
  EXPECT_NE(said.find("validation of " + request.start), std::string::npos) << said;
  request.start = trained + "/checkpoint.safetensors";
  trainDylo(config, request);
  config.set("network.mask=none");  // has a part of the layers
  EXPECT_THROW(trainDylo(config, request), UserError);
  request.start = trained + "/dylo.safetensors";
  config.set("network.mask=lonet");  // shares most layers; the mask's own would be random
  try
  {
    trainDylo(config, request);
    FAIL() << "a network with random layers is validated";
  }
  catch (const UserError& error)
  {
    EXPECT_NE(std::string(error.what()).find("mask = attention, not lonet"), std::string::npos)
        << error.what();
  }
}

TEST(DyloTrainer, AskedToStopItSavesWhatItHas)
{
  DyloTrainRequest request = requestFor(freshFolder("stopped"));
  int asked = 0;
  request.stopped = [&] { return ++asked > 1; };
  trainDylo(tiny(5), request);
  EXPECT_EQ(asked, 2);
  const std::string stopped = request.output;
  request = requestFor(freshFolder("one_step"));
  trainDylo(tiny(1), request);
  const auto expected = loadDylo(request.output + "/dylo.safetensors")->named_parameters();
  for (const auto& parameter : loadDylo(stopped + "/dylo.safetensors")->named_parameters())
  {
    EXPECT_TRUE(torch::equal(parameter.value(), expected[parameter.key()])) << parameter.key();
  }
}

TEST(Recordings, DescribedByATextOfFields)
{
  const RecordingDescription d = parseRecording(
      "run/velodyne; run/poses.txt ;3; 20;deskew;labels=run/labels; calib=run/calib.txt", "/data",
      "[data] recordings");
  EXPECT_EQ(d.folder, "/data/run/velodyne");
  EXPECT_EQ(d.pose_file, "/data/run/poses.txt");
  EXPECT_EQ(d.label_folder, "/data/run/labels");
  EXPECT_EQ(d.calib_file, "/data/run/calib.txt");
  EXPECT_EQ(d.first, 3U);
  EXPECT_EQ(d.last, 20U);
  EXPECT_TRUE(d.deskew);
  for (const char* wrong : {"run;poses;1", "run;poses;1;20x", "run;poses;-1;20", "run;poses;a;20",
                            "run;poses;1;20;unskew"})
  {
    EXPECT_THROW((void)parseRecording(wrong, "/data", "[data] recordings"), UserError) << wrong;
  }
}

TEST(Recordings, OneScanIsNone)
{
  const std::string folder = freshFolder("recordings") + "/drive/velodyne";
  std::filesystem::create_directories(folder);
  writeWhole(folder + "/0.bin", "");
  writeWhole(folder + "/1.bin", "");
  const std::string pose = "1 0 0 0 0 1 0 0 0 0 1 0\n";
  writeWhole(folder + "/poses.txt", pose + pose);
  RecordingDescription description;
  description.folder = folder;
  description.pose_file = folder + "/poses.txt";
  EXPECT_THROW((void)loadRecording(description, false), UserError);
  description.last = 1;
  EXPECT_EQ(loadRecording(description, false).scans.size(), 2U);
  EXPECT_EQ(loadRecording(description, false).name, "drive");
  description.folder += "/";
  EXPECT_EQ(loadRecording(description, false).name, "drive");
}

/** As in KITTI's drive 2011_09_26_0009, which has poses of scans that are missing. */
TEST(Recordings, PosesOfMissingScansAreNotThoseOfTheNext)
{
  const std::string folder = freshFolder("gap");
  std::filesystem::create_directories(folder);
  for (const char* scan : {"/08.bin", "/09.bin", "/11.bin"})
  {
    writeWhole(folder + scan, "");
  }
  const std::string pose = "1 0 0 0 0 1 0 0 0 0 1 0\n";
  RecordingDescription description;
  description.folder = folder;
  description.pose_file = folder + "/poses.txt";
  description.last = 2;
  writeWhole(description.pose_file, pose + pose + pose);
  EXPECT_EQ(loadRecording(description, false).scans.size(), 3U) << "a pose for each scan";
  writeWhole(description.pose_file, pose + pose + pose + pose);
  try
  {
    (void)loadRecording(description, false);
    FAIL() << "scan 11 gets the pose of scan 10";
  }
  catch (const UserError& error)
  {
    EXPECT_NE(std::string(error.what()).find("no scan with number 10"), std::string::npos)
        << error.what();
  }
  description.last = 1;
  EXPECT_EQ(loadRecording(description, false).scans.size(), 2U) << "before the gap";
}
}  // namespace
}  // namespace dyslam
