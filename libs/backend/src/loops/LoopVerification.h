// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/LoopCloser.h>
#include <dyslam/core/KeyframeStore.h>

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "KeyframeRegistration.h"

namespace dyslam
{
/** Keyframes [begin, end) of a store. */
struct KeyframeRange
{
  std::size_t begin = 0;
  std::size_t end = 0;

  [[nodiscard]] bool contains(std::size_t keyframe) const
  {
    return keyframe >= begin && keyframe < end;
  }
};

/** Points of a keyframe to be stored for loop closure. \param static_points vehicle frame [m] */
[[nodiscard]] PackedCloud loopCloudOf(const std::vector<Eigen::Vector3f>& static_points,
                                      const LoopCloserOptions& options);

/** Registration target around keyframe `id`, in its vehicle frame: points of it and of neighbours
 * within `range` that no unmeasured path separates from it. */
[[nodiscard]] RegistrationTarget submapAround(const KeyframeStore& keyframes,
                                              std::size_t id,
                                              const KeyframeRange& range,
                                              const LoopCloserOptions& options);

/** Registers a keyframe's points, starting at the best alignment seen from above within 5 m of the
 * initial pose. */
[[nodiscard]] KeyframeRegistrationResult registerFrom(RegistrationTarget& target,
                                                      const std::vector<Eigen::Vector3f>& source,
                                                      const Pose& T_target_source_initial);

/** `accepted`, or the criterion that the registration does not meet. */
[[nodiscard]] LoopVerdict verifyRegistration(const KeyframeRegistrationResult& registration,
                                             const LoopCriteria& criteria);

/** Copies the registration's result into the loop. */
void fillFrom(const KeyframeRegistrationResult& registration, Loop& loop);

/** Angle between the z axes of two frames [rad]. */
[[nodiscard]] double tiltOf(const Pose& T);
}  // namespace dyslam
