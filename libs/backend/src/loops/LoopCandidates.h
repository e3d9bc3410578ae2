// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/LoopCloser.h>
#include <dyslam/base/SwappedStore.h>

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "PolarDescriptor.h"

namespace dyslam
{
class StateArchive;

/** Fraction of the memory limit for the descriptors. */
constexpr double descriptor_share = 0.05;

/** Distance travelled between two keyframes of one run. */
struct PathBetween
{
  double measured = 0;  //!< distance by the odometry [m]
  double unseen = 0;    //!< largest unmeasured distance, see Keyframe::unseen_path [m]
};
[[nodiscard]] PathBetween pathBetween(const Keyframe& older, const Keyframe& newer);

/** Largest expected error of the newer keyframe's position in the older one's frame [m]. */
[[nodiscard]] double searchRadius(const LoopCloserOptions& options, const PathBetween& path);

struct LoopCandidate
{
  std::size_t id = 0;  //!< number of the older keyframe
  double descriptor_distance = 1;
  Pose T_from_to = Pose::Identity();  //!< initial guess from the descriptors
};

/** Descriptors of a place from the vehicle and from viewpoints beside it (other lanes). */
struct PlaceViews
{
  PlaceViews() = default;
  /** \param points vehicle frame [m] */
  PlaceViews(const std::vector<Eigen::Vector3f>& points, double range);

  struct View
  {
    double y = 0;  //!< y of the viewpoint, vehicle frame [m]
    PolarDescriptor descriptor;
  };
  std::vector<View> views;

  // Interface for SwappedStore.
  [[nodiscard]] std::size_t memory() const { return views.capacity() * sizeof(View); }
  [[nodiscard]] std::string toBytes() const;
  [[nodiscard]] static PlaceViews fromBytes(std::string_view bytes);
};

/** Descriptors of all keyframes; finds older keyframes that the newest one may revisit. */
class LoopCandidates
{
 public:
  LoopCandidates(const LoopCloserOptions& options, const MemoryLimit& memory)
      : options_(options), descriptors_(memory)
  {
  }

  /** Adds the next keyframe. \param points its static points, vehicle frame [m] */
  void add(const std::vector<Eigen::Vector3f>& points);
  [[nodiscard]] std::size_t size() const { return descriptors_.size(); }

  /** Keyframes within the search radius of the newest one, the most similar first. */
  [[nodiscard]] std::vector<LoopCandidate> byPosition(const KeyframeStore& keyframes) const;
  /** Similar keyframes beyond the search radius, the most similar first, one per place. */
  [[nodiscard]] std::vector<LoopCandidate> byAppearance(const KeyframeStore& keyframes) const;
  /** Eligible keyframes that are similar to the views `now`, the most similar first. */
  [[nodiscard]] std::vector<LoopCandidate> byAppearance(
      const KeyframeStore& keyframes,
      const PlaceViews& now,
      const std::function<bool(std::size_t)>& eligible) const;

  void exchangeState(StateArchive& archive);

 private:
  struct Ranked
  {
    std::size_t id = 0;
    double difference = 0;  //!< difference of the mean heights per ring
  };
  /** Adds the eligible keyframes that are similar to `view`. */
  void addAlike(const PlaceViews::View& view,
                const std::vector<std::size_t>& eligible,
                std::vector<LoopCandidate>& found) const;
  /** The `limit` smallest differences, ascending. */
  static void shortlist(std::vector<Ranked>& ranked, std::size_t limit);

  LoopCloserOptions options_;
  std::vector<Eigen::Vector3f> points_;  //!< newest keyframe's points, if appearance is in use
  SwappedStore<PolarDescriptor> descriptors_;           //!< descriptor of each keyframe
  std::vector<PolarDescriptor::RingMeans> ring_means_;  //!< mean heights of each descriptor
};
}  // namespace dyslam
