// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/batch/SlurmJob.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "TestFolder.h"

namespace dyslam::batch
{
namespace
{
/** Runs a script as Slurm runs one task; its programs are scripts in `folder`. */
int runTask(const TestFolder& folder, const std::string& script)
{
  folder.write("array.sh", script);
  const std::string command =
      "cd '" + folder.path() + "' && PATH='" + folder.path() + ":'\"$PATH\" TMPDIR='" +
      folder.path() +
      "' SLURM_ARRAY_JOB_ID=70 SLURM_ARRAY_TASK_ID=2 SLURM_JOB_ID=77 bash array.sh > out.txt 2>&1";
  const int status = std::system(command.c_str());
  return WEXITSTATUS(status);
}

SlurmJob jobIn(const TestFolder& folder)
{
  SlurmJob job;
  job.program = folder.file("it's batch");
  job.list = folder.file("list 100%.txt");
  job.output = folder.file("out 50%");
  job.arguments = {"-c", "kitti64.ini", "--set", "a.b=c d"};
  job.options = {"--mem=3G"};
  job.tasks = 3;
  return job;
}

void writeProgram(const TestFolder& folder, const std::string& name, const std::string& text)
{
  std::filesystem::permissions(folder.write(name, "#!/bin/bash\n" + text),
                               std::filesystem::perms::owner_all);
}
}  // namespace

TEST(SlurmJob, TaskRunsItsPartInScratchAndCleansUp)
{
  const TestFolder folder;
  writeProgram(folder, "it's batch",
               "printf '%s|' \"$@\"\nwhile [[ $1 != --scratch ]]; do shift; done\n[[ -d $2 && ! -e "
               "$2/left ]] && "
               "echo \"scratch $2\"\n");
  folder.write("dyslam.70_2/left", "by one that was killed");
  const std::string script = arrayScript(jobIn(folder));
  EXPECT_EQ(runTask(folder, script), 0);
  const std::string said = folder.read("out.txt");
  EXPECT_TRUE(contains(said, folder.file("list 100%.txt") + "|-o|" + folder.file("out 50%") +
                                 "|-c|kitti64.ini|--set|a.b=c d|--shard|2/3|--jobs|1|"))
      << said;
  const auto scratch = said.find("scratch ");
  ASSERT_NE(scratch, std::string::npos) << said;
  const std::string path = said.substr(scratch + 8, said.find('\n', scratch) - scratch - 8);
  EXPECT_FALSE(std::filesystem::exists(path)) << path;
  for (const char* line : {"#SBATCH --array=1-3\n", "#SBATCH --requeue\n", "#SBATCH --mem=3G\n",
                           "out 50%%/slurm/%a.log\"\n"})
  {
    EXPECT_TRUE(contains(script, line)) << script;
  }
}

TEST(SlurmJob, TaskRunsInTheScratchFolderThatIsGiven)
{
  const TestFolder folder;
  writeProgram(folder, "it's batch", "while [[ $1 != --scratch ]]; do shift; done\necho \"$2\"\n");
  SlurmJob job = jobIn(folder);
  job.scratch = folder.file("it's local/disk 1");
  EXPECT_EQ(runTask(folder, arrayScript(job)), 0);
  EXPECT_EQ(folder.read("out.txt"), job.scratch + "/dyslam.70_2\n");
  EXPECT_TRUE(std::filesystem::is_empty(job.scratch));
  EXPECT_FALSE(contains(gatherScript(job), "disk 1"));
}

TEST(SlurmJob, TaskThatASignalEndsIsQueuedAgainAndBadInputIsNot)
{
  const TestFolder folder;
  writeProgram(folder, "scontrol", "echo \"asked: $*\"\n");
  writeProgram(folder, "it's batch", "kill -9 $$\n");
  EXPECT_EQ(runTask(folder, arrayScript(jobIn(folder))), 137);
  EXPECT_TRUE(contains(folder.read("out.txt"), "asked: requeue 77")) << folder.read("out.txt");
  writeProgram(folder, "it's batch", "exit 2\n");
  EXPECT_EQ(runTask(folder, arrayScript(jobIn(folder))), 2);
  EXPECT_FALSE(contains(folder.read("out.txt"), "requeue"));
}

TEST(SlurmJob, IsSubmittedWithAJobBehindIt)
{
  const TestFolder folder;
  writeProgram(folder, "sbatch",
               "echo \"$*\" >> '" + folder.file("asked.txt") + "'\necho '12;cluster'\n");
  writeProgram(folder, "scontrol", "echo 'MaxArraySize            = 5'\n");
  const std::string path = std::getenv("PATH");
  ::setenv("PATH", (folder.path() + ":" + path).c_str(), 1);
  const SubmittedJob numbers = submit(jobIn(folder));
  EXPECT_EQ(arrayTasks(3), 3U);
  EXPECT_EQ(arrayTasks(1000), 4U);
  writeProgram(folder, "scontrol", "echo 'MaxArraySize            = 0'\n");
  EXPECT_EQ(arrayTasks(1000), 1U) << "arrays are switched off";
  writeProgram(folder, "sbatch", "exit 0\n");
  EXPECT_THROW((void)submit(jobIn(folder)), UserError) << "no job number";
  ::setenv("PATH", path.c_str(), 1);
  EXPECT_EQ(numbers.array, "12");
  EXPECT_TRUE(contains(folder.read("asked.txt"), "--dependency=afterany:12 "));
  EXPECT_TRUE(contains(folder.read("out 50%/slurm/gather.sh"), "--gather"));
}
}  // namespace dyslam::batch
