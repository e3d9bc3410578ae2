// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/RunMerger.h>
#include <dyslam/core/KeyframeStore.h>

#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "RunAnchor.h"
#include "RunLoops.h"

namespace dyslam
{
struct RunMerger::State
{
  /** A factor between two keyframes of one run, by their numbers in the store. */
  struct Edge
  {
    bool is_loop = false;
    std::size_t from = 0;
    std::size_t to = 0;
    Pose T_from_to = Pose::Identity();
    Matrix6 information = Matrix6::Identity();
  };

  /** A keyframe's pose in the prior map of its run. */
  struct Localisation
  {
    std::size_t keyframe = 0;  //!< number in the store
    Pose T_prior_vehicle = Pose::Identity();
    Matrix6 information = Matrix6::Identity();
  };

  struct Run
  {
    [[nodiscard]] std::size_t middle() const { return (range.begin + range.end) / 2; }
    /** Copies odometry, used loops and localisations of the run's graph. \pre range */
    void takeFactors(const FactorGraph& graph);

    KeyframeRange range;
    std::vector<Edge> edges;
    std::vector<Localisation> localisations;
    Pose T_own_middle = Pose::Identity();  //!< of the middle keyframe in the frame of the run's map
    std::string map_frame;                 //!< see RunReferences; empty: or a wrong one
    std::size_t frame = 0;                 //!< number of the run whose frame it shares, or its own
    RunAnchor anchor;
    bool joined = false;
    JoinEvidence evidence;
  };

  /** Loops by appearance between two runs: each suggests their relative pose. */
  struct Seeds
  {
    std::size_t run_a = 0;
    std::size_t run_b = 0;
    std::vector<Loop> loops;
    std::size_t found = 0;  //!< number of loops found, including those without agreement
    bool nearby = false;    //!< only of keyframes near each other by satellite positions
  };

  /** Loops that agree on the pose of a run, of which the first one places it; or a frame in common
   * with a joined run. */
  struct Placement
  {
    std::size_t run = 0;
    std::vector<Loop> loops;
    /** Pose of the frame of the run's map, if it is that of a joined run; then without loops. */
    std::optional<Pose> T_map_run;
    std::size_t frame = 0;  //!< Run::frame of that joined run
  };

  explicit State(const RunMergerConfig& given)
      : config(given), keyframes(given.memory), finder(given.loops, keyframes)
  {
    validate(config.merge, "merge");
    config.loops.appearance = true;  // its limits must be reachable, too
    config.loops.requireValid();
    validate(config.solver, "solver");
  }

  /** Loops by appearance between two runs. \param nearby only between keyframes near each other by
   * satellite positions, where both runs have them */
  [[nodiscard]] Seeds findSeeds(std::size_t a, std::size_t b, bool nearby);
  /** Fills the seeds of all pairs of runs. */
  void findSeeds();
  /** Fills those of runs that are not joined again, at any distance. \return whether there were
   * any */
  bool findSeedsAnywhere();
  void joinAll();
  /** The first joined run with satellite positions; nothing if there is none. */
  [[nodiscard]] const RunAnchor* firstOnEarth() const;
  /** Whether satellite positions contradict the placement. */
  [[nodiscard]] std::optional<GnssContradiction> contradictionOf(const Placement& placement) const;
  /** Least horizontal distance of the run from joined ones by satellite positions [m]. */
  [[nodiscard]] std::optional<double> distanceOnEarth(std::size_t run) const;
  /** Best supported placement of a run that is not joined yet. */
  [[nodiscard]] Placement bestPlacement() const;
  /** Largest subset of loops between two runs that agree with one of them; that one is first. */
  [[nodiscard]] std::vector<Loop> largestGroup(const std::vector<Loop>& all) const;
  /** Joins a run. \return false, with nothing changed, if the rest of the path contradicts it */
  [[nodiscard]] bool join(const Placement& placement);
  /** Placement of a run that is not joined yet in the frame that it shares with a joined one. */
  [[nodiscard]] std::optional<Placement> placementByFrame() const;
  /** Pose of the frame of a joined run's own map. */
  [[nodiscard]] Pose frameOf(const Run& run) const;
  /** Adds the localisations of the joined runs and the frames of their prior maps. \pre the graph
   * has the keyframes */
  void addLocalisations(FactorGraph& graph) const;
  /** Whether the evidence of the run's path confirms the placement. \param added number of loops to
   * joined runs that were found there */
  [[nodiscard]] bool isConfirmed(const Placement& placement, std::size_t added) const;
  /** Removes the loops of a contradicted placement from the seeds, or forgets the common frame. */
  void refuse(const Placement& placement);
  /** Transforms the keyframes of the run by the common frame or the placement's first loop. */
  void place(const Placement& placement);
  /** Loops from the run to all joined runs, at the present poses. */
  [[nodiscard]] NearLoops loopsAround(const Run& run, const std::vector<Loop>& known) const;
  /** Largest expected error of the poses of the run's keyframes [m]: grows with the path to the
   * nearest known loop; without known loops the poses count as optimised. */
  [[nodiscard]] std::vector<double> reachOf(const Run& run, const std::vector<Loop>& known) const;
  /** Optimises the joined runs with these loops between them; updates the keyframes' poses. */
  void solve();
  [[nodiscard]] std::size_t runOf(std::size_t keyframe) const;
  /** Evidence about a run from the last attempt to join it. */
  [[nodiscard]] JoinEvidence evidenceOf(std::size_t run) const;
  /** Adds satellite positions and verticals of the joined runs. */
  void addReferences(FactorGraph& graph) const;
  /** Adds those of the merged map to a result that has the poses, and levels it. */
  void fillReferences(RunMerge& merge) const;
  [[nodiscard]] Georeference georeferenceOf(const RunMerge& merge) const;
  [[nodiscard]] Gravity gravityOf(const RunMerge& merge) const;
  [[nodiscard]] RunMerge result() const;

  RunMergerConfig config;
  KeyframeStore keyframes;
  mutable RunLoops finder;
  std::vector<Run> runs;
  std::size_t ready = 0;              //!< number of keyframes with points
  std::vector<Seeds> seeds;           //!< one entry per pair of runs
  std::vector<Loop> loops;            //!< loops between joined runs
  std::set<std::size_t> false_loops;  //!< indices of false loops in `loops`
  OptimisationResult optimisation;
  std::optional<Pose> T_enu_map;    //!< of the joined runs, east-north-up of firstOnEarth()
  std::optional<Pose> T_level_map;  //!< of the joined runs
};
}  // namespace dyslam
