// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Options.h>
#include <dyslam/core/Frame.h>
#include <dyslam/core/KeyframeStore.h>

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

/** Which runs count where several runs of one place differ, for example by a car that was parked
 * there during one of them. */
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
  int max_voxels = 1000000000;  //!< the voxel size doubles when the map has more voxels
  int min_hits = 1;             //!< voxels hit by fewer keyframes are not part of the map
  /** Shift of a keyframe by loops above which insert() first corrects the map [m]: at once if it is
   * above a voxel, else after correction_growth. */
  double correction_distance = 0.05;
  /** Growth of the number of keyframes since the last correction, as a fraction. */
  double correction_growth = 0.1;

  // Visibility clean-up: voxels that later rays pass through repeatedly were not static.
  bool visibility = true;
  double visibility_range = 40.0;  //!< voxels up to here are checked [m]
  double visibility_margin = 0.5;  //!< a ray must end this far behind the voxel [m]
  int visibility_min_views = 3;    //!< least number of keyframes that observed a removed voxel free
  double visibility_ratio = 1.5;   //!< least ratio of keyframes seeing it free to hits
  double ground_clearance = 0.3;   //!< voxels this near to the lowest of their column stay [m]
  MapChanges changes = MapChanges::latest;  //!< which runs count in a map of several runs

  void describe(OptionsVisitor& visitor) override;
};

/** Points of a map: one per voxel, or all static points (FullResolution). All arrays that are not
 * empty have one value per point. */
struct MapPoints
{
  std::vector<Eigen::Vector3f> points;  //!< positions (or centroids of voxels), map frame [m]
  std::vector<float> intensity;         //!< intensity (or mean of a voxel), in [0, 1]
  std::vector<std::uint32_t> hits;      //!< number of keyframes that hit the voxel
  std::vector<std::uint32_t> voxel;     //!< StaticMap::voxelAt() of the point
  std::vector<std::uint32_t>
      keyframe;  //!< keyframe that saw the point, or the last that hit the voxel
  std::vector<std::uint8_t>
      lidar;  //!< lidar that saw the point, as KeyframeCloud::lidar; may be empty
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
  [[nodiscard]] bool isWhole() const
  {
    return low.array().isInf().all() && high.array().isInf().all();
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
  /** \param keyframes outlives the map, which keeps its points there and follows its poses. \param
   * region the map holds the voxels in this region, exactly as the whole map would. */
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
   * \param frame the frame that became the keyframe; cloud, moving labels and objects are read
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
  /** Calls `use` with the points of points() in parts, one of which is in memory at a time. */
  void forEachPart(const std::function<void(const MapPoints&)>& use) const;
  /** Number of points of the cleaned map. */
  [[nodiscard]] std::size_t pointCount() const;

  /** Number of the voxel around a point of the map frame [m], also if the voxel was cleaned away;
   * VoxelHash::none if there is none. */
  [[nodiscard]] std::uint32_t voxelAt(const Eigen::Vector3d& p) const;

  /** Calls `visit` with the points of every keyframe (vehicle frame) that are in the cleaned map,
   * keyframes in order; one cloud is in memory at a time. */
  void forEachStaticCloud(
      const std::function<void(std::size_t keyframe, const KeyframeCloud& cloud)>& visit) const;

  [[nodiscard]] const KeyframeStore& keyframes() const;
  /** Poses (T_map_vehicle) that the map is built with, one per keyframe inserted. */
  [[nodiscard]] const std::vector<Pose>& poses() const;
  /** Side of the voxels now [m]: the option's, or doubled to keep within max_voxels. */
  [[nodiscard]] double voxelSize() const;
  /** Number of voxels, also those that were cleaned away. */
  [[nodiscard]] std::size_t voxelCount() const;
  /** Size of the voxels that are in memory, not on disk [bytes]. */
  [[nodiscard]] std::size_t memory() const;

  /** Saves or restores the voxels, without the keyframe store. \pre beginRun() was never called:
   * runs are not part of the state */
  void exchangeState(StateArchive& archive);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};
}  // namespace dyslam
