// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Options.h>
#include <dyslam/nets/RigidFlow.h>
#include <dyslam/sim/SimulatorOptions.h>
#include <dyslam/train/RandomDraws.h>

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace dyslam
{
/** Speed above which objects are labelled moving, and below which static; in between they are
 * ignored [m/s]. */
constexpr double min_moving_speed = 0.5;
constexpr double max_static_speed = 0.25;
/** Speed above which cast bodies, whose motion is known exactly, are labelled moving [m/s]. */
constexpr double min_cast_moving_speed = 0.3;
/** Least displacement of an object that a pair of scans shows [m]: moving objects that are
 * displaced by less are ignored. */
constexpr double min_visible_displacement = 0.1;
/** Static objects that are displaced by more than this between the scans of a pair are ignored [m].
 */
constexpr double max_static_displacement = 0.2;
/** Moving objects with fewer points are not listed for the choice of crops. */
constexpr std::size_t min_mover_points = 16;
/** First seed of the simulated clips to validate on (splits.ini). */
constexpr std::uint64_t unseen_seeds = 900000000;

/** Some consecutive scans of one drive with the ground truth of every point. */
struct DysegClip
{
  static constexpr std::int32_t still = 0;
  static constexpr std::int32_t unknown = -1;

  struct Object
  {
    Pose T_sensor_object = Pose::Identity();
    bool moving = false;
    bool doubtful = false;  //!< too slow to decide, or badly labelled: ignored
  };
  struct Frame
  {
    std::vector<Eigen::Vector3f> points;  //!< sensor at the origin [m]; (0,0,0) for no return
    std::vector<std::int32_t> object;     //!< object of each point: id > 0, still or unknown
    Pose T_world_sensor = Pose::Identity();
    std::map<std::int32_t, Object> objects;
  };

  std::string name;
  double period = 0.1;  //!< time between frames [s]
  std::vector<Frame> frames;
};

/** A pair of scans with ground truth per point of the first, for training and evaluation. */
struct DysegSample
{
  static constexpr std::uint8_t static_point = 0;
  static constexpr std::uint8_t moving_point = 1;
  static constexpr std::uint8_t ignored_point = 255;

  std::vector<Eigen::Vector3f> current;
  std::vector<Eigen::Vector3f> past;
  std::vector<std::uint8_t> label;  //!< label of each current point
  std::vector<Eigen::Vector2f>
      flow;  //!< planar flow of each current point, current to past [m]; NaN if unknown
  Pose T_past_current = Pose::Identity();
  double elapsed = 0.1;  //!< time from the past to the current scan [s]
  /** Centres of moving objects with at least `min_mover_points` points, for the choice of crops
   * [m]. */
  std::vector<Eigen::Vector2f> movers;
};

/** Labels of all points of a frame, as DysegSample::label, from the speed of the objects at that
 * time. */
[[nodiscard]] std::vector<std::uint8_t> labelsBySpeed(const DysegClip::Frame& frame);

/** A pair of frames of a clip. \param current, past indices of the frames in the clip
 *
 * The flow of an object in both frames is that of its poses, or the ego-motion's if it stands still
 * between them. Objects whose displacement contradicts the label of their speed are ignored. */
[[nodiscard]] DysegSample makeSample(const DysegClip& clip, std::size_t current, std::size_t past);
/** A pair of frames. \param elapsed time between them [s] */
[[nodiscard]] DysegSample makeSample(const DysegClip::Frame& now,
                                     const DysegClip::Frame& then,
                                     double elapsed);

/** A pair made from one scan, as if it had been measured from two positions: the past scan is the
 * scan moved, thinned and with new noise. Nothing in it moves. */
[[nodiscard]] DysegSample doubleScan(const std::vector<Eigen::Vector3f>& points,
                                     const Pose& T_past_current,
                                     RandomDraws& draws);

/** Ini section `[augmentation]` of DySeg's training. */
struct DysegAugmentOptions : Options
{
  int bodies = 7;                 //!< most bodies cast into a pair
  double moving_share = 0.6;      //!< share of cast bodies that move; the others are static
  double beside_share = 0.2;      //!< share of cast bodies close beside the sensor
  double convoy_share = 0.2;      //!< share of pairs with twice the bodies, most co-moving
  double max_body_distance = 45;  //!< largest distance of a cast body [m]
  double dropout = 0.3;           //!< largest share of points left out of a scan
  double range_noise = 0.02;      //!< standard deviation of the range noise of cast bodies [m]
  void describe(OptionsVisitor& visitor) override;
};

/** Casts bodies into both scans of a pair, some moving and some static; then turns, mirrors and
 * thins the pair. */
void augment(const DysegAugmentOptions& options, RandomDraws& draws, DysegSample& sample);

/** Scans of one revolution each that were stored at an interval longer than a revolution: the
 * azimuth at which the (clockwise) sweep begins and ends drifts from scan to scan, and what is in
 * between is lost. Two scans show one revolution in most directions, but one more in those that the
 * drift has passed. */
struct SweepDrift
{
  double start_azimuth = 0;  //!< start of the sweep of scan 0, from +x towards +y [rad]
  double step = 0;           //!< drift per scan [rad]; 0: whole revolutions, deskewed or at rest

  /** Number of revolutions from scan to scan. */
  [[nodiscard]] double revolutions() const;
};

/** What is particular to recordings with boxes; the defaults are those of vls128_run88. */
struct BoxedRunOptions
{
  SweepDrift drift;           //!< drift of the sweeps
  double revolution = 0.091;  //!< time of a revolution of the sensor [s]
  /** Ids of objects that stand and whose boxes are not used. Of vls128_run88, the boxes of parked
   * motorcycles were copied from one frame to others without regard to the sensor's motion. None
   * if the last is below the first. */
  int standing_first = 500;
  int standing_last = 599;
};

/** Reads a run such as vls128_run88: scans, boxes of SUSTechPOINTS, and poses by scan matching as
 * if each step were one revolution. With a drift, points and boxes are deskewed to the middle of
 * their sweep, and the steps of the poses are scaled to the time that really passed. \param folder
 * folder of the run \throws UserError. */
[[nodiscard]] DysegClip loadBoxedRun(const std::string& folder,
                                     std::size_t first,
                                     std::size_t last,
                                     const BoxedRunOptions& options);

/** World, sensor and carrier of a simulated drive. */
struct DysegClipScene
{
  sim::WorldKind world = sim::WorldKind::urban;
  sim::SensorKind sensor = sim::SensorKind::hdl64e;
  double traffic = -1;   //!< 0 to 1; below 0 it is drawn from 0.3 to 1
  int columns = 0;       //!< firings per revolution; 0: default of the sensor
  double ego_speed = 0;  //!< cruising speed [m/s]; 0: default of the world
  sim::EgoKind ego = sim::EgoKind::automatic;
};

/** `scans` consecutive scans from the simulator. \param deskewed false: points as the sensor
 * measures them \throws UserError for a seed above 2147483647. */
[[nodiscard]] DysegClip simulateClip(std::uint64_t seed,
                                     int scans,
                                     bool deskewed,
                                     const DysegClipScene& scene = {});
}  // namespace dyslam
