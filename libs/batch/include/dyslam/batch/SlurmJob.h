// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace dyslam::batch
{
/** A batch for the workload manager Slurm: an array of tasks, each with its part of the recordings,
 * and a job behind it that writes table and page. */
struct SlurmJob
{
  std::string program;                 //!< path of dyslam-batch
  std::string list;                    //!< list file of the recordings
  std::string output;                  //!< folder, on storage that all nodes share
  std::vector<std::string> arguments;  //!< of dyslam-batch, but for those above
  std::vector<std::string> options;    //!< of sbatch, as `--partition=x`
  std::string scratch;  //!< absolute, on a disk of each node, to run in; empty: $TMPDIR or /tmp
  std::size_t tasks = 1;
};

/** Runs a part of the list in a folder of its own on the node, which is removed behind it. A task
 * that a signal ends is queued again, twice at most; so is one that Slurm preempts. */
[[nodiscard]] std::string arrayScript(const SlurmJob& job);
[[nodiscard]] std::string gatherScript(const SlurmJob& job);

/** Tasks that one array may have here, for that many recordings. \throws UserError without Slurm.
 */
[[nodiscard]] std::size_t arrayTasks(std::size_t recordings);

struct SubmittedJob
{
  std::string array;   //!< its number
  std::string gather;  //!< begins when all tasks of the array have ended
};

/** Writes the scripts into `output`/slurm and hands them to sbatch. \throws UserError. */
SubmittedJob submit(const SlurmJob& job);
}  // namespace dyslam::batch
