// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Options.h>
#include <dyslam/core/Pose.h>

#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace dyslam
{
struct LoopCloserOptions : Options
{
  double min_path = 30;           //!< distance driven between the two keyframes, at least [m]
  double search_radius = 5;       //!< around the newest keyframe, before any drift [m]
  double drift_per_metre = 0.02;  //!< growth of the search radius per metre driven in between
  double max_search_radius = 50;  //!< [m]
  int candidates = 3;             //!< registered per keyframe, at most
  int interval = 1;               //!< look for loops at every n-th keyframe
  double max_descriptor_distance = 0.35;  //!< 0 same appearance, 1 nothing in common
  int submap_keyframes = 2;  //!< neighbours on each side merged into the older keyframe's cloud
  double voxel_size = 0.4;   //!< of the clouds that are registered [m]
  double max_range = 60;     //!< points used, from the vehicle [m]
  double min_overlap = 0.6;  //!< fraction of points with a counterpart
  double max_rmse = 0.25;    //!< of the point-to-plane distances [m]
  double min_information_ratio = 0.01;  //!< weakest against strongest direction of translation
  double max_correction = 4;  //!< loop against odometry, in standard deviations of the search
  int min_support = 1;        //!< neighbouring keyframes whose loops must agree, 0 for none

  void describe(OptionsVisitor& visitor) override;
};

/** A keyframe as the loop closer keeps it. */
struct LoopKeyframe
{
  std::size_t id = 0;
  double path_length = 0;               //!< driven since the start [m]
  std::vector<Eigen::Vector3f> points;  //!< vehicle frame [m], downsampled by the caller
};

enum class LoopVerdict
{
  accepted,
  appearance,  //!< the two places do not look alike
  no_overlap,  //!< registered, but too few points meet
  bad_fit,     //!< registered, but the surfaces do not coincide
  degenerate,  //!< the geometry leaves a direction open
  not_converged,
  inconsistent,  //!< too far from where odometry could have gone
  unsupported,   //!< no neighbouring keyframe saw the same loop
};
[[nodiscard]] std::string toString(LoopVerdict verdict);

/** One loop candidate that was looked at. */
struct Loop
{
  std::size_t from = 0;  //!< the older keyframe
  std::size_t to = 0;    //!< the newer one
  Pose T_from_to = Pose::Identity();
  Matrix6 information = Matrix6::Identity();  //!< over the tangent of T_from_to
  double descriptor_distance = 0;
  double overlap = 0;
  double rmse = 0;  //!< [m]
  LoopVerdict verdict = LoopVerdict::accepted;
};

/** Finds places seen before: candidates by distance and appearance, verified by registration.
 *
 * Deterministic. Memory grows with the keyframes' clouds; time per keyframe is bounded by the
 * number of candidates. Not thread-safe.
 */
class LoopCloser
{
 public:
  explicit LoopCloser(const LoopCloserOptions& options);
  ~LoopCloser();
  LoopCloser(LoopCloser&&) noexcept;
  LoopCloser& operator=(LoopCloser&&) noexcept;

  /** Keep a keyframe; ids are 0, 1, 2, ... \throws std::invalid_argument for another id. */
  void add(LoopKeyframe keyframe);

  /** Loops from the newest keyframe to older ones.
   * \param T_map_keyframe present estimate of every keyframe added so far. */
  [[nodiscard]] std::vector<Loop> search(const std::vector<Pose>& T_map_keyframe);

 private:
  struct State;
  std::unique_ptr<State> state_;
};
}  // namespace dyslam
