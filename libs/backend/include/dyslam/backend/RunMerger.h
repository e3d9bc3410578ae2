// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/FactorGraph.h>
#include <dyslam/backend/LoopCloser.h>
#include <dyslam/core/Options.h>
#include <dyslam/core/Pose.h>
#include <dyslam/core/SwapFile.h>

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace dyslam
{
struct RunMergerOptions : Options
{
  /** Least fraction of the keyframes near those of other runs that registrations confirm: a street
   * that looks like another fails here. */
  double min_confirmed = 0.5;

  void describe(OptionsVisitor& visitor) override;
};

/** All options of the merger. */
struct RunMergerConfig
{
  RunMergerOptions merge;
  LoopCloserOptions loops;
  FactorGraphOptions solver;
  MemoryLimit memory;  //!< of points and descriptors of the keyframes, like KeyframeStore's
};

/** A loop between two runs; `from` and `to` count each run's keyframes from 0. */
struct RunLoop
{
  std::size_t run_from = 0;  //!< the run that was joined before
  std::size_t run_to = 0;
  Loop loop;
  bool left_out = false;  //!< contradicts the rest of the graph
  double residual = 0;    //!< translation between measurement and merged poses [m]
};

/** Why a run is not joined. */
struct JoinEvidence
{
  std::size_t loops = 0;       //!< found by appearance to the joined runs, agreeing or not
  std::size_t needed = 0;      //!< that agree
  bool placed = false;         //!< enough agreed, but the rest of the path contradicted them:
  std::size_t tried = 0;       //!< keyframes near those of joined runs
  std::size_t confirmed = 0;   //!< of these, by a registration
  double min_confirmed = 0;    //!< least fraction of these
  std::size_t consistent = 0;  //!< loops near one another that the graph does not leave out
};

/** Result of a merge. */
struct RunMerge
{
  /** T_map_vehicle of every keyframe of every run, in the first run's map frame; empty for a run
   * that shares no place with the others. */
  std::vector<std::vector<Pose>> poses;
  std::vector<JoinEvidence> evidence;  //!< of every run
  /** Accepted ones between joined runs. */
  std::vector<RunLoop> loops;
  OptimisationResult optimisation;

  [[nodiscard]] bool joined(std::size_t run) const { return !poses[run].empty(); }
};

/** Places several runs in one map: loops between them are found by appearance, verified as
 * LoopCloser does, confirmed along the whole path, and solved in one factor graph with the odometry
 * and the loops of each run.
 *
 * A run is joined to those joined before, in the order of evidence, so that runs which meet the
 * first one only through others (a chain) are joined too. Deterministic; not thread-safe. Of
 * points and descriptors, about 40 kB a keyframe, those beyond `memory` are on disk; the result
 * does not depend on it.
 */
class RunMerger
{
 public:
  explicit RunMerger(const RunMergerConfig& config);
  ~RunMerger();
  RunMerger(RunMerger&&) noexcept;
  RunMerger& operator=(RunMerger&&) noexcept;

  /** Begins the next run. \param graph whose ego poses, odometry and loops are taken, but for loops
   * that it leaves out
   * \throws std::invalid_argument unless the keyframes are numbered 0, 1, 2, ... and the run before
   * has got the points of all of its keyframes. */
  void addRun(const FactorGraph& graph);
  /** Points of the run's next keyframe. \param static_points vehicle frame [m]; empty where they
   * are not known. \throws std::invalid_argument if the run has no further keyframe. */
  void addKeyframe(const std::vector<Eigen::Vector3f>& static_points);

  /** \pre at least one run, with the points of all keyframes */
  [[nodiscard]] RunMerge merge();

 private:
  struct State;
  std::unique_ptr<State> state_;
};
}  // namespace dyslam
