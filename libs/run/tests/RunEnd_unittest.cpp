// SPDX-License-Identifier: BSD-3-Clause
#include "../src/RunEnd.h"

#include <dyslam/base/Error.h>
#include <dyslam/formats/ProgramLines.h>
#include <dyslam/formats/RunFiles.h>
#include <gtest/gtest.h>

#include <string>

#include "TestFolder.h"

namespace dyslam
{
namespace
{
/** What a program prints about these failures of a run with a checkpoint. */
std::string lineFor(const std::vector<std::string>& failures)
{
  const TestFolder folder;
  folder.write(run_files::state, "");
  SlamRunSettings settings;
  settings.output_folder = folder.path();
  RunResults results;
  results.failures = failures;
  return errorLine(
      "dyslam", messageOfError<UserError>([&] { requireComplete(EarlyEnd(), results, settings); }));
}

TEST(RunEnd, AFullDiskLeavesRoomForTheAdvice)
{
  const std::string cause = ": cannot be written: No space left on device";
  std::vector<std::string> failures{"out/a.txt" + cause};
  const std::string one = lineFor(failures);
  EXPECT_TRUE(contains(one, failures.front() + "; the other results are in ")) << one;
  EXPECT_TRUE(canBeCompletedLine("dyslam", one)) << one;
  for (int i = 0; i < 20; ++i)
  {
    failures.push_back("out/labels/" + std::to_string(i) + ".label" + cause);
  }
  const std::string many = lineFor(failures);
  EXPECT_TRUE(contains(many, failures.front() + "; out/labels/0.label: ")) << many;
  EXPECT_TRUE(contains(many, " more results could not be written; the other results are")) << many;
  EXPECT_TRUE(canBeCompletedLine("dyslam", many)) << many;
}
}  // namespace
}  // namespace dyslam
