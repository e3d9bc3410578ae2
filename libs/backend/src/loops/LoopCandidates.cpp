// SPDX-License-Identifier: BSD-3-Clause
#include "LoopCandidates.h"

#include <dyslam/base/Bytes.h>
#include <dyslam/base/StateArchive.h>

#include <algorithm>
#include <utility>

namespace dyslam
{
namespace
{
// Fully compared descriptors, at least as many as LoopCriteria::candidates.
constexpr std::size_t near_shortlist = 12;   // per keyframe
constexpr std::size_t alike_shortlist = 16;  // per viewpoint
/** Lateral offsets of the viewpoints from which a place may have been seen (other lanes) [m]. */
constexpr float viewpoints[] = {0, 2, -2, 4, -4};

/** PolarDescriptor::ringDifference() up to a factor, vectorised, for ranking. */
float difference(const PolarDescriptor::RingMeans& a, const PolarDescriptor::RingMeans& b)
{
  using Rings = Eigen::Map<const Eigen::Array<float, PolarDescriptor::rings, 1>>;
  return (Rings(a.data()) - Rings(b.data())).abs().sum();
}

/** Whether the path between two keyframes is long enough for a loop, or partly unmeasured. */
bool areApart(const LoopCloserOptions& options, const PathBetween& path)
{
  return path.measured >= options.min_path || path.unseen > 0;
}

bool isMoreSimilar(const LoopCandidate& a, const LoopCandidate& b)
{
  return std::make_pair(a.descriptor_distance, a.id) < std::make_pair(b.descriptor_distance, b.id);
}
}  // namespace

PathBetween pathBetween(const Keyframe& older, const Keyframe& newer)
{
  return {newer.path_length - older.path_length, newer.unseen_path - older.unseen_path};
}

double searchRadius(const LoopCloserOptions& options, const PathBetween& path)
{
  return std::min(options.max_search_radius,
                  options.search_radius + options.drift_per_metre * path.measured + path.unseen);
}

PlaceViews::PlaceViews(const std::vector<Eigen::Vector3f>& points, double range)
{
  for (const float y : viewpoints)
  {
    views.push_back({static_cast<double>(y), PolarDescriptor(points, range, {0, y})});
  }
}

std::string PlaceViews::toBytes() const
{
  std::string bytes;
  for (const View& view : views)
  {
    appendBytes(bytes, view.y);
    bytes += view.descriptor.toBytes();
  }
  return bytes;
}

PlaceViews PlaceViews::fromBytes(std::string_view bytes)
{
  PlaceViews result;
  const std::size_t size = PolarDescriptor().toBytes().size();
  while (!bytes.empty())
  {
    View view;
    takeBytes(bytes, view.y);
    view.descriptor = PolarDescriptor::fromBytes(bytes);
    bytes.remove_prefix(size);
    result.views.push_back(view);
  }
  return result;
}

void LoopCandidates::add(const std::vector<Eigen::Vector3f>& points)
{
  const PolarDescriptor descriptor(points, options_.descriptor_range);
  ring_means_.push_back(descriptor.ringMeans());
  descriptors_.add(descriptor);
  if (options_.appearance)
  {
    points_ = points;
  }
}

void LoopCandidates::shortlist(std::vector<Ranked>& ranked, std::size_t limit)
{
  const auto keep = static_cast<std::ptrdiff_t>(std::min(ranked.size(), limit));
  std::partial_sort(
      ranked.begin(), ranked.begin() + keep, ranked.end(),
      [](const Ranked& a, const Ranked& b)
      { return std::make_pair(a.difference, a.id) < std::make_pair(b.difference, b.id); });
  ranked.resize(static_cast<std::size_t>(keep));
}

std::vector<LoopCandidate> LoopCandidates::byPosition(const KeyframeStore& keyframes) const
{
  const std::size_t newest = descriptors_.size() - 1;
  const Keyframe& now = keyframes[newest];
  std::vector<Ranked> ranked;
  for (std::size_t i = 0; i < newest; ++i)
  {
    const PathBetween path = pathBetween(keyframes[i], now);
    if (!areApart(options_, path))
    {
      break;
    }
    const double distance =
        (keyframes[i].T_map_vehicle.translation() - now.T_map_vehicle.translation()).norm();
    if (distance < searchRadius(options_, path))
    {
      ranked.push_back({i, PolarDescriptor::ringDifference(ring_means_[i], ring_means_[newest])});
    }
  }
  const auto most = static_cast<std::size_t>(options_.nearby.candidates);
  shortlist(ranked, std::max(near_shortlist, most));
  const PolarDescriptor::Columns ours = descriptors_.get(newest).columns();
  std::vector<LoopCandidate> candidates;
  for (const Ranked& one : ranked)
  {
    const auto match = PolarDescriptor::match(descriptors_.get(one.id).columns(), ours);
    candidates.push_back({one.id, match.distance, poseFromYpr(0, 0, 0, match.heading, 0, 0)});
  }
  std::sort(candidates.begin(), candidates.end(), isMoreSimilar);
  candidates.resize(std::min(candidates.size(), most));
  return candidates;
}

void LoopCandidates::addAlike(const PlaceViews::View& view,
                              const std::vector<std::size_t>& eligible,
                              std::vector<LoopCandidate>& found) const
{
  std::vector<Ranked> ranked;
  for (const std::size_t i : eligible)
  {
    ranked.push_back(
        {i, static_cast<double>(difference(ring_means_[i], view.descriptor.ringMeans()))});
  }
  const auto most = static_cast<std::size_t>(options_.by_appearance.candidates);
  shortlist(ranked, std::max(alike_shortlist, most));
  const PolarDescriptor::Columns ours = view.descriptor.columns();
  for (const Ranked& one : ranked)
  {
    const auto match = PolarDescriptor::match(descriptors_.get(one.id).columns(), ours);
    if (match.distance <= options_.by_appearance.max_descriptor_distance)
    {
      // The heading holds for the viewpoint; the vehicle is beside it.
      found.push_back(
          {one.id, match.distance,
           poseFromYpr(0, 0, 0, match.heading, 0, 0) * poseFromYpr(0, -view.y, 0, 0, 0, 0)});
    }
  }
}

std::vector<LoopCandidate> LoopCandidates::byAppearance(const KeyframeStore& keyframes) const
{
  const std::size_t newest = descriptors_.size() - 1;
  const Keyframe& now = keyframes[newest];
  const auto isEligible = [&](std::size_t i)
  {
    const PathBetween path = pathBetween(keyframes[i], now);
    return areApart(options_, path) &&
           (keyframes[i].T_map_vehicle.translation() - now.T_map_vehicle.translation()).norm() >=
               searchRadius(options_, path);
  };
  for (std::size_t i = 0; i < newest; ++i)
  {
    if (isEligible(i))  // otherwise the views, which cost milliseconds, are not needed
    {
      return byAppearance(keyframes, PlaceViews(points_, options_.descriptor_range), isEligible);
    }
  }
  return {};
}

std::vector<LoopCandidate> LoopCandidates::byAppearance(
    const KeyframeStore& keyframes,
    const PlaceViews& now,
    const std::function<bool(std::size_t)>& is_eligible) const
{
  std::vector<std::size_t> eligible;
  for (std::size_t i = 0; i < descriptors_.size(); ++i)
  {
    if (is_eligible(i))
    {
      eligible.push_back(i);
    }
  }
  std::vector<LoopCandidate> found;
  for (const PlaceViews::View& view : now.views)
  {
    addAlike(view, eligible, found);
  }
  std::sort(found.begin(), found.end(), isMoreSimilar);
  const auto distance = [&](const LoopCandidate& a, const LoopCandidate& b)
  {
    return (keyframes[a.id].T_map_vehicle.translation() -
            keyframes[b.id].T_map_vehicle.translation())
        .norm();
  };
  std::vector<LoopCandidate> places;
  for (const LoopCandidate& one : found)
  {
    const bool is_new = std::none_of(places.begin(), places.end(),
                                     [&](const LoopCandidate& place)
                                     { return distance(place, one) < options_.place_distance; });
    if (is_new && places.size() < static_cast<std::size_t>(options_.by_appearance.candidates))
    {
      places.push_back(one);
    }
  }
  return places;
}

void LoopCandidates::exchangeState(StateArchive& archive)
{
  archive(points_, descriptors_, ring_means_);
}
}  // namespace dyslam
