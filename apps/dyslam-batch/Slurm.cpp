// SPDX-License-Identifier: BSD-3-Clause
#include "Slurm.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/PendingFile.h>
#include <dyslam/base/Printable.h>
#include <dyslam/batch/SlurmJob.h>

#include <filesystem>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

namespace dyslam::batch
{
void submitToSlurm(const Arguments& a, const std::vector<Recording>& recordings)
{
  SlurmJob job;
  job.program = std::filesystem::read_symlink("/proc/self/exe").string();
  job.output = std::filesystem::absolute(a.output).lexically_normal().string();
  job.list = job.output + "/slurm/recordings.txt";
  job.scratch =
      a.scratch.empty() ? "" : std::filesystem::absolute(a.scratch).lexically_normal().string();
  Arguments absolute = a;
  if (std::filesystem::is_regular_file(a.config))
  {
    absolute.config = std::filesystem::absolute(a.config).string();
  }
  job.arguments = runArguments(absolute);
  const std::vector<std::string> conversion = a.conversion.withAbsolutePaths().words();
  job.arguments.insert(job.arguments.end(), conversion.begin(), conversion.end());
  std::istringstream options(a.slurm_options);
  for (std::string option; options >> option;)
  {
    job.options.push_back(option);
  }
  std::string list;
  for (const Recording& recording : recordings)
  {
    if (recording.path.find_first_of("#\n") != std::string::npos)
    {
      throw UserError(recording.path + ": has a # or a line break in its name; rename it");
    }
    list += recording.path + "\n";
  }
  job.tasks = arrayTasks(recordings.size());
  makeFolder(job.output + "/slurm", "choose another --output");
  writeWhole(job.list, list);
  const SubmittedJob numbers = submit(job);
  std::cout << counted(recordings.size(), "recording") << " in job " << numbers.array << ", "
            << counted(job.tasks, "task") << "; job " << numbers.gather << " gathers into "
            << job.output << "/index.html; logs in " << job.output << "/slurm\n";
}
}  // namespace dyslam::batch
