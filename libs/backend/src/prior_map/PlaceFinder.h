// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/PriorMapOptions.h>
#include <dyslam/core/KeyframeStore.h>
#include <dyslam/core/Pose.h>

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "PlaceSearch.h"
#include "PriorMap.h"
#include "loops/LoopVerification.h"

namespace dyslam
{
/** The pose of a keyframe in the prior map, or why there is none. */
struct FoundPlace
{
  std::optional<Pose> T_prior_vehicle;
  LoopVerdict verdict = LoopVerdict::dissimilar;
};

/** Finds a keyframe in the prior map by a submap: the static points of the path to it, registered
 * to the map where they look alike from above. Deterministic; not thread-safe. */
class PlaceFinder
{
 public:
  /** \param map not empty when a place is searched for; it and `keyframes` outlive this */
  PlaceFinder(const PriorMapOptions& options, PriorMap& map, const KeyframeStore& keyframes)
      : options_(options), map_(map), keyframes_(keyframes)
  {
  }

  /** The place near an estimate, whose height, roll and pitch do not matter, and whose heading is
   * right to within 45 degrees. \param radius largest error of its position, horizontally [m] */
  [[nodiscard]] FoundPlace findNear(const Pose& T_prior_vehicle,
                                    double radius,
                                    std::size_t keyframe);
  /** The place in an area, at any heading, if only one fits. \param area none: the whole map */
  [[nodiscard]] FoundPlace findWithin(const std::optional<SearchArea>& area, std::size_t keyframe);

 private:
  /** Static points on the path to a keyframe, in its frame without tilt. */
  [[nodiscard]] std::vector<Eigen::Vector3f> submapTo(std::size_t keyframe) const;
  /** The registrations that fit, at places that look alike. \param of_most_similar verdict on the
   * first one that does not fit */
  [[nodiscard]] std::vector<KeyframeRegistrationResult> fittingPlaces(
      const std::vector<Eigen::Vector3f>& submap,
      const std::optional<SearchArea>& area,
      LoopVerdict& of_most_similar);
  /** The pose of a keyframe whose submap was registered. */
  [[nodiscard]] FoundPlace found(const KeyframeRegistrationResult& registration,
                                 std::size_t keyframe) const;

  PriorMapOptions options_;
  PriorMap& map_;
  const KeyframeStore& keyframes_;
  std::optional<PlaceSearch> search_;  //!< made when it is first needed
};
}  // namespace dyslam
