// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/PriorMapOptions.h>
#include <dyslam/core/KeyframeStore.h>
#include <dyslam/core/Pose.h>
#include <dyslam/core/PriorMapFit.h>

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "PlaceFinder.h"
#include "PlaceSearch.h"
#include "PriorMap.h"

namespace dyslam
{
class StateArchive;

/** A keyframe registered to the prior map. */
struct MapFix
{
  std::size_t keyframe = 0;
  Pose T_prior_vehicle = Pose::Identity();
  Matrix6 information = Matrix6::Identity();  //!< over T_prior_vehicle's tangent
  double rmse = 0;                            //!< of the point-to-plane residuals [m]
  /** The surfaces hardly constrain one direction, of which there is no information then. */
  bool is_weak = false;
};

/** Keyframes that were registered to the prior map now. */
struct MapFixes
{
  std::vector<MapFix> fixes;  //!< in order of the keyframes
  /** Pose of the run's map frame in the prior map, if these fixes localise the run. */
  std::optional<Pose> T_prior_map;
  /** The run was localised before, then lost; a search found the place of these fixes. */
  bool is_found_again = false;
};

/** Largest expected error of the position of a keyframe by the odometry from another one [m]: 3 %
 * of the path in between, and what was not measured of it, at most 30 m. */
[[nodiscard]] double driftRadius(const KeyframeStore& keyframes, std::size_t a, std::size_t b);
/** Largest error of the heading of a keyframe by the odometry from another one [rad]. */
constexpr double drift_heading = 0.1;

/** Localises the keyframes of a run in a static map of an earlier one.
 *
 * The place is searched for in the whole map, or around a given start, until a submap of the newest
 * keyframes fits one place alone; the run is localised when further keyframes on some metres of
 * path fit the map where the odometry predicts them. From then on keyframes are registered to the
 * map, starting at their pose in the graph. After a path without a fix, several must agree again.
 * If keyframes do not fit for long, or the drift may be larger than what a registration corrects,
 * the place is searched for again, as far around as the odometry may be wrong.
 *
 * Uses the points for loop closure of the KeyframeStore. Deterministic; not thread-safe. */
class MapLocaliser
{
 public:
  /** \param map points of the prior map, z about vertical [m]; none: nothing is localised
   * \param keyframes outlives this \throws UserError for a `start` that is no pose. */
  MapLocaliser(const PriorMapOptions& options,
               const std::vector<Eigen::Vector3f>& map,
               const KeyframeStore& keyframes);

  MapLocaliser(const MapLocaliser&) = delete;
  MapLocaliser& operator=(const MapLocaliser&) = delete;

  /** Registers the newest keyframe, whose points are in the store.
   * \return fixes that count from now on; if they localise the run, the caller has moved the
   * keyframes to the frame of the prior map before the next call. */
  [[nodiscard]] MapFixes add();

  [[nodiscard]] bool hasMap() const { return !map_.empty(); }
  /** What the localiser knows: `registered` counts all fixes, also those that LocalisedStretches
   * has removed, and there is no RMSE. */
  [[nodiscard]] PriorMapFit fit() const;

  void exchangeState(StateArchive& archive);

 private:
  /** Whether there was enough path since the last search for the place. */
  [[nodiscard]] bool isSearchDue(std::size_t newest) const;
  /** Whether a run that was localised may be elsewhere than registrations can find out. */
  [[nodiscard]] bool isLost(std::size_t newest) const;
  /** Where a run that was localised may be by the odometry since the last fix. */
  [[nodiscard]] SearchArea areaOf(std::size_t newest) const;
  /** Pose of the newest keyframe in the prior map, without an estimate of it. */
  [[nodiscard]] std::optional<Pose> findPlace(std::size_t newest);
  /** Registers a keyframe near an estimate. \param radius largest error of its position [m] */
  [[nodiscard]] std::optional<MapFix> registerKeyframe(std::size_t keyframe,
                                                       const Pose& T_prior_vehicle,
                                                       double radius);
  /** Registers keyframes before those fixes that localised the run, backwards, and puts their fixes
   * first. \param first no keyframe before this one */
  void registerEarlier(std::vector<MapFix>& fixes, std::size_t first);
  /** Pose of the frame of the keyframes in the prior map, by the newest pending fix. */
  [[nodiscard]] Pose T_prior_map() const;
  /** The newest keyframe, registered where it is expected or where it was found. */
  [[nodiscard]] std::optional<MapFix> fixNewest();
  /** The newest keyframe, registered where a search finds it. */
  [[nodiscard]] std::optional<MapFix> fixByPlace(std::size_t newest);
  /** The pending fixes, which count from now on. */
  [[nodiscard]] MapFixes release();
  /** Whether a fix of this keyframe counts at once, as the last one is not far. */
  [[nodiscard]] bool isTrusted(std::size_t newest) const;
  /** Whether the pending fixes agree over enough path. */
  [[nodiscard]] bool agreeEnough() const;
  /** Counts fixes in `fit_`. \return these */
  [[nodiscard]] MapFixes counted(std::vector<MapFix> fixes);

  PriorMapOptions options_;
  std::optional<Pose> start_;  //!< T_prior_vehicle of the first keyframe, roughly
  PriorMap map_;
  const KeyframeStore& keyframes_;
  PlaceFinder places_;

  PriorMapFit fit_;
  std::optional<double> searched_;  //!< path at the last search for the place [m]
  /** Fixes that others must agree with before they count; if the run is not localised yet or was
   * lost, the first one is the place that was found. */
  std::vector<MapFix> pending_;
  bool is_place_again_ = false;  //!< pending_ begins with a place found after the run was lost
  /** Path at the first keyframe within the map that did not fit, since the last fix [m]. */
  std::optional<double> unfit_since_;
  int misses_ = 0;                       //!< keyframes that did not fit since the last pending fix
  std::optional<std::size_t> last_fix_;  //!< keyframe of the last fix that counts
};
}  // namespace dyslam
