// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/FactorGraph.h>
#include <dyslam/backend/LoopCloser.h>
#include <dyslam/base/Options.h>
#include <dyslam/base/SwapFile.h>
#include <dyslam/core/Georeference.h>
#include <dyslam/core/Gravity.h>
#include <dyslam/core/Pose.h>

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
struct RunMergerOptions : Options
{
  /** Least fraction of the keyframes near those of other runs that registrations confirm; rejects a
   * street that looks like another one. */
  double min_confirmed = 0.5;
  bool gnss = true;        //!< use the satellite positions of the runs
  bool gravity = true;     //!< use the verticals of the runs
  bool level_map = false;  //!< rotate the merged map so that its z axis is vertical

  void describe(OptionsVisitor& visitor) override;
};

/** All options of the merger. */
struct RunMergerConfig
{
  RunMergerOptions merge;
  LoopCloserOptions loops;  //!< whatever `appearance` is: nothing else shows where runs meet
  FactorGraphOptions solver;
  MemoryLimit memory;  //!< limit for points and descriptors of the keyframes, like KeyframeStore's
};

/** What a run found about its map, as far as it did. */
struct RunReferences
{
  std::optional<Georeference> georeference;
  std::optional<Gravity> gravity;
  /** Name of the frame of the run's map. Runs with the same name are in one frame: localised in one
   * prior map, or one of them in the map of the other. Empty: in a frame of its own. */
  std::string map_frame;
};

/** A loop between two runs; `from` and `to` count each run's keyframes from 0. */
struct RunLoop
{
  std::size_t run_from = 0;  //!< number of the run that was joined before
  std::size_t run_to = 0;
  Loop loop;
  bool left_out = false;  //!< left out because it contradicts the rest of the graph
  double residual = 0;    //!< translation between the measurement and the merged poses [m]
};

/** Satellite positions by which the place of a run, as the loops give it, is a wrong one. */
struct GnssContradiction
{
  std::size_t run = 0;   //!< the joined run whose satellite positions contradict those of the run
  double distance = 0;   //!< horizontal distance of the run's place by loops from that by GNSS [m]
  double tolerated = 0;  //!< distance that the accuracies explain [m]
};

/** Evidence for and against joining a run. */
struct JoinEvidence
{
  std::size_t loops = 0;       //!< number of loops to joined runs found by appearance
  std::size_t needed = 0;      //!< number of loops that have to agree
  bool placed = false;         //!< enough loops agreed, but the rest of the path contradicted them
  std::size_t tried = 0;       //!< number of keyframes near those of joined runs
  std::size_t confirmed = 0;   //!< number of tried keyframes confirmed by a registration
  double min_confirmed = 0;    //!< least fraction of tried keyframes that have to be confirmed
  std::size_t consistent = 0;  //!< number of nearby loops that the graph does not leave out
  /** Why loops that agree did not join the run. */
  std::optional<GnssContradiction> contradiction;
  /** Least horizontal distance from the joined runs by satellite positions [m], of a run that is
   * not joined; nothing if one of the two sides has none. */
  std::optional<double> distance;
};

/** How the references of a run fit the merged map. */
struct ReferenceFit
{
  std::size_t positions = 0;   //!< number of satellite positions; 0: none
  double horizontal_rmse = 0;  //!< horizontal RMSE of the positions against the merged poses [m]
  double vertical_rmse = 0;    //!< vertical RMSE of the positions against the merged poses [m]
  std::size_t directions = 0;  //!< number of measured directions of gravity
  std::optional<double> up_error;  //!< angle between the verticals of run and merged map [rad]
  double up_sigma = 0;             //!< sigma of the vertical by the run [rad]
};

/** Result of a merge. */
struct RunMerge
{
  /** T_map_vehicle of every keyframe of every run, in the first run's map frame, which is rotated
   * to the merged vertical if it was levelled or RunMergerOptions::level_map is set; empty for a
   * run that shares no place with the others. */
  std::vector<std::vector<Pose>> poses;
  std::vector<JoinEvidence> evidence;  //!< one entry per run
  std::vector<ReferenceFit> fits;      //!< one entry per run
  /** Pose of the merged map on the earth, if a joined run has one. Its origin is that of the first
   * such run. */
  std::optional<Georeference> georeference;
  /** The vertical in the merged map, if a joined run has it; `bias` has no meaning. */
  std::optional<Gravity> gravity;
  /** Accepted loops between joined runs. */
  std::vector<RunLoop> loops;
  OptimisationResult optimisation;

  [[nodiscard]] bool joined(std::size_t run) const { return !poses[run].empty(); }
};

/** Places several runs in one map: loops between them are found by appearance, verified as
 * LoopCloser does, confirmed along the whole path, and solved in one factor graph with the odometry
 * and the loops of each run. Satellite positions and verticals of the runs take part in it: as
 * factors of the run's graph if that was optimised with them, else as one of the map as a whole.
 * Between two runs with satellite positions, loops are first searched among keyframes that these
 * place near each other, and loops that contradict them do not join a run.
 *
 * Runs in one frame (RunReferences::map_frame) are joined as they are unless registrations
 * contradict it, also if they have no place in common; runs keep their localisations in a prior
 * map.
 *
 * A run is joined to those joined before, in the order of evidence, so that runs which meet the
 * first one only through others (a chain) are joined too. Deterministic; not thread-safe. Points
 * and descriptors, about 40 kB a keyframe, are on disk beyond the limit `memory`; the result does
 * not depend on it.
 */
class RunMerger
{
 public:
  /** \throws UserError for options that are out of range, also LoopCloserOptions::by_appearance. */
  explicit RunMerger(const RunMergerConfig& config);
  ~RunMerger();
  RunMerger(RunMerger&&) noexcept;
  RunMerger& operator=(RunMerger&&) noexcept;

  /** Begins the next run. \param graph factor graph of the run; its ego poses, odometry, used
   * loops and localisations are copied, and its satellite positions and gravity for which there are
   * `references` \throws std::invalid_argument unless the keyframes are numbered 0, 1, 2, ... and
   * all keyframes of the previous run have their points. */
  void addRun(const FactorGraph& graph, const RunReferences& references = {});
  /** Adds the points of the run's next keyframe. \param static_points vehicle frame [m]; empty if
   * unknown \throws std::invalid_argument if the run has no further keyframe. */
  void addKeyframe(const std::vector<Eigen::Vector3f>& static_points);

  /** Merges the runs. \pre at least one run, with the points of all keyframes */
  [[nodiscard]] RunMerge merge();

 private:
  struct State;
  std::unique_ptr<State> state_;
};
}  // namespace dyslam
