// SPDX-License-Identifier: BSD-3-Clause
#include "MapLocaliser.h"

#include <dyslam/base/Angle.h>
#include <dyslam/base/Error.h>
#include <dyslam/base/StateArchive.h>
#include <dyslam/core/VoxelGrid.h>

#include <Eigen/Dense>
#include <algorithm>
#include <utility>

#include "MapRegistration.h"
#include "loops/LoopCandidates.h"

namespace dyslam
{
namespace
{
constexpr double search_distance = 5;  // path between two searches for the place [m]
constexpr double again_distance = 20;  // the same of a run that was localised and then lost [m]
constexpr double again_share = 0.02;   // and at least this share of the path since the last fix

constexpr double least_radius = 0.5;   // largest error of a prediction without drift [m]
constexpr double drift = 0.03;         // growth of this error by the path [m/m]
constexpr double largest_radius = 30;  // largest error that is searched for: the time grows as its
                                       // square [m]
constexpr double direct_radius = 1.5;  // up to this error, no alignment from above is needed [m]
constexpr double largest_turn = 6 * radians_per_degree;  // largest correction by a registration

constexpr double trusted_path = 30;  // path after a fix on which the next one needs no other [m]
constexpr std::size_t least_agreeing = 3;  // fixes that must agree after it, and at the beginning
constexpr double agreeing_path = 4;        // path over which they must agree [m]
constexpr int most_misses = 3;             // keyframes without a fix after which they start anew
constexpr double unfit_path = 20;   // path on which no keyframe fits after which a run is lost [m]
constexpr double lost_drift = 0.3;  // growth of the error of a lost run by the path [m/m]
constexpr double again_path = 10;   // path over which the fixes of a place found again agree [m]
constexpr std::size_t most_earlier = 100;  // keyframes that are registered backwards
constexpr double earlier_radius = 3;       // largest error of their predictions [m]

constexpr double weak_sigma = 1;  // sigma of a direction that is not constrained [m]

/** Error of the position of a keyframe by the odometry from another one [m], if it grows by `rate`
 * metres per metre. */
double errorBetween(const KeyframeStore& keyframes, std::size_t a, std::size_t b, double rate)
{
  const PathBetween path = pathBetween(keyframes[std::min(a, b)], keyframes[std::max(a, b)]);
  return least_radius + rate * path.measured + path.unseen;
}

/** The information without that of the direction of translation that is constrained least. */
Matrix6 withoutWeakest(const Matrix6& information)
{
  const Eigen::Matrix3d of_translation = information.topLeftCorner<3, 3>();
  const Eigen::Vector3d weakest =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(of_translation).eigenvectors().col(0);
  Matrix6 covariance = information.inverse();
  covariance.topLeftCorner<3, 3>() += weak_sigma * weak_sigma * weakest * weakest.transpose();
  const Matrix6 result = covariance.inverse();
  return 0.5 * (result + result.transpose());
}

std::string reasonOf(LoopVerdict verdict)
{
  switch (verdict)
  {
    case LoopVerdict::dissimilar:
      return "no place of the map resembles the scans";
    case LoopVerdict::no_overlap:
      return "too few points have a counterpart in the map";
    case LoopVerdict::degenerate:
      return "the surfaces do not constrain the position in one direction";
    case LoopVerdict::ambiguous:
      return "several places of the map fit equally well";
    case LoopVerdict::unsupported:
      return "the next keyframes did not fit the place that was found";
    default:
      return "the registration to the map does not fit";
  }
}
}  // namespace

double driftRadius(const KeyframeStore& keyframes, std::size_t a, std::size_t b)
{
  return std::min(largest_radius, errorBetween(keyframes, a, b, drift));
}

MapLocaliser::MapLocaliser(const PriorMapOptions& options,
                           const std::vector<Eigen::Vector3f>& map,
                           const KeyframeStore& keyframes)
    : options_(options),
      map_(map, options.range),
      keyframes_(keyframes),
      places_(options, map_, keyframes)
{
  start_ = poseFromText(options_.start);
  if (!start_ && !options_.start.empty())
  {
    throw UserError("prior_map.start '" + options_.start +
                    "': six numbers are needed: x y z [m] yaw pitch roll [deg]");
  }
}

PriorMapFit MapLocaliser::fit() const
{
  PriorMapFit fit = fit_;
  if (!fit.localised && !pending_.empty())
  {
    fit.reason = "the path since a place was found is too short to confirm it";
  }
  return fit;
}

Pose MapLocaliser::T_prior_map() const
{
  if (pending_.empty())
  {
    return Pose::Identity();
  }
  const MapFix& newest = pending_.back();
  return newest.T_prior_vehicle * keyframes_[newest.keyframe].T_map_vehicle.inverse();
}

bool MapLocaliser::isSearchDue(std::size_t newest) const
{
  const double path = keyframes_[newest].path_length;
  const double distance =
      fit_.localised
          ? std::max(again_distance, again_share * (path - keyframes_[*last_fix_].path_length))
          : search_distance;
  return !searched_ || path - *searched_ >= distance;
}

bool MapLocaliser::isLost(std::size_t newest) const
{
  if (!fit_.localised || isTrusted(newest))
  {
    return false;
  }
  const double path = keyframes_[newest].path_length;
  return errorBetween(keyframes_, *last_fix_, newest, drift) > largest_radius ||
         (unfit_since_ && path - *unfit_since_ >= unfit_path);
}

SearchArea MapLocaliser::areaOf(std::size_t newest) const
{
  return {keyframes_[newest].T_map_vehicle.translation().head<2>(),
          errorBetween(keyframes_, *last_fix_, newest, lost_drift)};
}

std::optional<Pose> MapLocaliser::findPlace(std::size_t newest)
{
  searched_ = keyframes_[newest].path_length;
  FoundPlace found;
  if (start_ && !fit_.localised)
  {
    found = places_.findNear(
        *start_ * keyframes_[0].T_map_vehicle.inverse() * keyframes_[newest].T_map_vehicle,
        std::min(largest_radius, options_.start_radius + driftRadius(keyframes_, 0, newest)),
        newest);
  }
  else
  {
    found =
        places_.findWithin(fit_.localised ? std::optional(areaOf(newest)) : std::nullopt, newest);
  }
  if (!fit_.localised)
  {
    // A place that fits is to be confirmed by the next keyframes.
    fit_.reason = reasonOf(found.T_prior_vehicle ? LoopVerdict::unsupported : found.verdict);
  }
  return found.T_prior_vehicle;
}

std::optional<MapFix> MapLocaliser::registerKeyframe(std::size_t keyframe,
                                                     const Pose& T_prior_vehicle,
                                                     double radius)
{
  const std::vector<Eigen::Vector3f> source =
      pointsWithin(keyframes_.loopCloud(keyframe).unpacked().points, options_.range);
  RegistrationTarget& target = map_.around(T_prior_vehicle.translation());
  Pose T = T_prior_vehicle;
  if (radius > direct_radius)
  {
    T = correlateFromAbove(source, target.points(), T, radius, drift_heading).value_or(T);
  }
  const KeyframeRegistrationResult result = target.align(source, T);
  const Pose correction = T_prior_vehicle.inverse() * result.T_target_source;
  if (verdictOf(result, options_, 0) != LoopVerdict::accepted ||
      correction.translation().norm() > radius + least_radius ||
      rotationAngle(correction) > largest_turn)
  {
    return std::nullopt;
  }
  const bool is_weak = result.observability < least_map_observability;
  return MapFix{keyframe, result.T_target_source,
                is_weak ? withoutWeakest(result.information) : result.information, result.rmse,
                is_weak};
}

bool MapLocaliser::isTrusted(std::size_t newest) const
{
  if (!fit_.localised || !last_fix_)
  {
    return false;
  }
  const PathBetween path = pathBetween(keyframes_[*last_fix_], keyframes_[newest]);
  return path.measured < trusted_path && path.unseen == 0;
}

bool MapLocaliser::agreeEnough() const
{
  const PathBetween path =
      pathBetween(keyframes_[pending_.front().keyframe], keyframes_[pending_.back().keyframe]);
  return pending_.size() >= least_agreeing &&
         path.measured >= (is_place_again_ ? again_path : agreeing_path);
}

void MapLocaliser::registerEarlier(std::vector<MapFix>& fixes, std::size_t first)
{
  const auto step = static_cast<std::size_t>(options_.interval);
  const std::size_t newest = fixes.front().keyframe;
  const std::size_t last = std::max(first, newest > most_earlier ? newest - most_earlier : 0);
  std::vector<MapFix> found;
  MapFix next = fixes.front();
  for (std::size_t k = newest; k >= last + step;)
  {
    k -= step;
    const Pose T = next.T_prior_vehicle * keyframes_[next.keyframe].T_map_vehicle.inverse() *
                   keyframes_[k].T_map_vehicle;
    const double radius = driftRadius(keyframes_, k, next.keyframe);
    if (radius > earlier_radius)
    {
      break;
    }
    if (!map_.groundHeight(T.translation().x(), T.translation().y()))
    {
      continue;
    }
    fit_.tried += is_place_again_ ? 0 : 1;  // most of a lost run were tried before
    if (const auto fix = registerKeyframe(k, T, radius))
    {
      next = fix->is_weak ? next : *fix;
      found.push_back(*fix);
    }
  }
  fixes.insert(fixes.begin(), found.rbegin(), found.rend());
}

MapFixes MapLocaliser::counted(std::vector<MapFix> fixes)
{
  fit_.registered += fixes.size();
  fit_.tried = std::max(fit_.tried, fit_.registered);
  return {std::move(fixes), std::nullopt};
}

std::optional<MapFix> MapLocaliser::fixByPlace(std::size_t newest)
{
  const std::optional<Pose> place = findPlace(newest);
  std::optional<MapFix> fix =
      place ? registerKeyframe(newest, *place, least_radius) : std::optional<MapFix>();
  if (fix && fit_.localised)
  {
    if (fix->is_weak)
    {
      return std::nullopt;  // one of a lost run tells nothing
    }
    is_place_again_ = true;
  }
  return fix;
}

std::optional<MapFix> MapLocaliser::fixNewest()
{
  const std::size_t newest = keyframes_.size() - 1;
  if (!fit_.localised && pending_.empty())
  {
    return isSearchDue(newest) ? fixByPlace(newest) : std::nullopt;
  }
  const Pose T = T_prior_map() * keyframes_[newest].T_map_vehicle;
  if (map_.groundHeight(T.translation().x(), T.translation().y()))  // else beyond the prior map
  {
    fit_.tried += fit_.localised ? 1 : 0;
    const std::size_t last = pending_.empty() ? *last_fix_ : pending_.back().keyframe;
    if (const auto fix = registerKeyframe(newest, T, driftRadius(keyframes_, last, newest)))
    {
      return fix;
    }
    unfit_since_ = unfit_since_.value_or(keyframes_[newest].path_length);
  }
  return pending_.empty() && isLost(newest) && isSearchDue(newest) ? fixByPlace(newest)
                                                                   : std::nullopt;
}

MapFixes MapLocaliser::release()
{
  MapFixes result;
  result.fixes = pending_;
  result.is_found_again = is_place_again_;
  fit_.found_again += is_place_again_ ? 1 : 0;
  const std::size_t after_last = last_fix_ ? *last_fix_ + 1 : 0;
  last_fix_ = pending_.back().keyframe;
  if (!fit_.localised)
  {
    result.T_prior_map = T_prior_map();
    fit_.localised = true;
    fit_.reason.clear();
    fit_.keyframe = *last_fix_;
    fit_.path_length = keyframes_[*last_fix_].path_length;
    fit_.tried = pending_.size();
  }
  if (result.T_prior_map || result.is_found_again)
  {
    registerEarlier(result.fixes, after_last);
  }
  pending_.clear();
  is_place_again_ = false;
  result.fixes = counted(std::move(result.fixes)).fixes;
  return result;
}

MapFixes MapLocaliser::add()
{
  const std::size_t newest = keyframes_.size() - 1;
  if (!hasMap() || keyframes_.loopCloud(newest).size() == 0 ||
      newest % static_cast<std::size_t>(options_.interval) != 0)
  {
    return {};
  }
  const std::optional<MapFix> fix = fixNewest();
  if (!fix)
  {
    ++misses_;
    if (misses_ >= most_misses)
    {
      pending_.clear();
      is_place_again_ = false;
    }
    return {};
  }
  misses_ = 0;
  unfit_since_.reset();
  if (fix->is_weak)
  {
    return fit_.localised && !is_place_again_ ? counted({*fix}) : MapFixes();
  }
  pending_.push_back(*fix);
  return isTrusted(newest) || agreeEnough() ? release() : MapFixes();
}

void MapLocaliser::exchangeState(StateArchive& archive)
{
  archive(fit_, searched_, pending_, is_place_again_, unfit_since_, misses_, last_fix_, map_);
}
}  // namespace dyslam
