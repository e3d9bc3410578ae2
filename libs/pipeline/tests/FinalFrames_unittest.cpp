// SPDX-License-Identifier: BSD-3-Clause
#include "../src/FinalFrames.h"

#include <dyslam/base/Config.h>
#include <dyslam/base/Parallel.h>
#include <gtest/gtest.h>
#include <mrpt/system/CTimeLogger.h>

#include <cstddef>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace dyslam
{
namespace
{
using Numbers = std::vector<std::size_t>;

/** The causal frame of a scan with a few points, all of them moving. */
Frame causalFrame(std::size_t index)
{
  Frame frame;
  frame.index = index;
  frame.dt = index == 0 ? 0 : 0.1;
  frame.scan.stamp = 0.1 * static_cast<double>(index);
  frame.scan.points = {{10, 0, 0}, {0, 10, 0}, {-10, 0, 0}};
  frame.cloud.points = frame.scan.points;
  frame.cloud.intensity = {0.1F, 0.2F, 0.3F};
  frame.cloud.source = {0, 1, 2};
  frame.moving = {true, true, true};
  frame.moving_probability = {1, 1, 1};
  return frame;
}

/** Final frames of a run with these settings, without a map. */
class FinalRun
{
 public:
  explicit FinalRun(const std::vector<std::string>& assignments, bool has_given_boxes = false)
      : config_(configOf(assignments)),
        loader_(config_),
        final_frames_(loader_, has_given_boxes, keyframes_, pool_, times_)
  {
  }

  void receive(FrameParts parts)
  {
    final_frames_.onFinal([this](Frame frame) { received_.push_back(std::move(frame)); }, parts);
  }
  /** Adds the next scan. \return numbers of the frames received so far */
  Numbers add()
  {
    final_frames_.add(causalFrame(added_++));
    return numbers();
  }
  Numbers finish()
  {
    final_frames_.finish();
    return numbers();
  }
  [[nodiscard]] const std::vector<Frame>& received() const { return received_; }
  [[nodiscard]] const FinalFrames& operator*() const { return final_frames_; }

 private:
  static Config configOf(const std::vector<std::string>& assignments)
  {
    Config config;
    config.set("pipeline.mapping=false");
    for (const std::string& assignment : assignments)
    {
      config.set(assignment);
    }
    return config;
  }
  [[nodiscard]] Numbers numbers() const
  {
    Numbers numbers;
    for (const Frame& frame : received_)
    {
      numbers.push_back(frame.index);
    }
    return numbers;
  }

  Config config_;
  ConfigLoader loader_;
  KeyframeStore keyframes_;
  ThreadPool pool_;
  mrpt::system::CTimeLogger times_{false};
  FinalFrames final_frames_;
  std::vector<Frame> received_;
  std::size_t added_ = 0;
};

TEST(FinalFrames, WithHindsightFollowAfterTheWindowAndTheLastOnesAtTheEnd)
{
  FinalRun run({"labels.window=3"});
  ASSERT_TRUE((*run).hasHindsightLabels());
  run.receive(FrameParts::points);
  EXPECT_EQ(run.add(), Numbers()) << "the first one waits for the second";
  EXPECT_EQ(run.add(), Numbers());
  EXPECT_EQ(run.add(), Numbers());
  EXPECT_EQ(run.add(), Numbers{0});
  EXPECT_EQ(run.add(), (Numbers{0, 1}));
  EXPECT_EQ(run.finish(), (Numbers{0, 1, 2, 3, 4}));
}

TEST(FinalFrames, WithoutHindsightAreTheCausalOnesAtOnce)
{
  FinalRun run({"labels.hindsight=false"});
  ASSERT_FALSE((*run).hasHindsightLabels());
  run.receive(FrameParts::all);
  EXPECT_EQ(run.add(), Numbers()) << "the first one waits for the second, whose motion deskews it";
  EXPECT_EQ(run.add(), (Numbers{0, 1}));
  EXPECT_EQ(run.add(), (Numbers{0, 1, 2}));
  EXPECT_EQ(run.finish(), (Numbers{0, 1, 2}));
  for (const Frame& frame : run.received())
  {
    EXPECT_EQ(frame.moving, causalFrame(frame.index).moving);
  }
}

TEST(FinalFrames, ASingleFrameIsFinalAtTheEnd)
{
  for (const char* hindsight : {"labels.hindsight=true", "labels.hindsight=false"})
  {
    FinalRun run({hindsight});
    run.receive(FrameParts::points);
    EXPECT_EQ(run.add(), Numbers());
    EXPECT_EQ(run.finish(), Numbers{0});
  }
}

TEST(FinalFrames, HaveThePartsThatTheReceiverNeeds)
{
  for (const FrameParts parts : {FrameParts::points, FrameParts::intensity, FrameParts::all})
  {
    FinalRun run({"labels.window=1"});
    run.receive(parts);
    for (std::size_t i = 0; i < 3; ++i)
    {
      (void)run.add();
    }
    (void)run.finish();
    ASSERT_EQ(run.received().size(), 3U);
    for (const Frame& frame : run.received())
    {
      EXPECT_EQ(frame.cloud.points.size(), 3U);
      EXPECT_EQ(frame.cloud.intensity.empty(), parts == FrameParts::points);
      EXPECT_EQ(frame.scan.points.empty(), parts != FrameParts::all);
    }
  }
}

TEST(FinalFrames, AReceiverThatNeedsNoPartsIsNotCalled)
{
  for (const char* hindsight : {"labels.hindsight=true", "labels.hindsight=false"})
  {
    FinalRun run({hindsight, "labels.window=1"});
    run.receive(FrameParts::none);
    for (std::size_t i = 0; i < 3; ++i)
    {
      EXPECT_EQ(run.add(), Numbers());
    }
    EXPECT_EQ(run.finish(), Numbers());
  }
}

TEST(FinalFrames, TheReceiverIsSetBeforeTheFirstFrame)
{
  FinalRun run({});
  run.receive(FrameParts::all);
  run.receive(FrameParts::points);
  (void)run.add();
  EXPECT_THROW(run.receive(FrameParts::points), std::logic_error);
}

TEST(FinalFrames, ASecondTrackingNeedsLabelsWithHindsightAndObjectsOfItsOwn)
{
  EXPECT_TRUE((*FinalRun({})).hasSecondTracking());
  EXPECT_FALSE((*FinalRun({}, true)).hasSecondTracking()) << "boxes of another program";
  for (const char* off : {"labels.hindsight=false", "pipeline.hindsight_tracking=false",
                          "pipeline.tracking=false", "backend.mode=segmot"})
  {
    EXPECT_FALSE((*FinalRun({off})).hasSecondTracking()) << off;
  }
}

TEST(FinalFrames, OfASecondTrackingShowWhatTheFirstOneReported)
{
  for (const bool tracks_again : {true, false})
  {
    FinalRun run({"labels.window=1",
                  std::string("pipeline.hindsight_tracking=") + (tracks_again ? "true" : "false")});
    run.receive(FrameParts::points);
    (void)run.add();
    EXPECT_EQ(run.finish(), Numbers{0});
    EXPECT_EQ(run.received().front().reported_before.size(), tracks_again ? 3U : 0U);
  }
}
}  // namespace
}  // namespace dyslam
