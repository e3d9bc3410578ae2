// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace dyslam::batch
{
/** A batch for the workload manager Slurm: an array of tasks, each with its part of the recordings,
 * and a job after the array that writes table and page. */
struct SlurmJob
{
  std::string program;                 //!< path of dyslam-batch
  std::string list;                    //!< list file of the recordings
  std::string output;                  //!< folder of the results, on storage that all nodes share
  std::vector<std::string> arguments;  //!< further arguments of dyslam-batch
  std::vector<std::string> options;    //!< options of sbatch, such as `--partition=x`
  std::string scratch;    //!< absolute folder on each node to run in; empty: $TMPDIR or /tmp
  std::size_t tasks = 1;  //!< number of tasks of the array
};

/** Script of a task: runs its part of the list in a folder of its own on the node, which is removed
 * at the end. A task that a signal ends is queued again, twice at most; a task that Slurm preempts
 * is queued again, too. */
[[nodiscard]] std::string arrayScript(const SlurmJob& job);
[[nodiscard]] std::string gatherScript(const SlurmJob& job);

/** Number of tasks that an array may have on this cluster. \param recordings number of recordings
 * \throws UserError without Slurm. */
[[nodiscard]] std::size_t arrayTasks(std::size_t recordings);

struct SubmittedJob
{
  std::string array;   //!< number of the array job
  std::string gather;  //!< number of the job that begins when all tasks of the array have ended
};

/** Writes the scripts into `output`/slurm and hands them to sbatch. \throws UserError. */
SubmittedJob submit(const SlurmJob& job);
}  // namespace dyslam::batch
