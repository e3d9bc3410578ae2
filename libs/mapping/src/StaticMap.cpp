// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/VoxelGrid.h>
#include <dyslam/mapping/StaticMap.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "VisibilityImage.h"

namespace dyslam
{
namespace
{
constexpr double block_size = 8.0;   // voxels are listed by squares of this side [m]
constexpr float column_size = 1.0F;  // of the columns whose lowest voxel is the ground [m]
constexpr std::uint16_t most = std::numeric_limits<std::uint16_t>::max();
constexpr std::uint32_t no_keyframe = 0xFFFFFFFFU;

struct Voxel
{
  Eigen::Vector3f corner_offset =
      Eigen::Vector3f::Zero();  // sum over points, from the cell's corner
  float intensity = 0;          // sum over points
  VoxelCell cell;
  std::uint32_t last_keyframe = no_keyframe;  // that hit it
  std::uint16_t points = 0;                   // kept with their keyframes
  std::uint16_t hits = 0;                     // keyframes that hit it
  std::uint16_t old_hits = 0;                 // before the last stitching, of the points in it
  std::uint16_t seen_through = 0;             // keyframes that saw through it
  bool has_evidence = false;                  // taken over from before the last stitching
};

/** A map as it was before it is stitched anew. */
struct Stitched
{
  std::vector<Voxel> voxels;
  VoxelHash index;
  std::vector<Pose> poses;
  double voxel_size;
};

VoxelCell cellOf(const Eigen::Vector3d& p, double size)
{
  return {static_cast<std::int32_t>(std::floor(p.x() / size)),
          static_cast<std::int32_t>(std::floor(p.y() / size)),
          static_cast<std::int32_t>(std::floor(p.z() / size))};
}

/** Takes over what an old voxel of the same point knew; of several, what speaks most for staying.
 */
void adoptEvidence(Voxel& voxel, const Voxel& old)
{
  voxel.old_hits = std::max(voxel.old_hits, old.hits);
  voxel.seen_through =
      voxel.has_evidence ? std::min(voxel.seen_through, old.seen_through) : old.seen_through;
  voxel.has_evidence = true;
}

void countUp(std::uint16_t& counter)
{
  counter = counter < most ? static_cast<std::uint16_t>(counter + 1) : counter;
}

bool inside(const Box& box, const Eigen::Vector3d& p, double margin)
{
  const Eigen::Vector3d d = p - box.center;
  const double along = std::cos(box.yaw) * d.x() + std::sin(box.yaw) * d.y();
  const double across = -std::sin(box.yaw) * d.x() + std::cos(box.yaw) * d.y();
  return std::abs(along) <= 0.5 * box.size.x() + margin &&
         std::abs(across) <= 0.5 * box.size.y() + margin &&
         std::abs(d.z()) <= 0.5 * box.size.z() + margin;
}

/** Points of the cloud that move, or lie in the box of a dynamic track. */
std::vector<bool> notStatic(const Frame& frame, const StaticMapOptions& options)
{
  std::vector<bool> moving = frame.moving;
  moving.resize(frame.cloud.size(), false);
  for (const auto& object : frame.objects)
  {
    if (!object.dynamic)
    {
      continue;
    }
    // The box stands on the ground: its lower side must not cut the road out of the map.
    Box box = object.box;
    constexpr double over_ground = 0.25;
    box.center.z() += 0.5 * over_ground;
    box.size.z() -= over_ground;
    const double reach = 0.5 * box.size.norm() + 2 * options.box_margin;
    const Eigen::Vector3d center = frame.T_odom_vehicle.inverse() * box.center;
    for (std::size_t i = 0; i < moving.size(); ++i)
    {
      const Eigen::Vector3d p = frame.cloud.points[i].cast<double>();
      moving[i] = moving[i] || ((p - center).squaredNorm() < reach * reach &&
                                inside(box, frame.T_odom_vehicle * p, options.box_margin));
    }
  }
  return moving;
}
}  // namespace

void StaticMapOptions::describe(OptionsVisitor& v)
{
  v.real("voxel_size", voxel_size, 0.01, 10, "m, one map point per cube of this side");
  v.real("min_range", min_range, 0, 100, "m, nearer returns (own vehicle) are left out");
  v.real("max_range", max_range, 1, 300, "m, farther returns are left out");
  v.real("box_margin", box_margin, 0, 5, "m, boxes of dynamic tracks are widened by this");
  v.integer("points_per_voxel", points_per_voxel, 1, 1000,
            "keyframe points kept per voxel, later ones add nothing");
  v.integer("max_voxels", max_voxels, 1000, 1000000000, "beyond, the voxel size doubles");
  v.integer("min_hits", min_hits, 1, 1000, "voxels hit by fewer keyframes are not part of the map");
  v.flag("visibility", visibility, "remove voxels that later rays passed through");
  v.real("visibility_range", visibility_range, 0, 300, "m, voxels up to here are checked");
  v.real("visibility_margin", visibility_margin, 0, 10,
         "m, a ray must end this far behind a voxel");
  v.integer("visibility_min_views", visibility_min_views, 1, 1000,
            "keyframes that saw through a voxel, at least");
  v.real("visibility_ratio", visibility_ratio, 0, 1000, "and this many times as many as hit it");
  v.real("ground_clearance", ground_clearance, 0, 10,
         "m, voxels this near to the lowest of their column stay");
}

struct StaticMap::Impl
{
  explicit Impl(const StaticMapOptions& o)
      : options(o), voxel_size(o.voxel_size), keyframes(o.max_range + 1.0)
  {
    validate(options, "map");
  }

  [[nodiscard]] Eigen::Vector3d cornerOf(const VoxelCell& c) const
  {
    return voxel_size * Eigen::Vector3d(c.x, c.y, c.z);
  }
  [[nodiscard]] Eigen::Vector3d centroidOf(const Voxel& v) const
  {
    return cornerOf(v.cell) + (v.corner_offset / std::max<float>(v.points, 1)).cast<double>();
  }
  /** 2D cell of a point in squares, as a key. */
  [[nodiscard]] static std::uint64_t squareOf(double x, double y, double size)
  {
    return voxelKey({static_cast<std::int32_t>(std::floor(x / size)),
                     static_cast<std::int32_t>(std::floor(y / size)), 0});
  }

  [[nodiscard]] std::uint32_t voxelAt(const VoxelCell& cell);
  [[nodiscard]] KeyframeCloud thinned(const Frame& frame, const std::vector<bool>& moving) const;
  void stitch(std::size_t keyframe, const Stitched* before);
  void lookThrough(const VisibilityImage& image, const Pose& T_map_vehicle);
  void restitch(const std::vector<Pose>& new_poses, double new_voxel_size);
  void keepWithinLimit();
  /** Voxels that are part of the cleaned map. */
  [[nodiscard]] std::vector<bool> keptVoxels() const;
  [[nodiscard]] std::vector<float> groundHeights(VoxelHash& columns) const;

  StaticMapOptions options;
  double voxel_size;
  KeyframeStore keyframes;
  std::vector<Pose> poses;
  std::vector<Voxel> voxels;
  VoxelHash index;
  VoxelHash block_index;
  std::vector<std::vector<std::uint32_t>> blocks;
};

std::uint32_t StaticMap::Impl::voxelAt(const VoxelCell& cell)
{
  const auto next = static_cast<std::uint32_t>(voxels.size());
  const std::uint32_t found = index.findOrInsert(voxelKey(cell), next);
  if (found == next)
  {
    Voxel voxel;
    voxel.cell = cell;
    voxels.push_back(voxel);
    const Eigen::Vector3d corner = cornerOf(cell);
    const auto next_block = static_cast<std::uint32_t>(blocks.size());
    const std::uint32_t block =
        block_index.findOrInsert(squareOf(corner.x(), corner.y(), block_size), next_block);
    if (block == next_block)
    {
      blocks.emplace_back();
    }
    blocks[block].push_back(found);
  }
  return found;
}

KeyframeCloud StaticMap::Impl::thinned(const Frame& frame, const std::vector<bool>& moving) const
{
  const double nearest = options.min_range * options.min_range;
  const double farthest = options.max_range * options.max_range;
  const bool has_intensity = frame.cloud.intensity.size() == frame.cloud.size();
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
    const VoxelSample sample = voxelDownsample(points, voxel_size, VoxelPick::centroid);
    for (std::size_t k = 0; k < sample.points.size(); ++k)
    {
      result.points.push_back(sample.points[k]);
      result.intensity.push_back(has_intensity ? frame.cloud.intensity[source[sample.index[k]]]
                                               : 0.0F);
      result.is_static.push_back(part ? 0 : 1);
    }
  }
  return result;
}

/** Puts the keyframe's points into voxels; those that find their voxel full are forgotten.
 * \param before where the points' voxels take over what was learnt of visibility; may be null. */
void StaticMap::Impl::stitch(std::size_t keyframe, const Stitched* before)
{
  const Pose& T = poses[keyframe];
  if (!T.matrix().allFinite())
  {
    return;
  }
  const bool has_before = before != nullptr && before->poses[keyframe].matrix().allFinite();
  const KeyframeCloud cloud = keyframes.cloud(keyframe);
  const auto number = static_cast<std::uint32_t>(keyframe);
  std::vector<bool> keep(cloud.size(), true);
  for (std::size_t i = 0; i < cloud.size(); ++i)
  {
    if (cloud.is_static[i] == 0)
    {
      continue;
    }
    const Eigen::Vector3d point = cloud.points[i].cast<double>();
    const Eigen::Vector3d p = T * point;
    const VoxelCell cell = cellOf(p, voxel_size);
    Voxel& voxel = voxels[voxelAt(cell)];
    if (voxel.last_keyframe != number)
    {
      voxel.last_keyframe = number;
      countUp(voxel.hits);
    }
    if (has_before)
    {
      const VoxelCell old = cellOf(before->poses[keyframe] * point, before->voxel_size);
      const std::uint32_t found = before->index.find(voxelKey(old));
      if (found != VoxelHash::none)
      {
        adoptEvidence(voxel, before->voxels[found]);
      }
    }
    keep[i] = voxel.points < options.points_per_voxel;
    if (keep[i])
    {
      voxel.corner_offset += (p - cornerOf(cell)).cast<float>();
      voxel.intensity += cloud.intensity[i];
      countUp(voxel.points);
    }
  }
  keyframes.thin(keyframe, keep);
}

void StaticMap::Impl::lookThrough(const VisibilityImage& image, const Pose& T_map_vehicle)
{
  const Eigen::Isometry3f T_vehicle_map = T_map_vehicle.inverse().cast<float>();
  const Eigen::Vector3d at = T_map_vehicle.translation();
  const int reach = static_cast<int>(std::ceil(options.visibility_range / block_size));
  const auto limit = static_cast<float>(options.visibility_range * options.visibility_range);
  for (int bx = -reach; bx <= reach; ++bx)
  {
    for (int by = -reach; by <= reach; ++by)
    {
      const std::uint32_t block = block_index.find(
          squareOf(at.x() + bx * block_size, at.y() + by * block_size, block_size));
      if (block == VoxelHash::none)
      {
        continue;
      }
      for (const std::uint32_t v : blocks[block])
      {
        Voxel& voxel = voxels[v];
        const Eigen::Vector3f p = T_vehicle_map * centroidOf(voxel).cast<float>();
        if (p.squaredNorm() <= limit &&
            image.seesThrough(p, static_cast<float>(voxel_size),
                              static_cast<float>(options.visibility_margin)))
        {
          countUp(voxel.seen_through);
        }
      }
    }
  }
}

/** The same keyframes at other poses or in voxels of another size. */
void StaticMap::Impl::restitch(const std::vector<Pose>& new_poses, double new_voxel_size)
{
  const Stitched before{std::move(voxels), std::move(index), std::move(poses), voxel_size};
  voxels.clear();
  index = VoxelHash();
  block_index = VoxelHash();
  blocks.clear();
  poses = new_poses;
  voxel_size = new_voxel_size;
  for (std::size_t k = 0; k < keyframes.size(); ++k)
  {
    stitch(k, &before);
  }
  for (Voxel& voxel : voxels)
  {
    voxel.hits = std::max(voxel.hits, voxel.old_hits);
  }
}

void StaticMap::Impl::keepWithinLimit()
{
  while (voxels.size() > static_cast<std::size_t>(options.max_voxels))
  {
    const std::vector<Pose> same = poses;
    restitch(same, 2 * voxel_size);
  }
}

/** Height of the ground by column: the lowest voxel hit more than once, else the lowest. */
std::vector<float> StaticMap::Impl::groundHeights(VoxelHash& columns) const
{
  constexpr float nothing = std::numeric_limits<float>::infinity();
  std::vector<float> sure;
  std::vector<float> any;
  for (const Voxel& voxel : voxels)
  {
    const Eigen::Vector3d c = centroidOf(voxel);
    const auto next = static_cast<std::uint32_t>(any.size());
    const std::uint32_t column = columns.findOrInsert(squareOf(c.x(), c.y(), column_size), next);
    if (column == next)
    {
      sure.push_back(nothing);
      any.push_back(nothing);
    }
    const auto z = static_cast<float>(c.z());
    any[column] = std::min(any[column], z);
    sure[column] = voxel.hits > 1 ? std::min(sure[column], z) : sure[column];
  }
  for (std::size_t i = 0; i < any.size(); ++i)
  {
    any[i] = sure[i] < nothing ? sure[i] : any[i];
  }
  return any;
}

StaticMap::StaticMap(const StaticMapOptions& options) : impl_(std::make_unique<Impl>(options)) {}
StaticMap::~StaticMap() = default;
StaticMap::StaticMap(StaticMap&&) noexcept = default;
StaticMap& StaticMap::operator=(StaticMap&&) noexcept = default;

void StaticMap::insert(const Frame& frame)
{
  Impl& m = *impl_;
  KeyframeInfo info;
  info.frame = frame.index;
  info.stamp = frame.scan.stamp;
  info.sensor = frame.scan.T_vehicle_lidar.translation().cast<float>();
  const Pose T_map_vehicle = frame.T_map_vehicle();
  const bool placed = T_map_vehicle.matrix().allFinite();
  m.poses.push_back(T_map_vehicle);
  m.keyframes.add(info, placed ? m.thinned(frame, notStatic(frame, m.options)) : KeyframeCloud());
  if (!placed)
  {
    return;
  }
  if (m.options.visibility)
  {
    m.lookThrough(VisibilityImage(frame.cloud.points, info.sensor), T_map_vehicle);
  }
  m.stitch(m.keyframes.size() - 1, nullptr);
  m.keepWithinLimit();
}

void StaticMap::rebuild(const std::vector<Pose>& T_map_vehicle)
{
  if (T_map_vehicle.size() != impl_->keyframes.size())
  {
    throw std::invalid_argument("StaticMap: " + std::to_string(T_map_vehicle.size()) +
                                " poses for " + std::to_string(impl_->keyframes.size()) +
                                " keyframes");
  }
  impl_->restitch(T_map_vehicle, impl_->voxel_size);
  impl_->keepWithinLimit();
}

std::vector<bool> StaticMap::Impl::keptVoxels() const
{
  VoxelHash columns;
  const std::vector<float> ground =
      options.visibility ? groundHeights(columns) : std::vector<float>();
  std::vector<bool> kept(voxels.size());
  for (std::size_t i = 0; i < voxels.size(); ++i)
  {
    const Voxel& voxel = voxels[i];
    kept[i] = voxel.hits >= options.min_hits;
    const bool seen_through = options.visibility &&
                              voxel.seen_through >= options.visibility_min_views &&
                              voxel.seen_through >= options.visibility_ratio * voxel.hits;
    if (seen_through)
    {
      const Eigen::Vector3d c = centroidOf(voxel);
      const float floor = ground[columns.find(squareOf(c.x(), c.y(), column_size))];
      kept[i] = kept[i] && c.z() <= static_cast<double>(floor) + options.ground_clearance;
    }
  }
  return kept;
}

MapPoints StaticMap::points() const
{
  const Impl& m = *impl_;
  const std::vector<bool> kept = m.keptVoxels();
  MapPoints result;
  for (std::size_t i = 0; i < m.voxels.size(); ++i)
  {
    const Voxel& voxel = m.voxels[i];
    if (kept[i])
    {
      result.points.push_back(m.centroidOf(voxel).cast<float>());
      result.intensity.push_back(voxel.intensity / static_cast<float>(voxel.points));
      result.hits.push_back(voxel.hits);
    }
  }
  return result;
}

void StaticMap::forEachStaticCloud(
    const std::function<void(std::size_t, const KeyframeCloud&)>& take) const
{
  const Impl& m = *impl_;
  const std::vector<bool> kept = m.keptVoxels();
  for (std::size_t k = 0; k < m.keyframes.size(); ++k)
  {
    const KeyframeCloud all = m.keyframes.cloud(k);
    KeyframeCloud cloud;
    for (std::size_t i = 0; i < all.size() && m.poses[k].matrix().allFinite(); ++i)
    {
      const VoxelCell cell = cellOf(m.poses[k] * all.points[i].cast<double>(), m.voxel_size);
      const std::uint32_t voxel = m.index.find(voxelKey(cell));
      if (all.is_static[i] != 0 && voxel != VoxelHash::none && kept[voxel])
      {
        cloud.points.push_back(all.points[i]);
        cloud.intensity.push_back(all.intensity[i]);
        cloud.is_static.push_back(1);
      }
    }
    take(k, cloud);
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
  return impl_->voxel_size;
}
std::size_t StaticMap::voxelCount() const
{
  return impl_->voxels.size();
}
}  // namespace dyslam
