// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/LoopCloser.h>
#include <dyslam/core/SwappedStore.h>

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "PolarDescriptor.h"

namespace dyslam
{
class StateArchive;

/** Share of the memory limit for the descriptors. */
constexpr double descriptor_share = 0.05;

/** What was driven from one keyframe to a later one of the same run. */
struct PathBetween
{
  double measured = 0;  //!< [m]
  double unseen = 0;    //!< at most, see Keyframe::unseen_path [m]
};
[[nodiscard]] PathBetween pathBetween(const Keyframe& older, const Keyframe& newer);

/** Largest expected error of the newer keyframe's position in the older one's frame [m]. */
[[nodiscard]] double searchRadius(const LoopCloserOptions& options, const PathBetween& path);

struct LoopCandidate
{
  std::size_t id = 0;  //!< of the older keyframe
  double descriptor_distance = 1;
  Pose T_from_to = Pose::Identity();  //!< as the descriptors suggest
};

/** Descriptors of a place from the vehicle and from viewpoints beside it: another lane. */
struct PlaceViews
{
  PlaceViews() = default;
  /** \param points vehicle frame [m] */
  PlaceViews(const std::vector<Eigen::Vector3f>& points, double range);

  struct View
  {
    double y = 0;  //!< of the viewpoint, vehicle frame [m]
    PolarDescriptor descriptor;
  };
  std::vector<View> views;

  // For SwappedStore.
  [[nodiscard]] std::size_t memory() const { return views.capacity() * sizeof(View); }
  [[nodiscard]] std::string toBytes() const;
  [[nodiscard]] static PlaceViews fromBytes(std::string_view bytes);
};

/** The appearance of all keyframes, and the older keyframes that the newest may revisit. */
class LoopCandidates
{
 public:
  LoopCandidates(const LoopCloserOptions& options, const MemoryLimit& memory)
      : options_(options), descriptors_(memory)
  {
  }

  /** The next keyframe's static points, vehicle frame [m]. */
  void add(const std::vector<Eigen::Vector3f>& points);
  [[nodiscard]] std::size_t size() const { return descriptors_.size(); }

  /** Keyframes near the newest one, the most similar first. */
  [[nodiscard]] std::vector<LoopCandidate> byPosition(const KeyframeStore& keyframes) const;
  /** Keyframes anywhere else of similar appearance, the most similar first, one of each place. */
  [[nodiscard]] std::vector<LoopCandidate> byAppearance(const KeyframeStore& keyframes) const;
  /** The same of any keyframe, among those that are eligible. */
  [[nodiscard]] std::vector<LoopCandidate> byAppearance(
      const KeyframeStore& keyframes,
      const PlaceViews& now,
      const std::function<bool(std::size_t)>& eligible) const;

  void exchangeState(StateArchive& archive);

 private:
  struct Ranked
  {
    std::size_t id = 0;
    double difference = 0;  //!< of the mean heights per ring
  };
  /** Adds the eligible keyframes similar to this view. */
  void addAlike(const PlaceViews::View& view,
                const std::vector<std::size_t>& eligible,
                std::vector<LoopCandidate>& found) const;
  /** The `limit` smallest differences, by rising difference. */
  static void shortlist(std::vector<Ranked>& ranked, std::size_t limit);

  LoopCloserOptions options_;
  std::vector<Eigen::Vector3f> points_;  //!< of the newest keyframe, where appearance is in use
  SwappedStore<PolarDescriptor> descriptors_;           //!< of keyframes
  std::vector<PolarDescriptor::RingMeans> ring_means_;  //!< theirs, side by side in memory
};
}  // namespace dyslam
