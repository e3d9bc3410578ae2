// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>
#include <dyslam/core/KeyframeStore.h>
#include <dyslam/core/Options.h>

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <vector>

namespace dyslam
{
class StateArchive;

/** Which runs count where several runs of one place differ, as by a car that was parked in one of
 * them. */
enum class MapChanges
{
  latest,  //!< the latest run that saw the place
  all,     //!< all keyframes alike, of whatever run
};

struct StaticMapOptions : Options
{
  double voxel_size = 0.2;      //!< one map point per cube of this side [m]
  double min_range = 2.5;       //!< nearer returns (own vehicle) are left out [m]
  double max_range = 80.0;      //!< farther returns are left out [m]
  double box_margin = 0.2;      //!< dynamic tracks' boxes are widened by this on each side [m]
  int points_per_voxel = 5;     //!< most keyframe points kept per voxel
  int max_voxels = 1000000000;  //!< beyond, the voxel size doubles
  int min_hits = 1;             //!< voxels hit by fewer keyframes are not part of the map
  /** Shift of a keyframe by loops above which insert() first corrects the map [m]: at once if it is
   * above a voxel, else after correction_growth. */
  double correction_distance = 0.05;
  /** Growth since the last correction, as a fraction. */
  double correction_growth = 0.1;

  // Visibility clean-up: voxels that later rays pass through repeatedly were not static.
  bool visibility = true;
  double visibility_range = 40.0;  //!< voxels up to here are checked [m]
  double visibility_margin = 0.5;  //!< a ray must end this far behind the voxel [m]
  int visibility_min_views = 3;    //!< least number of keyframes that observed it as free
  double visibility_ratio = 1.5;   //!< least ratio of these to the keyframes that hit it
  double ground_clearance = 0.3;   //!< voxels this near to the lowest of their column stay [m]
  MapChanges changes = MapChanges::latest;  //!< of maps of several runs

  void describe(OptionsVisitor& visitor) override;
};

/** Points of a map: one per voxel, or (FullResolution) all of them. The arrays are of one length.
 */
struct MapPoints
{
  std::vector<Eigen::Vector3f> points;  //!< map frame; of a voxel the centroid of its points [m]
  std::vector<float> intensity;         //!< in [0, 1]; of a voxel the mean
  std::vector<std::uint32_t> hits;      //!< keyframes that hit the voxel
  std::vector<std::uint32_t> voxel;     //!< StaticMap::voxelAt() of the point
  std::vector<std::uint32_t> keyframe;  //!< that saw it, of a voxel the last one
  std::vector<std::uint8_t> lidar;      //!< of that keyframe, as KeyframeCloud::lidar; may be empty
  /** Unit vectors towards the sensor that saw the point, 0 where unknown; empty until
   * estimateMapNormals(). */
  std::vector<Eigen::Vector3f> normals;

  [[nodiscard]] std::size_t size() const { return points.size(); }
  /** Adds point `i` of others, with its lidar and its normal if they have these. */
  void add(const MapPoints& others, std::size_t i);
  /** Adds all points of others. */
  void append(const MapPoints& others);
};

/** Part of the map plane, the upper borders excluded. */
struct MapRegion
{
  Eigen::Vector2d low = Eigen::Vector2d::Constant(-std::numeric_limits<double>::infinity());
  Eigen::Vector2d high = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());

  [[nodiscard]] bool contains(const Eigen::Vector3d& p) const
  {
    return (p.head<2>().array() >= low.array()).all() && (p.head<2>().array() < high.array()).all();
  }
};

/** The static map, built from keyframes. Its size is bounded by the area seen, not by time, and its
 * memory by that of the keyframe store: parts that were not used recently are on disk.
 *
 * Each voxel keeps a limited number of points, so that driving round a block again adds nothing;
 * the points are stored by keyframe, so that the map can be rebuilt after a loop. Left out are
 * points that move, points of dynamic tracks, and voxels that later keyframes observed as free.
 * Deterministic; not thread-safe.
 */
class StaticMap
{
 public:
  /** \param keyframes outlives the map, which keeps its points there and follows its poses.
   * \param region the map holds what lies here, exactly as the whole map would. */
  StaticMap(const StaticMapOptions& options,
            KeyframeStore& keyframes,
            const MapRegion& region = {});
  ~StaticMap();
  StaticMap(StaticMap&&) noexcept;
  StaticMap& operator=(StaticMap&&) noexcept;

  /** Adds the next keyframe, at its pose in the store. Every keyframe of the store is inserted in
   * order, also long after it was created; one whose pose is not finite has no points. If keyframes
   * have moved, the map is corrected first, see `correction_distance`; the remaining error until
   * correct() is less than a voxel.
   * \param frame that became the keyframe: cloud, what moves in it, and its objects are read
   * \throws std::invalid_argument unless the frame is the first keyframe of the store that is not
   * in the map yet.
   */
  void insert(const Frame& frame);
  /** Inserts the next keyframe without its points, because its pose is not accurate enough.
   * \throws std::invalid_argument as insert(). */
  void insertWithoutPoints(const Frame& frame);

  /** The keyframes inserted from here on are of another run of the same place, later than those
   * before. */
  void beginRun();

  /** Rebuilds the map at the poses of the store, if these were corrected since. */
  void correct();

  /** The cleaned map, in the order in which voxels were first met. */
  [[nodiscard]] MapPoints points() const;
  /** The same in parts, one of which is in memory at a time. */
  void forEachPart(const std::function<void(const MapPoints&)>& use) const;
  /** Number of points of the cleaned map. */
  [[nodiscard]] std::size_t pointCount() const;

  /** Number of the voxel around a point, VoxelHash::none if there is none; cleaned ones too. */
  [[nodiscard]] std::uint32_t voxelAt(const Eigen::Vector3d& p) const;

  /** Calls `visit` with the points of every keyframe (vehicle frame) that are in the cleaned map,
   * keyframes in order; one cloud is in memory at a time. */
  void forEachStaticCloud(
      const std::function<void(std::size_t keyframe, const KeyframeCloud& cloud)>& visit) const;

  [[nodiscard]] const KeyframeStore& keyframes() const;
  /** Poses that the map is built with, one per keyframe inserted. */
  [[nodiscard]] const std::vector<Pose>& poses() const;
  /** Side of the voxels now [m]: the option's, or doubled to keep within max_voxels. */
  [[nodiscard]] double voxelSize() const;
  /** Voxels held, cleaned ones too. */
  [[nodiscard]] std::size_t voxelCount() const;
  /** Size of the voxels that are in memory, not on disk [bytes]. */
  [[nodiscard]] std::size_t memory() const;

  /** The voxels; the keyframes are saved by themselves. \pre no beginRun(): runs are not part of it
   */
  void exchangeState(StateArchive& archive);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};
}  // namespace dyslam
