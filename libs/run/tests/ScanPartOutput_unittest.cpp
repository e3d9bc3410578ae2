// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/ScanParts.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "../src/outputs/RunOutput.h"
#include "TestFolder.h"

namespace dyslam
{
std::unique_ptr<RunOutput> makeScanPartOutput(const RunOutputContext& context);

namespace
{
Frame frameWithParts()
{
  Frame frame;
  frame.index = 7;
  frame.scan.stamp = 100;
  frame.scan.points.resize(4);
  Scan left;
  left.stamp = 100.25;
  left.sensor_label = "left";
  left.points.resize(3);
  appendScan(left, 1, frame.scan);
  Scan rear;
  rear.stamp = 99.5;
  rear.sensor_label = "rear,2";
  rear.points.resize(1);
  appendScan(rear, 2, frame.scan);
  return frame;
}

void writeTable(const TestFolder& folder, const Config& given)
{
  SlamRunSettings settings;
  settings.output_folder = folder.path();
  ConfigLoader config(given);
  const auto output = makeScanPartOutput({settings, config, 0.1});
  output->open();
  output->add(frameWithParts());
  Frame without = frameWithParts();
  without.scan.parts.clear();
  output->add(without);
  output->finish({});
}

TEST(ScanPartOutput, HasARowForEachFurtherScan)
{
  const TestFolder folder;
  Config given;
  given.set("input.further_lidars=left|rear.*");
  writeTable(folder, given);
  EXPECT_EQ(folder.read("scan_parts.csv"),
            "frame,sensor_label,stamp,first_point,points\n"
            "7,left,100.250000000,4,3\n"
            "7,\"rear,2\",99.500000000,7,1\n");
}

TEST(ScanPartOutput, ARunOfOneLidarHasNone)
{
  const TestFolder folder;
  writeTable(folder, Config());
  EXPECT_FALSE(std::filesystem::exists(folder.file("scan_parts.csv")));
}
}  // namespace
}  // namespace dyslam
