// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/StateArchive.h>
#include <dyslam/core/VoxelGrid.h>
#include <dyslam/mapping/MovingInMap.h>
#include <dyslam/mapping/StaticMap.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include "CleanedMap.h"
#include "ScanVisibility.h"
#include "VoxelMap.h"

namespace dyslam
{
namespace
{
// Shares of the memory: both exist while a map is rebuilt.
constexpr double map_share = 0.3;
constexpr double cleaned_share = 0.1;

/** A map before it is rebuilt. */
struct BuiltMap
{
  std::vector<Pose> poses;
  VoxelMap map;
};

template <typename Value>
void extend(std::vector<Value>& all, const std::vector<Value>& part)
{
  all.insert(all.end(), part.begin(), part.end());
}

void reserve(std::size_t count, MapPoints& points)
{
  points.points.reserve(count);
  points.intensity.reserve(count);
  points.hits.reserve(count);
  points.voxel.reserve(count);
  points.keyframe.reserve(count);
  points.lidar.reserve(count);
}

/** KeyframeCloud::lidar of a frame's cloud; empty for a vehicle with one lidar. */
std::vector<std::uint8_t> lidarOfPoints(const Frame& frame)
{
  std::vector<std::uint8_t> result;
  if (!frame.scan.parts.empty())
  {
    for (const LidarRange& range : lidarRanges(frame.scan, frame.cloud))
    {
      result.resize(range.end, static_cast<std::uint8_t>(range.lidar));
    }
  }
  return result;
}
}  // namespace

void MapPoints::add(const MapPoints& others, std::size_t i)
{
  points.push_back(others.points[i]);
  intensity.push_back(others.intensity[i]);
  hits.push_back(others.hits[i]);
  voxel.push_back(others.voxel[i]);
  keyframe.push_back(others.keyframe[i]);
  if (!others.lidar.empty())
  {
    lidar.push_back(others.lidar[i]);
  }
  if (!others.normals.empty())
  {
    normals.push_back(others.normals[i]);
  }
}

void MapPoints::append(const MapPoints& others)
{
  extend(points, others.points);
  extend(intensity, others.intensity);
  extend(hits, others.hits);
  extend(voxel, others.voxel);
  extend(keyframe, others.keyframe);
  extend(lidar, others.lidar);
  extend(normals, others.normals);
}

void StaticMapOptions::describe(OptionsVisitor& v)
{
  v.real("voxel_size", voxel_size, 0.01, 10, "side of the voxels, with one map point each [m]");
  v.real("min_range", min_range, 0, 100,
         "range from the vehicle's origin below which returns (own vehicle) are left out [m]");
  v.real("max_range", max_range, 1, 300,
         "range from the vehicle's origin above which returns are left out [m]");
  v.real("box_margin", box_margin, 0, 5,
         "margin by which boxes of dynamic tracks are widened on each side [m]");
  v.integer("points_per_voxel", points_per_voxel, 1, 1000, "most keyframe points kept per voxel");
  v.integer("max_voxels", max_voxels, 1000, 1000000000,
            "number of voxels above which the voxel size doubles");
  v.integer("min_hits", min_hits, 1, 1000, "least number of keyframes that hit a voxel of the map");
  v.real("correction_distance", correction_distance, 0, 100,
         "shift of a keyframe by loops above which the map is corrected [m]");
  v.real("correction_growth", correction_growth, 0, 10,
         "growth since the last correction after which shifts below a voxel are corrected, as a "
         "fraction");
  v.flag("visibility", visibility, "remove voxels that later rays passed through");
  v.real("visibility_range", visibility_range, 0, 300, "range up to which voxels are checked [m]");
  v.real("visibility_margin", visibility_margin, 0, 10,
         "least distance that a ray ends behind a voxel to observe it as free [m]");
  v.integer("visibility_min_views", visibility_min_views, 1, 1000,
            "least number of keyframes that observed a removed voxel as free");
  v.real("visibility_ratio", visibility_ratio, 0, 1000,
         "least ratio of the keyframes that observed a removed voxel as free to those that hit it");
  v.real("ground_clearance", ground_clearance, 0, 10,
         "height above the lowest voxel of a column up to which voxels are kept [m]");
  v.choice("changes", changes, {{"latest", MapChanges::latest}, {"all", MapChanges::all}},
           "map where several runs differ: the latest run at a place, or all keyframes equally");
}

struct StaticMap::Impl
{
  Impl(const StaticMapOptions& o, KeyframeStore& store, const MapRegion& part)
      : options(o),
        keyframes(store),
        region(part),
        map(o.voxel_size, store.memory().part(map_share))
  {
    validate(options, "map");
    if (options.min_range >= options.max_range)
    {
      throw UserError("[map] min_range must be below max_range");
    }
  }

  /** The frame's points within the range limits, one per voxel, static ones first. */
  [[nodiscard]] KeyframeCloud thinned(const Frame& frame) const;
  /** Appends the pose of the next keyframe; corrects the map first, if that is due. */
  void takeNext(const Frame& frame);
  void addToVoxels(std::size_t keyframe, const BuiltMap* before);
  void rebuild(double voxel_size);
  /** Largest distance between the store's poses and the poses that the map is built with [m]. */
  [[nodiscard]] double largestCorrection() const;
  [[nodiscard]] bool isCorrectionDue() const;
  void correct();
  void keepWithinLimit();
  [[nodiscard]] const CleanedMap& cleanedMap() const;

  StaticMapOptions options;
  KeyframeStore& keyframes;
  MapRegion region;
  std::size_t revision = 0;  //!< revision of the keyframes' poses that the map is built with
  std::size_t keyframes_at_rebuild = 0;  //!< number of keyframes at the last rebuild
  std::vector<Pose> poses;  //!< poses that the map is built with, one per keyframe inserted
  VoxelMap map;
  mutable std::optional<CleanedMap> cleaned;  //!< valid until the map changes
};

KeyframeCloud StaticMap::Impl::thinned(const Frame& frame) const
{
  const std::vector<bool> moving = movingInMap(frame, options);
  const double nearest = options.min_range * options.min_range;
  const double farthest = options.max_range * options.max_range;
  const bool has_intensity = frame.cloud.intensity.size() == frame.cloud.size();
  const std::vector<std::uint8_t> lidars = lidarOfPoints(frame);
  KeyframeCloud result;
  for (const bool part : {false, true})
  {
    std::vector<Eigen::Vector3f> points;
    std::vector<std::uint32_t> source;
    for (std::size_t i = 0; i < frame.cloud.size(); ++i)
    {
      const auto& p = frame.cloud.points[i];
      const double squared = static_cast<double>(p.squaredNorm());
      if (moving[i] == part && squared >= nearest && squared <= farthest)
      {
        points.push_back(p);
        source.push_back(static_cast<std::uint32_t>(i));
      }
    }
    const VoxelSample sample = voxelDownsample(points, map.voxelSize(), VoxelPick::centroid);
    for (std::size_t k = 0; k < sample.points.size(); ++k)
    {
      result.points.push_back(sample.points[k]);
      result.intensity.push_back(has_intensity ? frame.cloud.intensity[source[sample.index[k]]]
                                               : 0.0F);
      result.is_static.push_back(part ? 0 : 1);
      if (!lidars.empty())
      {
        result.lidar.push_back(lidars[source[sample.index[k]]]);
      }
    }
  }
  return result;
}

/** Adds the keyframe's points to voxels; points whose voxel is full are removed. \param before map
 * before a rebuild, from which the voxels of its points inherit the evidence; may be null */
void StaticMap::Impl::addToVoxels(std::size_t keyframe, const BuiltMap* before)
{
  const Pose& T = poses[keyframe];
  if (!T.matrix().allFinite())
  {
    return;
  }
  const bool has_before = before != nullptr && before->poses[keyframe].matrix().allFinite();
  const KeyframeCloud cloud = keyframes.mapCloud(keyframe).unpacked();
  std::vector<bool> keep(cloud.size(), true);
  for (std::size_t i = 0; i < cloud.size(); ++i)
  {
    if (cloud.is_static[i] == 0)
    {
      continue;
    }
    const Eigen::Vector3d point = cloud.points[i].cast<double>();
    const Eigen::Vector3d p = T * point;
    if (!region.contains(p))
    {
      keep[i] = false;
      continue;
    }
    Voxel& voxel = map.hit(p, static_cast<std::uint32_t>(keyframe),
                           static_cast<std::uint8_t>(cloud.lidarOf(i)));
    if (has_before)
    {
      const Voxel* old = before->map.find(before->poses[keyframe] * point);
      if (old != nullptr)
      {
        VoxelMap::carryEvidence(*old, voxel);
      }
    }
    keep[i] = voxel.points < options.points_per_voxel;
    if (keep[i])
    {
      map.addPoint(voxel, p, cloud.intensity[i]);
    }
  }
  if (std::find(keep.begin(), keep.end(), false) != keep.end())
  {
    keyframes.editMapCloud(keyframe).keepOnly(keep);
  }
}

/** Builds the map of its keyframes anew at their present poses. \param voxel_size side of the
 * voxels [m] */
void StaticMap::Impl::rebuild(double voxel_size)
{
  cleaned.reset();
  const BuiltMap before{
      std::exchange(poses, {}),
      std::exchange(map, VoxelMap(voxel_size, keyframes.memory().part(map_share)))};
  map.continueRun(before.map);
  for (std::size_t k = 0; k < before.poses.size(); ++k)
  {
    poses.push_back(keyframes[k].T_map_vehicle);
    addToVoxels(k, &before);
  }
  map.mergeOldHits();
  revision = keyframes.revision();
  keyframes_at_rebuild = poses.size();
}

double StaticMap::Impl::largestCorrection() const
{
  double largest = 0;
  for (std::size_t k = 0; k < poses.size(); ++k)
  {
    const Pose moved = poses[k].inverse() * keyframes[k].T_map_vehicle;
    const bool finite = moved.matrix().allFinite();
    largest = finite ? std::max(largest, motionSize(logSE3(moved))) : largest;
  }
  return largest;
}

bool StaticMap::Impl::isCorrectionDue() const
{
  if (revision == keyframes.revision())
  {
    return false;
  }
  const double moved = largestCorrection();
  const bool has_grown =
      static_cast<double>(poses.size()) >=
      static_cast<double>(keyframes_at_rebuild) * (1 + options.correction_growth);
  return moved > options.correction_distance && (has_grown || moved > map.voxelSize());
}

void StaticMap::Impl::correct()
{
  if (revision != keyframes.revision())
  {
    rebuild(map.voxelSize());
    keepWithinLimit();
  }
}

void StaticMap::Impl::keepWithinLimit()
{
  while (map.size() > static_cast<std::size_t>(options.max_voxels))
  {
    rebuild(2 * map.voxelSize());
  }
}

void StaticMap::Impl::takeNext(const Frame& frame)
{
  if (keyframes.size() <= poses.size() || keyframes[poses.size()].frame != frame.index)
  {
    throw std::invalid_argument("StaticMap: scan " + std::to_string(frame.index) +
                                " is not keyframe " + std::to_string(poses.size()) + " of " +
                                std::to_string(keyframes.size()));
  }
  if (isCorrectionDue())
  {
    correct();
  }
  poses.push_back(keyframes[poses.size()].T_map_vehicle);
}

const CleanedMap& StaticMap::Impl::cleanedMap() const
{
  if (!cleaned)
  {
    cleaned.emplace(map, options, keyframes.memory().part(cleaned_share));
  }
  return *cleaned;
}

StaticMap::StaticMap(const StaticMapOptions& options,
                     KeyframeStore& keyframes,
                     const MapRegion& region)
    : impl_(std::make_unique<Impl>(options, keyframes, region))
{
}
StaticMap::~StaticMap() = default;
StaticMap::StaticMap(StaticMap&&) noexcept = default;
StaticMap& StaticMap::operator=(StaticMap&&) noexcept = default;

void StaticMap::insert(const Frame& frame)
{
  Impl& m = *impl_;
  m.takeNext(frame);
  m.cleaned.reset();
  const Keyframe& keyframe = m.keyframes[m.poses.size() - 1];
  if (!keyframe.T_map_vehicle.matrix().allFinite())
  {
    return;
  }
  m.keyframes.editMapCloud(m.poses.size() - 1) =
      PackedCloud(m.thinned(frame), m.options.max_range + 1.0);
  if (m.options.visibility)
  {
    m.map.countObservedFree(ScanVisibility(frame.scan, frame.cloud), keyframe.T_map_vehicle,
                            m.options);
  }
  m.addToVoxels(m.poses.size() - 1, nullptr);
  m.keepWithinLimit();
}

void StaticMap::insertWithoutPoints(const Frame& frame)
{
  impl_->takeNext(frame);
}

void StaticMap::beginRun()
{
  if (impl_->options.changes == MapChanges::latest)
  {
    impl_->map.beginRun(static_cast<std::uint32_t>(impl_->poses.size()),
                        std::max(1, impl_->options.min_hits));
  }
}

void StaticMap::correct()
{
  impl_->correct();
}

std::size_t StaticMap::pointCount() const
{
  return impl_->cleanedMap().size();
}

void StaticMap::forEachPart(const std::function<void(const MapPoints&)>& use) const
{
  impl_->cleanedMap().forEachPart(use);
}

MapPoints StaticMap::points() const
{
  MapPoints result;
  reserve(pointCount(), result);
  forEachPart([&](const MapPoints& part) { result.append(part); });
  return result;
}

std::uint32_t StaticMap::voxelAt(const Eigen::Vector3d& p) const
{
  const Voxel* voxel = impl_->map.find(p);
  return voxel == nullptr ? VoxelHash::none : voxel->number;
}

void StaticMap::forEachStaticCloud(
    const std::function<void(std::size_t, const KeyframeCloud&)>& visit) const
{
  const Impl& m = *impl_;
  const CleanedMap& cleaned = m.cleanedMap();
  for (std::size_t k = 0; k < m.poses.size(); ++k)
  {
    const KeyframeCloud all = m.keyframes.mapCloud(k).unpacked();
    KeyframeCloud cloud;
    for (std::size_t i = 0; i < all.size() && m.poses[k].matrix().allFinite(); ++i)
    {
      const Voxel* voxel = m.map.find(m.poses[k] * all.points[i].cast<double>());
      if (all.is_static[i] != 0 && voxel != nullptr && cleaned.contains(voxel->number))
      {
        cloud.points.push_back(all.points[i]);
        cloud.intensity.push_back(all.intensity[i]);
        cloud.is_static.push_back(1);
        if (!all.lidar.empty())
        {
          cloud.lidar.push_back(all.lidar[i]);
        }
      }
    }
    visit(k, cloud);
  }
}

const KeyframeStore& StaticMap::keyframes() const
{
  return impl_->keyframes;
}
const std::vector<Pose>& StaticMap::poses() const
{
  return impl_->poses;
}
double StaticMap::voxelSize() const
{
  return impl_->map.voxelSize();
}
std::size_t StaticMap::voxelCount() const
{
  return impl_->map.size();
}
std::size_t StaticMap::memory() const
{
  return impl_->map.memory();
}

void StaticMap::exchangeState(StateArchive& archive)
{
  archive(impl_->revision, impl_->keyframes_at_rebuild, impl_->poses, impl_->map);
  if (archive.isLoading())
  {
    impl_->cleaned.reset();
  }
}
}  // namespace dyslam
