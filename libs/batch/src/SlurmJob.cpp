// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/PendingFile.h>
#include <dyslam/batch/SlurmJob.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>

namespace fs = std::filesystem;

namespace dyslam::batch
{
namespace
{
/** Quotes a text as one word of a shell command. */
std::string quoted(const std::string& text)
{
  std::string result = "'";
  for (const char c : text)
  {
    result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  }
  return result + "'";
}

std::string commandOf(const SlurmJob& job)
{
  std::string command = quoted(job.program) + " " + quoted(job.list) + " -o " + quoted(job.output);
  for (const std::string& argument : job.arguments)
  {
    command += " " + quoted(argument);
  }
  return command;
}

std::string header(const SlurmJob& job, const std::string& name, const std::string& log)
{
  // Slurm replaces patterns with % in the name of a log; %% stands for a %.
  std::string folder;
  for (const char c : job.output)
  {
    folder += c == '%' ? std::string("%%") : std::string(1, c);
  }
  std::string text = "#!/bin/bash\n#SBATCH --job-name=" + name + "\n#SBATCH --output=\"" + folder +
                     "/slurm/" + log + "\"\n#SBATCH --open-mode=append\n#SBATCH --requeue\n";
  for (const std::string& option : job.options)
  {
    text += "#SBATCH " + option + "\n";
  }
  return text;
}

/** The output of a command. \throws UserError if it fails. */
std::string answerOf(const std::string& command)
{
  std::string answer;
  FILE* pipe = ::popen((command + " 2>&1").c_str(), "r");
  std::array<char, 512> part = {};
  while (pipe != nullptr && std::fgets(part.data(), static_cast<int>(part.size()), pipe) != nullptr)
  {
    answer += part.data();
  }
  if (pipe == nullptr || ::pclose(pipe) != 0)
  {
    std::replace(answer.begin(), answer.end(), '\n', ' ');
    throw UserError("--slurm: " + command.substr(0, command.find(' ')) + " failed: " + answer);
  }
  return answer;
}

/** The number of the job in sbatch's output: "12" or "12;cluster". */
std::string submitted(const std::string& command)
{
  const std::string answer = answerOf(command);
  const auto digits = answer.find_first_not_of("0123456789");
  if (answer.empty() || digits == 0)
  {
    throw UserError("--slurm: sbatch gave no job number but: " + answer);
  }
  return answer.substr(0, digits);
}
}  // namespace

std::string arrayScript(const SlurmJob& job)
{
  const std::string count = std::to_string(job.tasks);
  const std::string given = quoted(job.scratch);
  return header(job, "dyslam", "%a.log") + "#SBATCH --array=1-" + count + "\n" +
         (job.scratch.empty() ? "" : "mkdir -p " + given + "\n") +
         "# A task that was killed has left its folder.\nscratch=" +
         (job.scratch.empty() ? "${TMPDIR:-/tmp}" : given) +
         "/dyslam.${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID\n"
         "rm -rf \"$scratch\"\n"
         "mkdir -m 700 \"$scratch\" || exit 1\n"
         "trap 'rm -rf \"$scratch\"' EXIT\n" +
         commandOf(job) + " --shard \"$SLURM_ARRAY_TASK_ID/" + count +
         "\" --jobs 1 --scratch \"$scratch\" --no-summary\n"
         "code=$?\n"
         "# Ended by a signal: queued again, twice at most.\n"
         "if ((code > 128 && ${SLURM_RESTART_COUNT:-0} < 2)); then\n"
         "  scontrol requeue \"$SLURM_JOB_ID\"\n"
         "fi\n"
         "exit $code\n";
}

std::string gatherScript(const SlurmJob& job)
{
  return header(job, "dyslam-gather", "gather.log") + commandOf(job) + " --gather\n";
}

std::size_t arrayTasks(std::size_t recordings)
{
  const std::string config = answerOf("scontrol show config");
  const std::string key = "MaxArraySize";
  const auto at = config.find(key);
  const auto digit = config.find_first_of("0123456789", at);
  // Slurm's limit is one above the highest task number; its default if scontrol does not print it.
  const std::size_t limit = at == std::string::npos || digit == std::string::npos
                                ? 1001
                                : std::stoul(config.substr(digit));
  return std::min(std::max<std::size_t>(1, recordings), std::max<std::size_t>(2, limit) - 1);
}

SubmittedJob submit(const SlurmJob& job)
{
  const std::string folder = (fs::path(job.output) / "slurm").string();
  makeFolder(folder, "choose another --output");
  const std::string array = folder + "/array.sh";
  const std::string gather = folder + "/gather.sh";
  writeWhole(array, arrayScript(job));
  writeWhole(gather, gatherScript(job));
  SubmittedJob numbers;
  numbers.array = submitted("sbatch --parsable " + quoted(array));
  numbers.gather =
      submitted("sbatch --parsable --dependency=afterany:" + numbers.array + " " + quoted(gather));
  return numbers;
}
}  // namespace dyslam::batch
