// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/formats/LabelFiles.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "../src/outputs/RunOutput.h"
#include "../src/results/RunHistory.h"
#include "TestFolder.h"

namespace dyslam
{
std::unique_ptr<RunOutput> makeLabelOutput(const RunOutputContext& context);

namespace
{
constexpr int elder = 3;
constexpr int younger = 8;

TrackedObject objectAt(std::size_t scan, int id)
{
  TrackedObject object;
  object.id = id;
  object.object_class = ObjectClass::car;
  object.observed = true;
  object.reported = id == elder || scan >= 2;  // the younger one is confirmed in the third scan
  object.detection = id == elder ? 0 : 1;
  return object;
}

/** Of four points the first is static, then there is one of each object, and the last one moves
 * but is of no object. */
Frame frameAt(std::size_t scan)
{
  Frame frame;
  frame.index = scan;
  frame.scan.points.assign(4, {1, 2, 3});
  frame.cloud.points = frame.scan.points;
  frame.cloud.source = {0, 1, 2, 3};
  frame.moving = {false, true, true, true};
  for (const std::uint32_t point : {1U, 2U})
  {
    frame.detections.emplace_back();
    frame.detections.back().points = {point};
  }
  frame.objects = {objectAt(scan, elder), objectAt(scan, younger)};
  return frame;
}

/** Instances of the points of each scan, after a run in which the tracks were merged or not. */
std::vector<std::vector<int>> instancesAfter(const std::map<int, int>& merged)
{
  const TestFolder folder;
  SlamRunSettings settings;
  settings.output_folder = folder.path();
  const Config given;
  ConfigLoader config(given);
  const auto output = makeLabelOutput({settings, config, 0.1});
  output->open();
  RunHistory history;
  for (std::size_t scan = 0; scan < 4; ++scan)
  {
    const Frame frame = frameAt(scan);
    history.addScan(frame);
    history.addObjects(scan, frame.objects, TrackLife::whole);
    output->add(frame);
  }
  RunResults results;
  results.history = &history;
  results.merged_tracks = merged;
  output->finish(results);
  std::vector<std::vector<int>> instances;
  for (std::size_t scan = 0; scan < 4; ++scan)
  {
    instances.emplace_back();
    for (const Label label :
         readLabels(folder.file("labels/00000" + std::to_string(scan) + ".label")))
    {
      instances.back().push_back(instanceOf(label));
    }
  }
  return instances;
}

TEST(LabelOutput, ObjectsHaveTheirNumberFromTheFirstDetectionOn)
{
  EXPECT_EQ(instancesAfter({}), std::vector<std::vector<int>>(4, {0, elder + 1, younger + 1, 0}));
}

TEST(LabelOutput, MergedTracksHaveTheNumberOfTheirObject)
{
  EXPECT_EQ(instancesAfter({{younger, elder}}),
            std::vector<std::vector<int>>(4, {0, elder + 1, elder + 1, 0}));
}
}  // namespace
}  // namespace dyslam
