// SPDX-License-Identifier: BSD-3-Clause
#include "DysegTrainer.h"

#include <dyslam/base/Error.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "DysegValidation.h"

namespace
{
namespace fs = std::filesystem;
using dyslam::DysegTrainer;

std::string contentOf(const fs::path& path)
{
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

class DysegTraining : public ::testing::Test
{
 protected:
  DysegTraining()
      : folder_(fs::temp_directory_path() / ("dyslam_dyseg_" + std::to_string(::getpid())))
  {
    // Small simulated training: 16 beams on highways, which are simulated fastest, one clip at a
    // time.
    setup_.train.simulated_share = 1;
    setup_.train.few_beams_share = 1;
    setup_.train.campus_share = 0;
    setup_.train.highway_share = 1;
    setup_.train.simulated_pool = 1;
    setup_.train.simulate_every = 2;
    setup_.train.crop = 128;
    setup_.train.batch = 1;
    setup_.train.steps = 4;
    setup_.train.rate.decay_start = 1;  // the same learning rate for any number of steps
    setup_.train.validate_every = 0;
    setup_.augmentation.bodies = 2;
  }
  ~DysegTraining() override { fs::remove_all(folder_); }

  fs::path train(const std::string& name, int steps, bool resume = false)
  {
    auto setup = setup_;
    setup.train.steps = steps;
    const auto folder = folder_ / name;
    DysegTrainer trainer = resume ? DysegTrainer::resume(setup, folder.string())
                                  : DysegTrainer::begin(setup, folder.string());
    trainer.run([](const std::string&) {});
    return folder / "dyseg.safetensors";
  }

  void beginIn(const fs::path& folder, const std::string& weights = "") const
  {
    (void)DysegTrainer::begin(setup_, folder.string(), weights);
  }

  void resumeIn(const fs::path& folder) const
  {
    (void)DysegTrainer::resume(setup_, folder.string());
  }

  fs::path folder_;
  dyslam::DysegTrainerSetup setup_;
};

TEST_F(DysegTraining, AStoppedRunGoesOnExactly)
{
  const auto whole = contentOf(train("whole", 4));
  const auto most = contentOf(train("parts", 3));
  EXPECT_TRUE(most != whole);
  EXPECT_TRUE(contentOf(train("parts", 4, true)) == whole);

  int asked = 0;
  {
    DysegTrainer trainer = DysegTrainer::begin(setup_, (folder_ / "asked").string());
    trainer.run([](const std::string&) {}, [&] { return ++asked > 2; });
  }
  EXPECT_EQ(asked, 3);
  EXPECT_TRUE(contentOf(folder_ / "asked" / "dyseg.safetensors") != whole);
  EXPECT_TRUE(contentOf(train("asked", 4, true)) == whole);
}

TEST_F(DysegTraining, AnyNumberOfThreadsGivesTheSameWeights)
{
  setup_.train.batch = 3;
  const auto one = contentOf(train("one", 2));
  setup_.train.threads = 2;
  EXPECT_TRUE(contentOf(train("two", 2)) == one);
}

TEST_F(DysegTraining, RefusesADeviceThatThereIsNot)
{
  setup_.device = "abacus";
  EXPECT_THROW(beginIn(folder_), dyslam::UserError);
}

TEST_F(DysegTraining, IsLengthenedFromTheCheckpointBeforeTheDecay)
{
  setup_.train.rate.decay_start = 0.5;
  const auto whole = contentOf(train("long", 4));
  train("short", 2);
  fs::create_directories(folder_ / "lengthened");
  fs::copy_file(folder_ / "short" / "checkpoint_before_decay.safetensors",
                folder_ / "lengthened" / "checkpoint.safetensors");
  EXPECT_TRUE(contentOf(train("lengthened", 4, true)) == whole);
}

TEST_F(DysegTraining, DoesNotOverwriteATraining)
{
  train("kept", 1);
  EXPECT_THROW(beginIn(folder_ / "kept"), dyslam::UserError);
  EXPECT_NO_THROW(beginIn(folder_ / "other"));
  EXPECT_FALSE(fs::exists(folder_ / "other")) << "only run() writes";
}

TEST_F(DysegTraining, AFinishedRunIsValidatedOnce)
{
  setup_.train.data.clear();
  setup_.train.validate_every = 1000;
  setup_.train.steps = 1;
  setup_.grid.cells = 256;
  const fs::path folder = folder_ / "finished";
  const auto files = [&]
  { return std::distance(fs::directory_iterator(folder), fs::directory_iterator()); };
  DysegTrainer::begin(setup_, folder.string()).run([](const std::string&) {});
  const auto rows = contentOf(folder / "validation.csv");
  EXPECT_NE(rows.find("\n1,simulated street,"), std::string::npos) << rows;

  const auto before = files();
  std::string said;
  const auto say = [&](const std::string& line) { said += line + "\n"; };
  const auto validate = [&](const dyslam::GivenDysegShape& given)
  { dyslam::validateDyseg(setup_, folder.string(), "", given, say); };
  validate({setup_.grid, setup_.network});
  EXPECT_NE(said.find("simulated street 8 scans back,"), std::string::npos) << said;
  EXPECT_EQ(files(), before) << "validation alone leaves the folder as it is";
  EXPECT_EQ(contentOf(folder / "validation.csv"), rows);
  auto other = setup_.grid;
  other.cells = 512;
  try
  {
    validate({other, std::nullopt});
    ADD_FAILURE() << "the grid is not that of the weights";
  }
  catch (const dyslam::UserError& error)
  {
    EXPECT_NE(std::string(error.what()).find("trained with [grid] cells = 256, not 512"),
              std::string::npos)
        << error.what();
  }
  auto network = setup_.network;
  network.radius = setup_.network.radius + 1;
  try
  {
    validate({std::nullopt, network});
    ADD_FAILURE() << "the network is not that of the weights";
  }
  catch (const dyslam::UserError& error)
  {
    EXPECT_NE(std::string(error.what()).find("trained with [network] radius = "), std::string::npos)
        << error.what();
  }

  train("finished", 1, true);
  EXPECT_EQ(contentOf(folder / "validation.csv"), rows);
}

TEST_F(DysegTraining, FramesToValidateOnAreNotTrainedOn)
{
  setup_.train.data = folder_.string();
  fs::create_directories(folder_ / "run");
  setup_.train.boxed_run = "run";
  setup_.train.boxed_validation = "run";
  setup_.train.boxed_validation_first = 48;
  const auto check = [&](int last)
  {
    setup_.train.boxed_last = last;
    dyslam::checkDysegValidation(setup_.train);
  };
  EXPECT_NO_THROW(check(47));
  EXPECT_THROW(check(48), dyslam::UserError);
  EXPECT_THROW(beginIn(folder_ / "out"), dyslam::UserError);
  setup_.train.boxed_validation.clear();
  EXPECT_NO_THROW(check(48));
}

TEST_F(DysegTraining, FramesToValidateOnHaveScansBeforeThem)
{
  const auto said = [&]
  {
    try
    {
      beginIn(folder_ / "out");
    }
    catch (const dyslam::UserError& e)
    {
      return std::string(e.what());
    }
    return std::string();
  };
  setup_.train.boxed_validation_first = 7;
  EXPECT_NE(said().find("[train] boxed_validation_first = 7 is out of range; use 8"),
            std::string::npos)
      << said();
  setup_.train.boxed_validation_first = 8;
  setup_.train.labelled_validation_first = 0;
  EXPECT_NE(said().find("[train] labelled_validation_first = 0 is out of range; use 1"),
            std::string::npos)
      << said();
}

TEST_F(DysegTraining, FramesAndSeedsOfAnotherSplitAreRefused)
{
  const std::string run = "vls128_run88";
  setup_.train.data = folder_.string();
  fs::create_directories(folder_ / run / "velodyne");
  setup_.train.boxed_run = run;
  setup_.train.boxed_validation.clear();
  setup_.train.labelled_validation.clear();
  setup_.train.single_scans.clear();
  const auto said = [&]
  {
    try
    {
      beginIn(folder_ / "out");
    }
    catch (const dyslam::UserError& e)
    {
      return std::string(e.what());
    }
    return std::string();
  };
  setup_.train.boxed_last = 48;
  EXPECT_NE(said().find("frame 48 of vls128_run88 is for validation"), std::string::npos) << said();
  setup_.train.boxed_last = 47;
  setup_.train.boxed_validation = run;
  setup_.train.boxed_validation_last = 64;
  setup_.train.validate_every = 1000;
  EXPECT_NE(said().find("frame 64 of vls128_run88 is for test"), std::string::npos) << said();
  setup_.train.data.clear();
  fs::create_directories(folder_);
  std::ofstream(folder_ / "mine.ini") << "[simulator]\ntraining = 0-10\ntest = 900000000-\n";
  setup_.train.splits = (folder_ / "mine.ini").string();
  EXPECT_NE(said().find("seed 900000000 of the simulator is for test"), std::string::npos)
      << said();
}

TEST_F(DysegTraining, MissingValidationDataAreToldBeforeTheFirstStep)
{
  setup_.train.data = folder_.string();
  setup_.train.validate_every = 1000;
  setup_.train.boxed_run.clear();
  setup_.train.single_scans.clear();
  setup_.train.boxed_validation = "nowhere";
  EXPECT_THROW(beginIn(folder_ / "out"), dyslam::UserError);
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

TEST_F(DysegTraining, CropsThatCannotBeHalvedAreRefused)
{
  setup_.train.crop = 100;
  EXPECT_THROW(beginIn(folder_ / "out"), dyslam::UserError);
}

TEST_F(DysegTraining, WeightsOfAnotherShapeAndMissingStatesAreRefused)
{
  const auto weights = train("small", 1).string();
  setup_.network.hidden = 12;
  EXPECT_THROW(beginIn(folder_ / "other", weights), dyslam::UserError);
  EXPECT_THROW(resumeIn(folder_ / "other"), dyslam::UserError);
  EXPECT_THROW(resumeIn(folder_ / "small"), dyslam::UserError) << "the state is of another shape";
}

TEST_F(DysegTraining, WeightsOfAnotherGridAreRefused)
{
  const auto weights = train("first", 1).string();
  const auto said = [&](const dyslam::BevOptions& grid)
  {
    auto setup = setup_;
    setup.grid = grid;
    try
    {
      (void)DysegTrainer::begin(setup, (folder_ / "second").string(), weights);
    }
    catch (const dyslam::UserError& e)
    {
      return std::string(e.what());
    }
    return std::string();
  };
  auto grid = setup_.grid;
  grid.cells = 1024;
  EXPECT_EQ(said(grid), "") << "its extent may differ";
  grid.cell_size = 0.25;
  EXPECT_NE(said(grid).find(weights + ": trained with [grid] cell_size = 0.2, not 0.25"),
            std::string::npos)
      << said(grid);
  grid = setup_.grid;
  grid.ground_clearance = 0.3;
  EXPECT_NE(said(grid).find("ground_clearance = 0.2, not 0.3"), std::string::npos) << said(grid);
  grid = setup_.grid;
  grid.max_height = 3;
  EXPECT_NE(said(grid).find("max_height = 4.5, not 3"), std::string::npos) << said(grid);

  setup_.grid.cells = 1024;
  EXPECT_NO_THROW(resumeIn(folder_ / "first"));
  setup_.grid = grid;
  EXPECT_THROW(resumeIn(folder_ / "first"), dyslam::UserError);
}
}  // namespace
