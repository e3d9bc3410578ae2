// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Angle.h>
#include <dyslam/base/Options.h>
#include <dyslam/core/KeyframeStore.h>
#include <dyslam/core/Pose.h>

#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace dyslam
{
class StateArchive;

/** Which candidates of a keyframe are registered, and which of them are loops. */
struct LoopCriteria : Options
{
  int candidates = 2;                    //!< most candidates registered per keyframe
  double max_descriptor_distance = 0.4;  //!< from 0 (equal) to 1 (nothing in common)
  double min_overlap = 0.6;         //!< least fraction of points above ground with a correspondence
  double max_rmse = 0.2;            //!< largest RMSE of the point-to-plane residuals [m]
  double min_observability = 0.02;  //!< least ratio of weakest to strongest translation
  int min_support = 1;              //!< least number of loops of nearby keyframes that agree

  void describe(OptionsVisitor& visitor) override;
};

struct LoopCloserOptions : Options
{
  double min_path = 30;      //!< least distance travelled between the two keyframes [m]
  double search_radius = 6;  //!< radius of the search around the newest keyframe, without drift [m]
  double drift_per_metre = 0.03;  //!< growth of the search radius per distance travelled [m/m]
  double max_search_radius = 50;  //!< upper limit of the search radius with drift [m]
  double max_correction_angle = 45 * radians_per_degree;  //!< largest rotation by a loop [rad]
  int interval = 2;              //!< search for loops at every n-th keyframe
  double descriptor_range = 60;  //!< largest range of points in the descriptor [m]
  int submap_keyframes = 2;      //!< keyframes on each side merged into the older keyframe's cloud
  double voxel_size = 0.5;       //!< voxel size of the clouds that are registered [m]
  int support_window = 6;        //!< number of keyframes that count as nearby
  LoopCriteria nearby;           //!< of loops within the search radius

  // Places that look alike but lie beyond the search radius: position gives no evidence for them.
  bool appearance = true;      //!< search for loops beyond the search radius
  LoopCriteria by_appearance;  //!< of those loops; keys with the prefix appearance_
  /** Largest drift of the odometry, as a fraction of the path: a loop that implies more is
   * rejected. */
  double appearance_drift = 0.3;
  double place_distance = 10;  //!< candidates farther apart count as different places [m]

  LoopCloserOptions();
  /** Criteria for loops within the search radius, or for those beyond it. */
  [[nodiscard]] const LoopCriteria& criteria(bool of_appearance) const
  {
    return of_appearance ? by_appearance : nearby;
  }
  /** \throws UserError if a value is out of range, if search_radius exceeds its upper limit, or if
   * loops are searched so rarely that none has min_support others nearby. */
  void requireValid() const;
  void describe(OptionsVisitor& visitor) override;
};

/** Decision about a candidate. */
enum class LoopVerdict
{
  accepted,
  dissimilar,     //!< the two places differ in appearance
  not_converged,  //!< the registration did not converge
  no_overlap,     //!< registered, but too few points have a correspondence
  bad_fit,        //!< registered, but the surfaces do not coincide
  degenerate,     //!< the surfaces do not constrain a direction
  inconsistent,   //!< farther from the estimate than odometry could have drifted
  ambiguous,      //!< several places fit equally well
  unsupported,    //!< no loop of a nearby keyframe agrees
};
/** All verdicts. */
constexpr std::array<LoopVerdict, 9> loop_verdicts{
    LoopVerdict::accepted,     LoopVerdict::dissimilar, LoopVerdict::not_converged,
    LoopVerdict::no_overlap,   LoopVerdict::bad_fit,    LoopVerdict::degenerate,
    LoopVerdict::inconsistent, LoopVerdict::ambiguous,  LoopVerdict::unsupported};
[[nodiscard]] std::string toString(LoopVerdict verdict);

/** One loop candidate and the decision about it. */
struct Loop
{
  std::size_t from = 0;               //!< the older keyframe
  std::size_t to = 0;                 //!< the newer one
  Pose T_from_to = Pose::Identity();  //!< vehicle frame of `to` in that of `from`
  /** Over the tangent of T_from_to, [translation, rotation]; 1/m^2, 1/rad^2. */
  Matrix6 information = Matrix6::Identity();
  double descriptor_distance = 0;  //!< of the two places, from 0 (equal) to 1
  double overlap = 0;  //!< fraction of points above ground with a correspondence, in [0, 1]
  double rmse = 0;     //!< of the point-to-plane residuals [m]
  LoopVerdict verdict = LoopVerdict::accepted;
  bool by_appearance = false;  //!< found by appearance, beyond the search radius
};

/** Finds loops: candidates by distance and appearance, verified by registration and by agreement
 * with one another. If none is found within the search radius, places that look alike are tried
 * anywhere, with stricter limits: only one of them may fit, and more loops must agree.
 *
 * Deterministic; not thread-safe. The time per keyframe is bounded by the number of candidates,
 * except for a comparison of positions and of 20 heights with all older keyframes.
 */
class LoopCloser
{
 public:
  /** \param keyframes outlives the loop closer, which stores its clouds there */
  LoopCloser(const LoopCloserOptions& options, KeyframeStore& keyframes);
  ~LoopCloser();
  LoopCloser(LoopCloser&&) noexcept;
  LoopCloser& operator=(LoopCloser&&) noexcept;

  /** Prepares the newest keyframe; to be called once for every keyframe of the store, in order.
   * \param static_points static points of the keyframe, vehicle frame [m]
   * \throws std::invalid_argument unless exactly one keyframe of the store is not prepared yet. */
  void add(const std::vector<Eigen::Vector3f>& static_points);

  /** Searches for loops from the newest keyframe to older ones, at the poses of the store.
   * \return the candidates decided now: rejected ones of this keyframe, and loops of this and of
   * recent keyframes that got support or did not get it in time. */
  [[nodiscard]] std::vector<Loop> search();

  /** Decides the loops still waiting for support: \return them as unsupported. */
  [[nodiscard]] std::vector<Loop> finish();

  /** Saves or loads descriptors and waiting loops; the KeyframeStore is saved separately. */
  void exchangeState(StateArchive& archive);

 private:
  struct State;
  std::unique_ptr<State> state_;
};
}  // namespace dyslam
