// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Angle.h>
#include <dyslam/base/Options.h>
#include <dyslam/core/Frame.h>
#include <dyslam/tracking/MovingLabels.h>

#include <memory>
#include <vector>

namespace dyslam
{
class StateArchive;

/** Track lifecycle and association of one class of objects. The cost of a pair is the sum of
 * (Mahalanobis distance / gate)^2 and the weighted terms. Tentative tracks of one observation,
 * whose velocity is not known, choose after all others and by the boxes' shapes instead of the
 * overlap. */
struct ClassTracking : Options
{
  double birth_score = 0;        //!< least score of a detection that starts a track
  double match_score = 0;        //!< least score of a detection that is used
  int confirm_hits = 3;          //!< observations after which a track is confirmed
  int max_misses = 10;           //!< misses in a row of a confirmed track after which it is deleted
  int max_tentative_misses = 2;  //!< misses in a row of a tentative track after which it is deleted
  int report_misses = 2;         //!< misses in a row during which a confirmed track is reported
  double gate_sigmas = 4;        //!< largest Mahalanobis distance of a pair
  double gate_distance = 4;      //!< largest distance of a pair [m]
  double max_speed = 50;         //!< largest speed for pairs of tracks with one observation [m/s]
  double min_sigma = 0.2;        //!< sigma added to the predicted position [m]
  double overlap_weight = 1;     //!< weight of (1 - GIoU) / 2 in the cost
  double heading_weight = 0.2;   //!< weight of the angle between the axes / 90 deg in the cost
  double max_cost = 1.2;         //!< largest cost of a pair
  double min_overlap = -1;       //!< least GIoU of a pair
  double score_memory = 1;   //!< weight of earlier scores in a track's mean score, per observation
  double score_prior = 3;    //!< number of zero scores added to the mean of a track's scores
  double miss_prior = 1;     //!< number of zero scores added for each miss
  double speed_sigma = 15;   //!< sigma of a new track's speed [m/s]
  double velocity_walk = 2;  //!< random walk of the velocity, motion = kalman [m/s/sqrt(s)]

  void describe(OptionsVisitor& visitor) override;
};

enum class TrackMotion
{
  adaptive,
  polynomial,
  constant_velocity,
  kalman
};

enum class AssociationMethod
{
  shortest_paths,
  greedy
};

struct TrackerOptions : Options
{
  TrackMotion motion = TrackMotion::adaptive;
  int degree = 2;   //!< degree of the fitted polynomial, motion = polynomial
  int window = 30;  //!< number of observations in the fit, motion = polynomial
  AssociationMethod association = AssociationMethod::shortest_paths;
  double dynamic_speed = 1.0;   //!< speed above which an object becomes dynamic (V_thres) [m/s]
  double static_speed = 0.5;    //!< speed below which a dynamic object becomes static again [m/s]
  double dynamic_sigmas = 2.5;  //!< least speed of a dynamic object, relative to the speed's sigma
  int dynamic_hits = 3;         //!< scans in a row that must agree on a change of static/dynamic
  /** Largest number of scans in a row in which a dynamic object is tracked only by the points in
   * its predicted box. */
  int predicted_scans = 20;
  bool must_move = true;             //!< tracks of clusters are confirmed only once they have moved
  bool complete_boxes = true;        //!< boxes of clusters are enlarged to the size observed so far
  double class_mismatch_cost = 0.5;  //!< cost added to a pair of different classes
  double size_gain = 0.2;            //!< filter gain of an observed size
  /** Standard deviation of a heading's rate of change [rad/s]. */
  double yaw_rate_sigma = 20 * radians_per_degree;
  bool adapt_noise = true;  //!< boxes from files: covariances grow with the noise observed
  ClassTracking vehicle;
  ClassTracking cyclist;
  ClassTracking pedestrian;

  TrackerOptions();
  void describe(OptionsVisitor& visitor) override;
};

/** Multi-object tracker: associates the detections of each scan with tracks in the odometry frame
 * and manages their lifecycle (tentative, confirmed, deleted). After more than 5 s without a scan
 * all tracks are deleted.
 *
 * Deterministic; not thread-safe. Detections with non-finite values or without extent are ignored.
 */
class Tracker
{
 public:
  /** \param labels of the clusters that are tracked; causal ones often lack parts of an object, so
   * that sizes shrink slowly \throws UserError if an option is out of range. */
  explicit Tracker(const TrackerOptions& options = {}, MovingLabels labels = MovingLabels::causal);
  ~Tracker();
  Tracker(Tracker&&) noexcept;
  Tracker& operator=(Tracker&&) noexcept;

  /** Marks points in the predicted box of a dynamic object as moving if the segmenter missed most
   * of them (`predicted_scans`), so that the object is detected; with MovingLabels::hindsight not
   * those that are certainly static. Reads cloud, time and
   * T_odom_vehicle of the frame, changes moving and moving_probability, sets moving_by_prediction.
   * To be called before detection, in every scan or never. */
  void markPredicted(Frame& frame) const;

  /** Reads the frame's detections, stamp, T_odom_vehicle and the mounting of its (first) lidar,
   * sets its objects (all tracks, tentative ones too). */
  void update(Frame& frame);

  /** \param stamp time of the scan [s], after that of the previous call
   *  \param detections boxes in the vehicle frame at `stamp`
   *  \param T_odom_vehicle pose of the vehicle in the odometry frame
   *  \param lidar position of the lidar in the vehicle frame [m], from which sides of the boxes are
   *  hidden
   *  \return all tracks, in order of creation
   *  \throws std::invalid_argument if the stamp does not increase. */
  [[nodiscard]] std::vector<TrackedObject> update(double stamp,
                                                  const std::vector<Detection>& detections,
                                                  const Pose& T_odom_vehicle,
                                                  const Eigen::Vector3d& lidar = {0, 0, 0});

  /** Saves or loads the state between scans. */
  void exchangeState(StateArchive& archive);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};
}  // namespace dyslam
