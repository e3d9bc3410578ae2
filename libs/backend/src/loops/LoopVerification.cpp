// SPDX-License-Identifier: BSD-3-Clause
#include "LoopVerification.h"

#include <dyslam/core/VoxelGrid.h>

#include <algorithm>
#include <cmath>

namespace dyslam
{
namespace
{
constexpr double range_limit = 131.068;      // limit of stored coordinates: steps of 4 mm [m]
constexpr double correlation_range = 5;      // search around the initial position [m]
constexpr double correlation_heading = 0.1;  // search around the initial heading [rad]

/** Appends the points of a stored cloud, transformed by T. */
void append(const PackedCloud& cloud,
            const Pose& T_target_source,
            std::vector<Eigen::Vector3f>& target)
{
  const Eigen::Isometry3f T = T_target_source.cast<float>();
  for (const Eigen::Vector3f& p : cloud.unpacked().points)
  {
    target.emplace_back(T * p);
  }
}
}  // namespace

PackedCloud loopCloudOf(const std::vector<Eigen::Vector3f>& static_points,
                        const LoopCloserOptions& options)
{
  KeyframeCloud sampled;
  sampled.points = voxelDownsample(static_points, options.voxel_size, VoxelPick::centroid).points;
  return PackedCloud(sampled, range_limit);
}

RegistrationTarget submapAround(const KeyframeStore& keyframes,
                                std::size_t id,
                                const KeyframeRange& range,
                                const LoopCloserOptions& options)
{
  const auto reach = static_cast<std::size_t>(options.submap_keyframes);
  const std::size_t first = id > range.begin + reach ? id - reach : range.begin;
  const std::size_t last = std::min(id + reach, range.end - 1);
  const Pose T_id_map = keyframes[id].T_map_vehicle.inverse();
  std::vector<Eigen::Vector3f> points;
  for (std::size_t i = first; i <= last; ++i)
  {
    // Poses beyond an unmeasured stretch are unreliable.
    if (keyframes[i].unseen_path == keyframes[id].unseen_path)
    {
      append(keyframes.loopCloud(i), T_id_map * keyframes[i].T_map_vehicle, points);
    }
  }
  return RegistrationTarget(voxelDownsample(points, options.voxel_size, VoxelPick::centroid).points,
                            {});
}

KeyframeRegistrationResult registerFrom(RegistrationTarget& target,
                                        const std::vector<Eigen::Vector3f>& source,
                                        const Pose& T_target_source_initial)
{
  return target.align(source, correlateFromAbove(source, target.points(), T_target_source_initial,
                                                 correlation_range, correlation_heading)
                                  .value_or(T_target_source_initial));
}

LoopVerdict verifyRegistration(const KeyframeRegistrationResult& registration,
                               const LoopCriteria& criteria)
{
  if (!registration.converged)
  {
    return LoopVerdict::not_converged;
  }
  if (registration.overlap < criteria.min_overlap)
  {
    return LoopVerdict::no_overlap;
  }
  if (registration.rmse > criteria.max_rmse)
  {
    return LoopVerdict::bad_fit;
  }
  return registration.observability < criteria.min_observability ? LoopVerdict::degenerate
                                                                 : LoopVerdict::accepted;
}

void fillFrom(const KeyframeRegistrationResult& registration, Loop& loop)
{
  loop.T_from_to = registration.T_target_source;
  loop.information = registration.information;
  loop.overlap = registration.overlap;
  loop.rmse = registration.rmse;
}

double tiltOf(const Pose& T)
{
  return std::acos(std::clamp(T.linear()(2, 2), -1.0, 1.0));
}
}  // namespace dyslam
