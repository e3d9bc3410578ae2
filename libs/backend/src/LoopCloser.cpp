// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/LoopCloser.h>
#include <dyslam/core/VoxelGrid.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <utility>

#include "KeyframeRegistration.h"
#include "PolarDescriptor.h"

namespace dyslam
{
namespace
{
constexpr float quantum = 0.004F;               // of stored coordinates [m]
constexpr double correlation_range = 5;         // around the guess [m]
constexpr double correlation_heading = 0.1;     // nearly a sector of the descriptor [rad]
constexpr double agreement_translation = 0.75;  // between loops that support each other [m]
constexpr double agreement_rotation = 0.06;     // [rad]
constexpr std::size_t shortlist = 12;           // compared in full per keyframe
using StoredPoint = std::array<std::int16_t, 3>;

struct Stored
{
  double path_length = 0;
  std::vector<StoredPoint> points;
  PolarDescriptor descriptor;
};

std::vector<StoredPoint> pack(const std::vector<Eigen::Vector3f>& points)
{
  std::vector<StoredPoint> packed;
  packed.reserve(points.size());
  for (const Eigen::Vector3f& p : points)
  {
    const Eigen::Vector3f scaled = p / quantum;
    if (scaled.allFinite() && scaled.cwiseAbs().maxCoeff() < 32767)
    {
      packed.push_back({static_cast<std::int16_t>(std::lround(scaled.x())),
                        static_cast<std::int16_t>(std::lround(scaled.y())),
                        static_cast<std::int16_t>(std::lround(scaled.z()))});
    }
  }
  return packed;
}

void unpackInto(const std::vector<StoredPoint>& packed,
                const Pose& T_target_source,
                std::vector<Eigen::Vector3f>& target)
{
  const Eigen::Isometry3f T = T_target_source.cast<float>();
  for (const StoredPoint& p : packed)
  {
    const Eigen::Vector3f q(p[0], p[1], p[2]);
    target.emplace_back(T * Eigen::Vector3f(quantum * q));
  }
}

struct Candidate
{
  std::size_t id = 0;
  double ring_difference = 0;
  PolarDescriptor::Match match;
};

struct Pending
{
  Loop loop;
  int support = 0;
};
}  // namespace

struct LoopCloser::State
{
  explicit State(const LoopCloserOptions& given) : options(given) { validate(options, "loop"); }

  /** How far the estimate of a keyframe `path` metres back may be off [m]. */
  [[nodiscard]] double radiusAfter(double path) const
  {
    return std::min(options.max_search_radius,
                    options.search_radius + options.drift_per_metre * path);
  }

  [[nodiscard]] std::vector<Candidate> candidatesFor(const std::vector<Pose>& poses) const;
  [[nodiscard]] Loop verify(const Candidate& candidate,
                            const std::vector<Pose>& poses,
                            const std::vector<Eigen::Vector3f>& source) const;
  [[nodiscard]] RegistrationTarget submapAround(std::size_t id,
                                                const std::vector<Pose>& poses) const;
  [[nodiscard]] LoopVerdict judge(const Loop& loop,
                                  const KeyframeRegistrationResult& registration,
                                  const Pose& T_from_to_estimate) const;
  void findSupport(const Loop& loop, const std::vector<Pose>& poses);
  [[nodiscard]] std::vector<Loop> decidePending(std::size_t newest);

  LoopCloserOptions options;
  std::vector<Stored> keyframes;
  std::vector<Pending> pending;
};

std::vector<Candidate> LoopCloser::State::candidatesFor(const std::vector<Pose>& poses) const
{
  const std::size_t newest = keyframes.size() - 1;
  const Stored& now = keyframes[newest];
  std::vector<Candidate> near;
  for (std::size_t i = 0; i < newest; ++i)
  {
    const double path = now.path_length - keyframes[i].path_length;
    if (path < options.min_path)
    {
      break;
    }
    const double distance = (poses[i].translation() - poses[newest].translation()).norm();
    if (distance < radiusAfter(path))
    {
      near.push_back({i, keyframes[i].descriptor.ringDifference(now.descriptor), {}});
    }
  }
  const auto keep = std::min(near.size(), shortlist);
  std::partial_sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(keep), near.end(),
                    [](const Candidate& a, const Candidate& b) {
                      return std::make_pair(a.ring_difference, a.id) <
                             std::make_pair(b.ring_difference, b.id);
                    });
  near.resize(keep);
  for (Candidate& candidate : near)
  {
    candidate.match = keyframes[candidate.id].descriptor.match(now.descriptor);
  }
  std::sort(
      near.begin(), near.end(),
      [](const Candidate& a, const Candidate& b)
      { return std::make_pair(a.match.distance, a.id) < std::make_pair(b.match.distance, b.id); });
  near.resize(std::min(near.size(), static_cast<std::size_t>(options.candidates)));
  return near;
}

RegistrationTarget LoopCloser::State::submapAround(std::size_t id,
                                                   const std::vector<Pose>& poses) const
{
  const auto reach = static_cast<std::size_t>(options.submap_keyframes);
  const std::size_t first = id > reach ? id - reach : 0;
  const std::size_t last = std::min(id + reach, keyframes.size() - 1);
  std::vector<Eigen::Vector3f> points;
  for (std::size_t i = first; i <= last; ++i)
  {
    unpackInto(keyframes[i].points, poses[id].inverse() * poses[i], points);
  }
  return RegistrationTarget(voxelDownsample(points, options.voxel_size, VoxelPick::centroid).points,
                            {});
}

LoopVerdict LoopCloser::State::judge(const Loop& loop,
                                     const KeyframeRegistrationResult& registration,
                                     const Pose& T_from_to_estimate) const
{
  if (!registration.converged)
  {
    return LoopVerdict::not_converged;
  }
  if (registration.overlap < options.min_overlap)
  {
    return LoopVerdict::no_overlap;
  }
  if (registration.rmse > options.max_rmse)
  {
    return LoopVerdict::bad_fit;
  }
  if (registration.observability < options.min_observability)
  {
    return LoopVerdict::degenerate;
  }
  const Pose correction = T_from_to_estimate.inverse() * loop.T_from_to;
  const double path = keyframes[loop.to].path_length - keyframes[loop.from].path_length;
  if (correction.translation().norm() > radiusAfter(path) ||
      rotationAngle(correction) > options.max_correction_angle)
  {
    return LoopVerdict::inconsistent;
  }
  return LoopVerdict::accepted;
}

Loop LoopCloser::State::verify(const Candidate& candidate,
                               const std::vector<Pose>& poses,
                               const std::vector<Eigen::Vector3f>& source) const
{
  Loop loop;
  loop.from = candidate.id;
  loop.to = keyframes.size() - 1;
  loop.descriptor_distance = candidate.match.distance;
  const Pose estimate = poses[loop.from].inverse() * poses[loop.to];
  loop.T_from_to = estimate;
  if (candidate.match.distance > options.max_descriptor_distance)
  {
    loop.verdict = LoopVerdict::appearance;
    return loop;
  }
  RegistrationTarget target = submapAround(candidate.id, poses);
  const Pose turned = poseFromYpr(0, 0, 0, candidate.match.heading, 0, 0);
  const Pose guess =
      correlateFromAbove(source, target.points(), turned, correlation_range, correlation_heading)
          .value_or(turned);
  KeyframeRegistrationResult registration = target.align(source, guess);
  if (!registration.converged || registration.overlap < options.min_overlap)
  {
    const Pose second = correlateFromAbove(source, target.points(), estimate, correlation_range,
                                           correlation_heading)
                            .value_or(estimate);
    const KeyframeRegistrationResult other = target.align(source, second);
    if (other.converged && other.overlap > registration.overlap)
    {
      registration = other;
    }
  }
  loop.T_from_to = registration.T_target_source;
  loop.information = registration.information;
  loop.overlap = registration.overlap;
  loop.rmse = registration.rmse;
  loop.verdict = judge(loop, registration, estimate);
  return loop;
}

void LoopCloser::State::findSupport(const Loop& loop, const std::vector<Pose>& poses)
{
  Pending added{loop, 0};
  const auto window = static_cast<std::size_t>(options.support_window);
  for (Pending& other : pending)
  {
    const std::size_t older = std::max(other.loop.from, loop.from);
    const std::size_t gap = older - std::min(other.loop.from, loop.from);
    if (gap > window || loop.to - other.loop.to > window || other.loop.to == loop.to)
    {
      continue;
    }
    // The way round both loops over two short pieces of odometry must end where it began.
    const Pose from_to_from = poses[loop.from].inverse() * poses[other.loop.from];
    const Pose to_to_to = poses[other.loop.to].inverse() * poses[loop.to];
    const Pose misfit = loop.T_from_to.inverse() * from_to_from * other.loop.T_from_to * to_to_to;
    if (misfit.translation().norm() < agreement_translation &&
        rotationAngle(misfit) < agreement_rotation)
    {
      ++other.support;
      ++added.support;
    }
  }
  pending.push_back(added);
}

std::vector<Loop> LoopCloser::State::decidePending(std::size_t newest)
{
  // Accepted loops stay for a while as witnesses; `support` is then negative.
  constexpr int decided = -1000000;
  std::vector<Loop> result;
  std::vector<Pending> left;
  for (Pending& entry : pending)
  {
    if (entry.support >= options.min_support)
    {
      result.push_back(entry.loop);
      entry.support = decided;
    }
    if (newest - entry.loop.to < static_cast<std::size_t>(options.support_window))
    {
      left.push_back(entry);
    }
    else if (entry.support >= 0)
    {
      entry.loop.verdict = LoopVerdict::unsupported;
      result.push_back(entry.loop);
    }
  }
  pending = std::move(left);
  return result;
}

std::string toString(LoopVerdict verdict)
{
  switch (verdict)
  {
    case LoopVerdict::accepted:
      return "accepted";
    case LoopVerdict::appearance:
      return "appearance";
    case LoopVerdict::not_converged:
      return "not_converged";
    case LoopVerdict::no_overlap:
      return "no_overlap";
    case LoopVerdict::bad_fit:
      return "bad_fit";
    case LoopVerdict::degenerate:
      return "degenerate";
    case LoopVerdict::inconsistent:
      return "inconsistent";
    case LoopVerdict::unsupported:
      return "unsupported";
  }
  return "unknown";
}

void LoopCloserOptions::describe(OptionsVisitor& visitor)
{
  visitor.real("min_path", min_path, 1, 1e5, "driven between the two keyframes, at least [m]");
  visitor.real("search_radius", search_radius, 0, 1000, "around the newest keyframe [m]");
  visitor.real("drift_per_metre", drift_per_metre, 0, 1, "growth of the radius per metre driven");
  visitor.real("max_search_radius", max_search_radius, 0, 10000, "[m]");
  visitor.degrees("max_correction_angle_deg", max_correction_angle, 0, 180,
                  "a loop may turn the estimate by this");
  visitor.integer("interval", interval, 1, 1000, "look for loops at every n-th keyframe");
  visitor.integer("candidates", candidates, 0, 100, "registered per keyframe, at most");
  visitor.real("max_descriptor_distance", max_descriptor_distance, 0, 1,
               "0 same appearance, 1 nothing in common");
  visitor.real("descriptor_range", descriptor_range, 5, 130, "points that appearance uses [m]");
  visitor.integer("submap_keyframes", submap_keyframes, 0, 50, "neighbours on each side merged");
  visitor.real("voxel_size", voxel_size, 0.05, 5, "of the clouds that are registered [m]");
  visitor.real("min_overlap", min_overlap, 0, 1,
               "fraction of points over the ground that meet others");
  visitor.real("max_rmse", max_rmse, 0, 10, "of their point-to-plane distances [m]");
  visitor.real("min_observability", min_observability, 0, 1,
               "weakest against strongest direction of translation");
  visitor.integer("min_support", min_support, 0, 100, "loops of nearby keyframes that must agree");
  visitor.integer("support_window", support_window, 1, 1000, "nearby, in keyframes");
}

LoopCloser::LoopCloser(const LoopCloserOptions& options) : state_(std::make_unique<State>(options))
{
}
LoopCloser::~LoopCloser() = default;
LoopCloser::LoopCloser(LoopCloser&&) noexcept = default;
LoopCloser& LoopCloser::operator=(LoopCloser&&) noexcept = default;

void LoopCloser::add(const LoopKeyframe& keyframe)
{
  if (keyframe.id != state_->keyframes.size())
  {
    throw std::invalid_argument("LoopCloser::add: keyframe " + std::to_string(keyframe.id) +
                                " where " + std::to_string(state_->keyframes.size()) + " is next");
  }
  const auto sampled =
      voxelDownsample(keyframe.points, state_->options.voxel_size, VoxelPick::centroid);
  state_->keyframes.push_back({keyframe.path_length, pack(sampled.points),
                               PolarDescriptor(keyframe.points, state_->options.descriptor_range)});
}

std::vector<Loop> LoopCloser::search(const std::vector<Pose>& T_map_keyframe)
{
  State& s = *state_;
  if (T_map_keyframe.size() != s.keyframes.size())
  {
    throw std::invalid_argument("LoopCloser::search: one pose per keyframe is needed");
  }
  if (s.keyframes.empty())
  {
    return {};
  }
  std::vector<Loop> result;
  const std::size_t newest = s.keyframes.size() - 1;
  if (newest % static_cast<std::size_t>(s.options.interval) == 0)
  {
    std::vector<Eigen::Vector3f> source;
    unpackInto(s.keyframes[newest].points, Pose::Identity(), source);
    for (const Candidate& candidate : s.candidatesFor(T_map_keyframe))
    {
      const Loop loop = s.verify(candidate, T_map_keyframe, source);
      if (loop.verdict == LoopVerdict::accepted)
      {
        // One loop per keyframe is enough.
        s.findSupport(loop, T_map_keyframe);
        break;
      }
      result.push_back(loop);
    }
  }
  for (Loop& loop : s.decidePending(newest))
  {
    result.push_back(std::move(loop));
  }
  return result;
}

std::vector<Loop> LoopCloser::finish()
{
  std::vector<Loop> result;
  for (Pending& entry : state_->pending)
  {
    if (entry.support >= 0)
    {
      entry.loop.verdict = LoopVerdict::unsupported;
      result.push_back(entry.loop);
    }
  }
  state_->pending.clear();
  return result;
}
}  // namespace dyslam
