// SPDX-License-Identifier: BSD-3-Clause
#include "PlaceFinder.h"

#include <dyslam/base/Angle.h>
#include <dyslam/core/VoxelGrid.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "MapRegistration.h"
#include "loops/LoopCandidates.h"

namespace dyslam
{
namespace
{
constexpr double submap_path = 20;    // path of the submap that the place is searched by [m]
constexpr double submap_voxel = 0.5;  // voxel size of this submap [m]
constexpr double start_heading = 45 * radians_per_degree;  // largest error of a given heading
constexpr double place_radius = 3;  // largest error of a place that looks alike [m]
constexpr double place_heading = 4 * radians_per_degree;
constexpr double apart = 4;                                // distance of different places [m]
constexpr double apart_heading = 45 * radians_per_degree;  // of different headings at one place
constexpr double clear_lead = 0.1;  // overlap by which the best of several places must lead
constexpr double least_observability_of_place = 0.02;
constexpr double ground_range = 10;  // range of the points among which the ground is found [m]

/** The pose without roll and pitch. */
Pose upright(const Pose& T)
{
  Pose result = Pose::Identity();
  result.translation() = T.translation();
  result.linear() =
      Eigen::AngleAxisd(yawPitchRoll(T).x(), Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return result;
}

/** Height of the ground below the origin of a submap [m]. */
double groundBelow(const std::vector<Eigen::Vector3f>& submap)
{
  const std::vector<Eigen::Vector3f> near = pointsWithin(submap, ground_range);
  return groundAmong(voxelDownsample(near, PriorMap::voxel_size, VoxelPick::centroid).points, 0, 0)
      .value_or(0);
}
}  // namespace

std::vector<Eigen::Vector3f> PlaceFinder::submapTo(std::size_t keyframe) const
{
  const Pose T_upright_map = upright(keyframes_[keyframe].T_map_vehicle).inverse();
  std::vector<Eigen::Vector3f> points;
  for (std::size_t i = keyframe + 1; i-- > 0;)
  {
    const PathBetween path = pathBetween(keyframes_[i], keyframes_[keyframe]);
    if (path.measured > submap_path || path.unseen > 0)
    {
      break;
    }
    const Eigen::Isometry3f T = (T_upright_map * keyframes_[i].T_map_vehicle).cast<float>();
    for (const Eigen::Vector3f& p : keyframes_.loopCloud(i).unpacked().points)
    {
      points.emplace_back(T * p);
    }
  }
  return pointsWithin(voxelDownsample(points, submap_voxel, VoxelPick::centroid).points,
                      options_.range);
}

FoundPlace PlaceFinder::found(const KeyframeRegistrationResult& registration,
                              std::size_t keyframe) const
{
  const Pose& T_map_vehicle = keyframes_[keyframe].T_map_vehicle;
  return {registration.T_target_source * upright(T_map_vehicle).inverse() * T_map_vehicle,
          LoopVerdict::accepted};
}

FoundPlace PlaceFinder::findNear(const Pose& T_prior_vehicle, double radius, std::size_t keyframe)
{
  const std::vector<Eigen::Vector3f> submap = submapTo(keyframe);
  Pose T = upright(T_prior_vehicle);
  RegistrationTarget& target = map_.around(T.translation());
  T = correlateFromAbove(submap, target.points(), T, radius, start_heading).value_or(T);
  if (const auto ground = map_.groundHeight(T.translation().x(), T.translation().y()))
  {
    T.translation().z() = *ground - groundBelow(submap);
  }
  const KeyframeRegistrationResult result = target.align(submap, T);
  const LoopVerdict verdict = verdictOf(result, options_, least_map_observability);
  return verdict == LoopVerdict::accepted ? found(result, keyframe)
                                          : FoundPlace{std::nullopt, verdict};
}

std::vector<KeyframeRegistrationResult> PlaceFinder::fittingPlaces(
    const std::vector<Eigen::Vector3f>& submap,
    const std::optional<SearchArea>& area,
    LoopVerdict& of_most_similar)
{
  if (!search_)
  {
    search_.emplace(map_.points());
  }
  const double ground_below = groundBelow(submap);
  std::vector<KeyframeRegistrationResult> fitting;
  for (const SimilarPlace& place : search_->find(submap, area))
  {
    const auto ground = map_.groundHeight(place.x, place.y);
    if (!ground)
    {
      continue;
    }
    const Pose T = poseFromYpr(place.x, place.y, *ground - ground_below, place.heading, 0, 0);
    RegistrationTarget& target = map_.around(T.translation());
    const KeyframeRegistrationResult result = target.align(
        submap,
        correlateFromAbove(submap, target.points(), T, place_radius, place_heading).value_or(T));
    const LoopVerdict verdict = verdictOf(result, options_, least_observability_of_place);
    if (verdict == LoopVerdict::accepted)
    {
      fitting.push_back(result);
    }
    else if (of_most_similar == LoopVerdict::dissimilar)
    {
      of_most_similar = verdict;
    }
  }
  return fitting;
}

FoundPlace PlaceFinder::findWithin(const std::optional<SearchArea>& area, std::size_t keyframe)
{
  LoopVerdict of_most_similar = LoopVerdict::dissimilar;
  const std::vector<KeyframeRegistrationResult> fitting =
      fittingPlaces(submapTo(keyframe), area, of_most_similar);
  const auto best =
      std::max_element(fitting.begin(), fitting.end(),
                       [](const auto& a, const auto& b) { return a.overlap < b.overlap; });
  if (best == fitting.end())
  {
    return {std::nullopt, of_most_similar};
  }
  const bool is_only = std::all_of(
      fitting.begin(), fitting.end(),
      [&](const KeyframeRegistrationResult& other)
      {
        const Pose between = best->T_target_source.inverse() * other.T_target_source;
        return other.overlap < best->overlap - clear_lead ||
               (between.translation().norm() < apart && rotationAngle(between) < apart_heading);
      });
  return is_only ? found(*best, keyframe) : FoundPlace{std::nullopt, LoopVerdict::ambiguous};
}
}  // namespace dyslam
