// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/FactorGraph.h>
#include <dyslam/core/KeyframeStore.h>
#include <dyslam/core/Pose.h>

#include <cstddef>
#include <map>
#include <vector>

#include "MapLocaliser.h"

namespace dyslam
{
class StateArchive;

/** The localisations of a run in its factor graph, in stretches: the first one begins when the run
 * is localised, a further one each time it was lost and found again.
 *
 * The odometry since the last stretch may lead elsewhere than to the new one, further than drift
 * explains. If the odometry since an earlier stretch does lead there, those in between were at a
 * wrong place, and their localisations are removed; so are weak ones since the last stretch. Then
 * the sigmas of the odometry before the new stretch are multiplied so that it explains what it was
 * wrong by: else the robust loss would leave the new stretch out. */
class LocalisedStretches
{
 public:
  using FactorIds = std::vector<FactorGraph::FactorId>;

  /** \param keyframes, graph outlive this; the graph has the prior map once there are fixes */
  LocalisedStretches(const KeyframeStore& keyframes, FactorGraph& graph)
      : keyframes_(keyframes), graph_(graph)
  {
  }

  /** Begins a stretch; the fixes are added by add(). \param fixes its first ones, one of which is
   * not weak \return localisations that are removed from the graph */
  FactorIds begin(const std::vector<MapFix>& fixes);
  /** Adds the factors of fixes of the newest stretch. \pre a stretch was begun */
  FactorIds add(const std::vector<MapFix>& fixes);

  /** Number of keyframes whose localisation is in the graph. */
  [[nodiscard]] std::size_t localisations() const { return square_errors_.size(); }
  /** RMS of the residuals of these [m]; 0 if there are none. */
  [[nodiscard]] double rmse() const;

  void exchangeState(StateArchive& archive);

 private:
  struct Stretch
  {
    std::size_t first = 0;   //!< keyframe of the first fix
    std::size_t strong = 0;  //!< keyframe of the first fix that is not weak
    MapFix last;             //!< the newest fix that is not weak
    /** Distance of fix `strong` from where the odometry since the stretch before leads [m]. */
    double jump = 0;
    /** Factor on the odometry's covariances from the stretch before to fix `strong`. */
    double odometry_scale = 1;
  };
  /** What the odometry between two keyframes lacks to agree with their fixes. */
  struct Error
  {
    double distance = 0;     //!< [m]
    bool is_drift = false;   //!< as usual drift explains it
    double mahalanobis = 0;  //!< squared, by the odometry's covariance; 6 is expected
  };

  [[nodiscard]] FactorGraph::FactorId odometryTo(std::size_t keyframe) const;
  [[nodiscard]] Error errorBetween(const MapFix& older, const MapFix& newer) const;
  /** Multiplies the covariances of the odometry between two keyframes. */
  void scaleOdometry(std::size_t from, std::size_t to, double factor);
  /** Forgets the stretches from number `begin` on; the odometry before them has its own covariances
   * again. \pre begin > 0 */
  void forgetFrom(std::size_t begin);
  /** Removes the localisations of keyframes from number `first` on. */
  FactorIds removeLocalisations(std::size_t first);

  const KeyframeStore& keyframes_;
  FactorGraph& graph_;
  std::vector<Stretch> stretches_;
  /** Squared RMSE of the localisations in the graph, by keyframe [m^2]. */
  std::map<std::size_t, double> square_errors_;
};
}  // namespace dyslam
