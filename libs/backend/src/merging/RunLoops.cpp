// SPDX-License-Identifier: BSD-3-Clause
#include "RunLoops.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "loops/LoopAgreement.h"

namespace dyslam
{
namespace
{
constexpr double agreement_distance = 2;   // largest error of a cycle of two loops [m]
constexpr double agreement_angle = 0.1;    // largest error of a cycle of two loops [rad]
constexpr double angle_per_metre = 0.002;  // growth of agreement_angle with the path [rad/m]

LoopCloserOptions withoutPoints(LoopCloserOptions options)
{
  options.appearance = false;  // views are stored in RunLoops
  return options;
}

/** Distance [m] and number of the keyframe of `range` nearest to keyframe `k`. \param farthest
 * keyframes beyond this distance need not be found [m] \return an infinite distance if there is
 * none */
std::pair<double, std::size_t> nearestTo(std::size_t k,
                                         const KeyframeRange& range,
                                         double farthest,
                                         const KeyframeStore& keyframes)
{
  constexpr double rounding = 1e-6;  // of a distance, relative and in metres
  const Eigen::Vector3d at = keyframes[k].T_map_vehicle.translation();
  std::pair<double, std::size_t> nearest(std::numeric_limits<double>::infinity(), 0);
  for (std::size_t i = range.begin; i < range.end; ++i)
  {
    // Whole poses are slow to invert and multiply: only for those that may be the nearest.
    const double limit = (1 + rounding) * std::min(nearest.first, farthest) + rounding;
    if ((keyframes[i].T_map_vehicle.translation() - at).squaredNorm() <= limit * limit)
    {
      nearest = std::min(nearest, {poseBetween(keyframes, i, k).translation().norm(), i});
    }
  }
  return nearest;
}

void takeAccepted(std::vector<Loop>&& decided, std::vector<Loop>& accepted)
{
  for (Loop& loop : decided)
  {
    if (loop.verdict == LoopVerdict::accepted)
    {
      accepted.push_back(std::move(loop));
    }
  }
}
}  // namespace

RunLoops::RunLoops(const LoopCloserOptions& options, KeyframeStore& keyframes)
    : options_(options),
      keyframes_(keyframes),
      candidates_(withoutPoints(options), keyframes.memory().part(descriptor_share)),
      views_(keyframes.memory().part(descriptor_share))
{
}

void RunLoops::add(const std::vector<Eigen::Vector3f>& static_points)
{
  keyframes_.setLoopCloud(candidates_.size(), loopCloudOf(static_points, options_));
  candidates_.add(static_points);
  (void)views_.add(PlaceViews(static_points, options_.descriptor_range));
}

Loop RunLoops::verify(const LoopCandidate& candidate,
                      std::size_t keyframe,
                      const KeyframeRange& older,
                      bool by_appearance) const
{
  Loop loop;
  loop.from = candidate.id;
  loop.to = keyframe;
  loop.by_appearance = by_appearance;
  loop.descriptor_distance = candidate.descriptor_distance;
  RegistrationTarget target = submapAround(keyframes_, candidate.id, older, options_);
  const KeyframeRegistrationResult registration =
      registerFrom(target, keyframes_.loopCloud(keyframe).unpacked().points, candidate.T_from_to);
  fillFrom(registration, loop);
  loop.verdict = verifyRegistration(registration, options_.criteria(by_appearance));
  return loop;
}

SimilarLoops RunLoops::byAppearance(const KeyframeRange& older,
                                    const KeyframeRange& newer,
                                    const NearKeyframes& near)
{
  const int support = options_.by_appearance.min_support;
  LoopAgreement agreement(support, support, options_.support_window);
  SimilarLoops result;
  for (std::size_t k = newer.begin; k < newer.end; k += static_cast<std::size_t>(options_.interval))
  {
    std::vector<Loop> fitting;
    for (const LoopCandidate& candidate : candidates_.byAppearance(
             keyframes_, views_.get(k),
             [&](std::size_t i) { return older.contains(i) && (!near || near(i, k)); }))
    {
      const Loop loop = verify(candidate, k, older, true);
      if (loop.verdict == LoopVerdict::accepted &&
          tiltOf(loop.T_from_to) <= options_.max_correction_angle)
      {
        fitting.push_back(loop);
      }
    }
    // If several places fit, none is accepted. Those near each other may be one place.
    const bool are_one =
        near && std::all_of(fitting.begin(), fitting.end(),
                            [&](const Loop& loop) { return agree(fitting.front(), loop); });
    if (fitting.size() == 1 || (are_one && !fitting.empty()))
    {
      agreement.add(fitting.front(), keyframes_);
      ++result.fitting;
    }
    takeAccepted(agreement.decide(k), result.accepted);
  }
  takeAccepted(agreement.finish(), result.accepted);
  return result;
}

NearLoops RunLoops::byPosition(const KeyframeRange& older,
                               const KeyframeRange& newer,
                               const std::vector<double>& reach)
{
  const int support = options_.nearby.min_support;
  LoopAgreement agreement(support, support, options_.support_window);
  NearLoops result;
  std::vector<bool> tried(newer.end - newer.begin, false);
  for (std::size_t k = newer.begin; k < newer.end; k += static_cast<std::size_t>(options_.interval))
  {
    const double farthest = reach[k - newer.begin];
    const auto [distance, near] = nearestTo(k, older, farthest, keyframes_);
    // Keyframes without points, for example of a missing scan, confirm nothing.
    if (distance < farthest && keyframes_.loopCloud(k).size() > 0)
    {
      LoopCandidate candidate;
      candidate.id = near;
      candidate.T_from_to = poseBetween(keyframes_, near, k);
      const Loop loop = verify(candidate, k, older, false);
      const Pose correction = candidate.T_from_to.inverse() * loop.T_from_to;
      tried[k - newer.begin] = distance < options_.search_radius;
      if (loop.verdict == LoopVerdict::accepted && correction.translation().norm() <= farthest &&
          rotationAngle(correction) <= options_.max_correction_angle)
      {
        agreement.add(loop, keyframes_);
      }
    }
    takeAccepted(agreement.decide(k), result.accepted);
  }
  takeAccepted(agreement.finish(), result.accepted);
  for (const Loop& loop : result.accepted)
  {
    result.confirmed += tried[loop.to - newer.begin] ? 1 : 0;
  }
  result.tried = static_cast<std::size_t>(std::count(tried.begin(), tried.end(), true));
  return result;
}

bool RunLoops::agree(const Loop& a, const Loop& b) const
{
  const Pose error = cycleError(a, b, keyframes_);
  const auto path = [this](std::size_t i, std::size_t j)
  { return std::abs(keyframes_[i].path_length - keyframes_[j].path_length); };
  const double driven = path(a.from, b.from) + path(a.to, b.to);
  return error.translation().norm() < agreement_distance + options_.drift_per_metre * driven &&
         rotationAngle(error) < agreement_angle + angle_per_metre * driven;
}
}  // namespace dyslam
