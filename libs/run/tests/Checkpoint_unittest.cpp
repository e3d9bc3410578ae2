// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Files.h>
#include <dyslam/io/RawlogSource.h>
#include <dyslam/pipeline/Pipeline.h>
#include <dyslam/run/SlamRun.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "../src/checkpoint/CheckpointSchedule.h"
#include "TestFolder.h"

namespace dyslam
{
namespace
{
/** The front end has later frames while a checkpoint is written: its methods are those that the
 * checkpoint was begun with (gyroscope and wheels count once they cover a scan). */
TEST(Checkpoint, ReportsTheMethodThatTheFrontEndHadThere)
{
  const TestFolder folder;
  SlamRunSettings settings;
  settings.rawlog = std::string(DYSLAM_SOURCE_DIR) + "/rawlog/campus16.rawlog";
  settings.output_folder = folder.file("run");
  settings.config =
      Config::fromFile(std::string(DYSLAM_SOURCE_DIR) + "/share/dyslam/config_files/vlp16.ini");
  SlamRun run(settings);
  RawlogSource source(settings.rawlog, run.input());
  run.open();
  auto frame = source.next();
  ASSERT_TRUE(frame);
  run.pipeline().process(*frame);
  run.add(std::move(*frame));
  BegunCheckpoint begun;
  begun.method = "method of the first scan";
  run.checkpoint(begun);
  const std::string report = readWhole(settings.output_folder + "/report.json");
  EXPECT_TRUE(contains(report, "\"method\": \"method of the first scan\"")) << report;
}
}  // namespace
}  // namespace dyslam
