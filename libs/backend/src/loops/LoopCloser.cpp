// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/LoopCloser.h>
#include <dyslam/base/Error.h>
#include <dyslam/base/StateArchive.h>

#include <stdexcept>
#include <utility>

#include "LoopAgreement.h"
#include "LoopCandidates.h"
#include "LoopVerification.h"

namespace dyslam
{
struct LoopCloser::State
{
  State(const LoopCloserOptions& given, KeyframeStore& store)
      : options(given),
        keyframes(store),
        candidates(given, store.memory().part(descriptor_share)),
        agreement(given.nearby.min_support, given.by_appearance.min_support, given.support_window)
  {
    options.requireValid();
  }

  [[nodiscard]] bool searchNear(const std::vector<Eigen::Vector3f>& source,
                                std::vector<Loop>& rejected);
  void searchByAppearance(const std::vector<Eigen::Vector3f>& source, std::vector<Loop>& rejected);
  [[nodiscard]] Loop verify(const LoopCandidate& candidate,
                            const std::vector<Eigen::Vector3f>& source,
                            bool by_appearance) const;
  [[nodiscard]] LoopVerdict judge(const Loop& loop,
                                  const KeyframeRegistrationResult& registration,
                                  const Pose& T_from_to_estimate) const;

  LoopCloserOptions options;
  KeyframeStore& keyframes;
  LoopCandidates candidates;
  LoopAgreement agreement;
};

LoopVerdict LoopCloser::State::judge(const Loop& loop,
                                     const KeyframeRegistrationResult& registration,
                                     const Pose& T_from_to_estimate) const
{
  const bool alike = loop.by_appearance;
  const LoopVerdict fit = verifyRegistration(registration, options.criteria(alike));
  if (fit != LoopVerdict::accepted)
  {
    return fit;
  }
  const Pose correction = T_from_to_estimate.inverse() * loop.T_from_to;
  const PathBetween path = pathBetween(keyframes[loop.from], keyframes[loop.to]);
  const double farthest =
      alike ? options.search_radius + options.appearance_drift * path.measured + path.unseen
            : searchRadius(options, path);
  const bool knows_heading = !alike && path.unseen == 0;
  const double turn = knows_heading ? rotationAngle(correction) : tiltOf(correction);
  if (correction.translation().norm() > farthest || turn > options.max_correction_angle)
  {
    return LoopVerdict::inconsistent;
  }
  return LoopVerdict::accepted;
}

Loop LoopCloser::State::verify(const LoopCandidate& candidate,
                               const std::vector<Eigen::Vector3f>& source,
                               bool by_appearance) const
{
  Loop loop;
  loop.from = candidate.id;
  loop.to = keyframes.size() - 1;
  loop.by_appearance = by_appearance;
  loop.descriptor_distance = candidate.descriptor_distance;
  const Pose estimate = poseBetween(keyframes, loop.from, loop.to);
  loop.T_from_to = estimate;
  const LoopCriteria& criteria = options.criteria(by_appearance);
  if (candidate.descriptor_distance > criteria.max_descriptor_distance)
  {
    loop.verdict = LoopVerdict::dissimilar;
    return loop;
  }
  // Excludes the newest keyframe, which would be registered to itself.
  RegistrationTarget target = submapAround(keyframes, candidate.id, {0, loop.to}, options);
  KeyframeRegistrationResult registration = registerFrom(target, source, candidate.T_from_to);
  if (!by_appearance && (!registration.converged || registration.overlap < criteria.min_overlap))
  {
    const KeyframeRegistrationResult other = registerFrom(target, source, estimate);
    if (other.converged && other.overlap > registration.overlap)
    {
      registration = other;
    }
  }
  fillFrom(registration, loop);
  loop.verdict = judge(loop, registration, estimate);
  return loop;
}

/** \return whether a loop was found: one per keyframe is enough */
bool LoopCloser::State::searchNear(const std::vector<Eigen::Vector3f>& source,
                                   std::vector<Loop>& rejected)
{
  for (const LoopCandidate& candidate : candidates.byPosition(keyframes))
  {
    const Loop loop = verify(candidate, source, false);
    if (loop.verdict == LoopVerdict::accepted)
    {
      agreement.add(loop, keyframes);
      return true;
    }
    rejected.push_back(loop);
  }
  return false;
}

/** If the newest keyframe fits several places, as in streets that look alike, none is accepted. */
void LoopCloser::State::searchByAppearance(const std::vector<Eigen::Vector3f>& source,
                                           std::vector<Loop>& rejected)
{
  std::vector<Loop> fitting;
  for (const LoopCandidate& candidate : candidates.byAppearance(keyframes))
  {
    const Loop loop = verify(candidate, source, true);
    const bool fits =
        loop.verdict == LoopVerdict::accepted || loop.verdict == LoopVerdict::inconsistent;
    (fits ? fitting : rejected).push_back(loop);
  }
  for (Loop& loop : fitting)
  {
    if (fitting.size() == 1 && loop.verdict == LoopVerdict::accepted)
    {
      agreement.add(loop, keyframes);
      continue;
    }
    loop.verdict = fitting.size() > 1 ? LoopVerdict::ambiguous : loop.verdict;
    rejected.push_back(loop);
  }
}

std::string toString(LoopVerdict verdict)
{
  switch (verdict)
  {
    case LoopVerdict::accepted:
      return "accepted";
    case LoopVerdict::dissimilar:
      return "dissimilar";
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
    case LoopVerdict::ambiguous:
      return "ambiguous";
    case LoopVerdict::unsupported:
      return "unsupported";
  }
  return "unknown";
}

void LoopCriteria::describe(OptionsVisitor& visitor)
{
  visitor.integer("candidates", candidates, 0, 100,
                  "most candidates that are registered per keyframe");
  visitor.real("max_descriptor_distance", max_descriptor_distance, 0, 1,
               "largest descriptor distance of a candidate, from 0 (equal) to 1");
  visitor.real("min_overlap", min_overlap, 0, 1,
               "least fraction of points above ground with a correspondence");
  visitor.real("max_rmse", max_rmse, 0, 10, "largest RMSE of the point-to-plane residuals [m]");
  visitor.real("min_observability", min_observability, 0, 1,
               "least ratio of the weakest to the strongest direction of translation");
  visitor.integer("min_support", min_support, 0, 100,
                  "least number of loops of nearby keyframes that agree");
}

LoopCloserOptions::LoopCloserOptions()
{
  by_appearance.max_descriptor_distance = 0.3;
  by_appearance.min_overlap = 0.75;
  by_appearance.max_rmse = 0.15;
  by_appearance.min_observability = 0.05;
  by_appearance.min_support = 3;
}

void LoopCloserOptions::requireValid() const
{
  validate(*this, "loop");
  if (search_radius > max_search_radius)
  {
    throw UserError("[loop] search_radius is above its upper limit, max_search_radius; change one");
  }
  const auto require_enough = [this](const LoopCriteria& criteria, const char* key)
  {
    // One loop per searched keyframe, before and after.
    if (2 * (support_window / interval) < criteria.min_support)
    {
      const int needed = interval * ((criteria.min_support + 1) / 2);
      throw UserError("[loop] " + std::string(key) + " = " + std::to_string(criteria.min_support) +
                      " cannot be reached with interval = " + std::to_string(interval) +
                      " and support_window = " + std::to_string(support_window) +
                      "; set support_window = " + std::to_string(needed) +
                      " or lower interval or " + key);
    }
  };
  require_enough(nearby, "min_support");
  if (appearance)
  {
    require_enough(by_appearance, "appearance_min_support");
  }
}

void LoopCloserOptions::describe(OptionsVisitor& visitor)
{
  visitor.real("min_path", min_path, 1, 1e5,
               "least distance travelled between the two keyframes of a loop [m]");
  visitor.real("search_radius", search_radius, 0, 1000,
               "radius of the search for loops around the newest keyframe, without drift [m]");
  visitor.real("drift_per_metre", drift_per_metre, 0, 1,
               "growth of the search radius per distance travelled since the older keyframe [m/m]");
  visitor.real("max_search_radius", max_search_radius, 0, 10000,
               "upper limit of the search radius with drift [m]");
  visitor.degrees("max_correction_angle_deg", max_correction_angle, 0, 180,
                  "largest rotation of the estimate by a loop (by appearance: tilt) [deg]");
  visitor.integer(
      "interval", interval, 1, 1000,
      "interval between keyframes that search for loops; 1: every keyframe [keyframes]");
  visitor.real("descriptor_range", descriptor_range, 5, 130,
               "largest range of the points in the appearance descriptor [m]");
  visitor.integer(
      "submap_keyframes", submap_keyframes, 0, 50,
      "keyframes on each side of a loop's older keyframe that are merged into its submap");
  visitor.real("voxel_size", voxel_size, 0.05, 5,
               "voxel size of the clouds that are registered [m]");
  visitor.integer(
      "support_window", support_window, 1, 1000,
      "number of keyframes that count as nearby for min_support and appearance_min_support");
  PrefixedVisitor within(visitor, "", "loops within the search radius");
  nearby.describe(within);
  visitor.flag("appearance", appearance,
               "search for loops beyond the search radius, by appearance alone");
  PrefixedVisitor beyond(visitor, "appearance_", "loops by appearance");
  by_appearance.describe(beyond);
  beyond.renamed("descriptor_distance", "max_descriptor_distance");
  beyond.renamed("overlap", "min_overlap");
  beyond.renamed("rmse", "max_rmse");
  beyond.renamed("observability", "min_observability");
  beyond.renamed("support", "min_support");
  visitor.real("appearance_drift", appearance_drift, 0, 10,
               "largest drift of the odometry that a loop by appearance corrects, per distance "
               "travelled [m/m]");
  visitor.real("place_distance", place_distance, 0, 1000,
               "distance beyond which candidates by appearance count as different places [m]");
}

LoopCloser::LoopCloser(const LoopCloserOptions& options, KeyframeStore& keyframes)
    : state_(std::make_unique<State>(options, keyframes))
{
}
LoopCloser::~LoopCloser() = default;
LoopCloser::LoopCloser(LoopCloser&&) noexcept = default;
LoopCloser& LoopCloser::operator=(LoopCloser&&) noexcept = default;

void LoopCloser::add(const std::vector<Eigen::Vector3f>& static_points)
{
  State& s = *state_;
  const std::size_t next = s.candidates.size();
  if (s.keyframes.size() != next + 1)
  {
    throw std::invalid_argument("LoopCloser: keyframe " + std::to_string(next) +
                                " is next, but there are " + std::to_string(s.keyframes.size()));
  }
  s.keyframes.setLoopCloud(next, loopCloudOf(static_points, s.options));
  s.candidates.add(static_points);
}

std::vector<Loop> LoopCloser::search()
{
  State& s = *state_;
  if (s.candidates.size() == 0)
  {
    return {};
  }
  std::vector<Loop> result;
  const std::size_t newest = s.candidates.size() - 1;
  if (newest % static_cast<std::size_t>(s.options.interval) == 0)
  {
    const std::vector<Eigen::Vector3f> source = s.keyframes.loopCloud(newest).unpacked().points;
    if (!s.searchNear(source, result) && s.options.appearance)
    {
      s.searchByAppearance(source, result);
    }
  }
  for (Loop& loop : s.agreement.decide(newest))
  {
    result.push_back(std::move(loop));
  }
  return result;
}

std::vector<Loop> LoopCloser::finish()
{
  return state_->agreement.finish();
}

void LoopCloser::exchangeState(StateArchive& archive)
{
  archive(state_->candidates, state_->agreement);
}
}  // namespace dyslam
