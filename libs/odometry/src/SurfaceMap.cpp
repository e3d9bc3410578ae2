// SPDX-License-Identifier: BSD-3-Clause
#include "SurfaceMap.h"

#include <dyslam/core/StateArchive.h>

#include <Eigen/Eigenvalues>
#include <cmath>

namespace dyslam
{
namespace
{
constexpr std::size_t chunk_size = 4096;
constexpr float fewest_points = 6;

/** Quadratic B-spline weights of the cells before, at and after a place at `f` in [0, 1) of its
 * cell. */
std::array<float, 3> splineWeights(float f)
{
  const float before = 0.5F * (1 - f) * (1 - f);
  const float after = 0.5F * f * f;
  return {before, 1 - before - after, after};
}
}  // namespace

void SurfaceMap::Moments::add(const Moments& other, float weight, const Eigen::Vector3f& d)
{
  const float n = weight * other.count;
  const Eigen::Vector3f s = weight * other.sum;
  count += n;
  sum += s + n * d;
  products[0] += weight * other.products[0] + 2 * d.x() * s.x() + n * d.x() * d.x();
  products[1] += weight * other.products[1] + d.x() * s.y() + d.y() * s.x() + n * d.x() * d.y();
  products[2] += weight * other.products[2] + d.x() * s.z() + d.z() * s.x() + n * d.x() * d.z();
  products[3] += weight * other.products[3] + 2 * d.y() * s.y() + n * d.y() * d.y();
  products[4] += weight * other.products[4] + d.y() * s.z() + d.z() * s.y() + n * d.y() * d.z();
  products[5] += weight * other.products[5] + 2 * d.z() * s.z() + n * d.z() * d.z();
}

void SurfaceMap::Moments::add(const Eigen::Vector3f& o, float weight)
{
  count += weight;
  sum += weight * o;
  products[0] += weight * o.x() * o.x();
  products[1] += weight * o.x() * o.y();
  products[2] += weight * o.x() * o.z();
  products[3] += weight * o.y() * o.y();
  products[4] += weight * o.y() * o.z();
  products[5] += weight * o.z() * o.z();
}

SurfaceMap::Moments& SurfaceMap::momentsOf(std::uint64_t key, const VoxelCell& cell)
{
  Shard& shard = shards_[shardOf(key)];
  const auto next = static_cast<std::uint32_t>(shard.cells.size());
  const std::uint32_t slot = shard.hash.findOrInsert(key, next);
  if (slot == next)
  {
    shard.cells.push_back({key, cell, Moments()});
  }
  return shard.cells[slot].moments;
}

SurfaceMap::SurfaceMap(double cell_size, double max_count, ThreadPool& pool)
    : size_(static_cast<float>(cell_size)),
      inverse_(static_cast<float>(1 / cell_size)),
      max_count_(static_cast<float>(max_count)),
      pool_(pool)
{
}

VoxelCell SurfaceMap::cellOf(const Eigen::Vector3d& p) const
{
  const Eigen::Vector3d c = (p / static_cast<double>(size_)).array().floor();
  return {static_cast<std::int32_t>(c.x()), static_cast<std::int32_t>(c.y()),
          static_cast<std::int32_t>(c.z())};
}

Eigen::Vector3d SurfaceMap::corner(const VoxelCell& c) const
{
  return Eigen::Vector3d(c.x, c.y, c.z) * static_cast<double>(size_);
}

void SurfaceMap::add(const std::vector<Eigen::Vector3f>& points,
                     const std::vector<float>& weights,
                     const Pose& T_map_body)
{
  const VoxelCell base = cellOf(T_map_body.translation());
  const Eigen::Matrix3f R = T_map_body.linear().cast<float>();
  const Eigen::Vector3f t = (T_map_body.translation() - corner(base)).cast<float>();
  const std::size_t chunks = ThreadPool::chunkCount(points.size(), chunk_size);
  if (buckets_.size() < chunks)
  {
    buckets_.resize(chunks);
  }
  pool_.forChunks(points.size(), chunk_size,
                  [&](std::size_t begin, std::size_t end, std::size_t chunk)
                  {
                    auto& bucket = buckets_[chunk];
                    for (auto& items : bucket)
                    {
                      items.clear();
                    }
                    for (std::size_t i = begin; i < end; ++i)
                    {
                      const float weight = weights.empty() ? 1.0F : weights[i];
                      if (!(weight > 0))
                      {
                        continue;
                      }
                      const Eigen::Vector3f p = R * points[i] + t;
                      const VoxelCell c = voxelCell(p, inverse_);
                      const Eigen::Vector3f offset(
                          p.x() - (static_cast<float>(c.x) + 0.5F) * size_,
                          p.y() - (static_cast<float>(c.y) + 0.5F) * size_,
                          p.z() - (static_cast<float>(c.z) + 0.5F) * size_);
                      const VoxelCell cell{c.x + base.x, c.y + base.y, c.z + base.z};
                      const std::uint64_t key = voxelKey(cell);
                      bucket[shardOf(key)].push_back({key, cell, offset, weight});
                    }
                  });
  pool_.forChunks(shard_count, 1,
                  [&](std::size_t s, std::size_t, std::size_t)
                  {
                    for (std::size_t chunk = 0; chunk < chunks; ++chunk)
                    {
                      for (const Item& item : buckets_[chunk][s])
                      {
                        Moments& moments = momentsOf(item.key, item.cell);
                        if (moments.count < max_count_)
                        {
                          moments.add(item.offset, item.weight);
                        }
                      }
                    }
                  });
}

Surface SurfaceMap::surfaceAt(const Eigen::Vector3f& p, const VoxelCell& base) const
{
  Surface surface;
  const VoxelCell local = voxelCell(p, inverse_);
  const Eigen::Vector3f corner_of_cell =
      Eigen::Vector3f(static_cast<float>(local.x), static_cast<float>(local.y),
                      static_cast<float>(local.z)) *
      size_;
  const Eigen::Vector3f f = (p - corner_of_cell) * inverse_;
  const auto wx = splineWeights(f.x());
  const auto wy = splineWeights(f.y());
  const auto wz = splineWeights(f.z());

  // All cells are looked up before any is used, so that the memory's answers overlap.
  constexpr int cells = 27;
  std::array<const Moments*, cells> around;
  for (int i = 0; i < cells; ++i)
  {
    const std::uint64_t key =
        voxelKey({local.x + base.x + i / 9 - 1, local.y + base.y + i / 3 % 3 - 1,
                  local.z + base.z + i % 3 - 1});
    const Shard& shard = shards_[shardOf(key)];
    const std::uint32_t slot = shard.hash.find(key);
    around[static_cast<std::size_t>(i)] =
        slot == VoxelHash::none ? nullptr : &shard.cells[slot].moments;
  }
  float count = 0;
  Moments total;
  for (int dx = 0; dx < 3; ++dx)
  {
    for (int dy = 0; dy < 3; ++dy)
    {
      for (int dz = 0; dz < 3; ++dz)
      {
        const Moments* const found = around[static_cast<std::size_t>(9 * dx + 3 * dy + dz)];
        if (found == nullptr)
        {
          continue;
        }
        const Moments& moments = *found;
        const float w = wx[static_cast<std::size_t>(dx)] * wy[static_cast<std::size_t>(dy)] *
                        wz[static_cast<std::size_t>(dz)];
        const Eigen::Vector3f step(static_cast<float>(dx - 1), static_cast<float>(dy - 1),
                                   static_cast<float>(dz - 1));
        count += moments.count;
        total.add(moments, w, step * size_);
      }
    }
  }
  if (count < fewest_points)
  {
    return surface;
  }
  const float inverse = 1 / total.count;
  const Eigen::Vector3f mean = total.sum * inverse;
  const std::array<float, 6>& m = total.products;
  Eigen::Matrix3f C;
  C << m[0], m[1], m[2], m[1], m[3], m[4], m[2], m[4], m[5];
  C = C * inverse - mean * mean.transpose();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(C.cast<double>());
  const Eigen::Vector3d spread = solver.eigenvalues().cwiseMax(0).cwiseSqrt();
  if (!(spread[1] > 1e-3 * spread[2]))
  {
    return surface;
  }
  surface.normal = solver.eigenvectors().col(0).cast<float>();
  surface.mean = mean + corner_of_cell + Eigen::Vector3f::Constant(0.5F * size_);
  surface.covariance = C;
  surface.planarity = static_cast<float>((spread[1] - spread[0]) / spread[2]);
  surface.count = count;
  return surface;
}

SurfaceMap SurfaceMap::coarser(int factor) const
{
  const double fine = static_cast<double>(size_);
  SurfaceMap coarse(fine * factor, static_cast<double>(max_count_), pool_);
  const auto downTo = [factor](std::int32_t v)
  { return v >= 0 ? v / factor : -((-v + factor - 1) / factor); };
  for (const Shard& from : shards_)
  {
    for (const Cell& cell : from.cells)
    {
      const VoxelCell target{downTo(cell.cell.x), downTo(cell.cell.y), downTo(cell.cell.z)};
      const std::uint64_t key = voxelKey(target);
      // Moments move from the middle of the small cell to that of the large one.
      const Eigen::Vector3f d =
          Eigen::Vector3f(static_cast<float>(cell.cell.x - target.x * factor),
                          static_cast<float>(cell.cell.y - target.y * factor),
                          static_cast<float>(cell.cell.z - target.z * factor)) *
              size_ +
          Eigen::Vector3f::Constant(0.5F * size_ * static_cast<float>(1 - factor));
      coarse.momentsOf(key, target).add(cell.moments, 1, d);
    }
  }
  return coarse;
}

void SurfaceMap::Shard::indexCells()
{
  hash.clear();
  for (std::size_t i = 0; i < cells.size(); ++i)
  {
    hash.findOrInsert(cells[i].key, static_cast<std::uint32_t>(i));
  }
}

void SurfaceMap::crop(const Eigen::Vector3d& center, double radius)
{
  const auto radius2 = radius * radius;
  pool_.forChunks(shard_count, 1,
                  [&](std::size_t s, std::size_t, std::size_t)
                  {
                    Shard& shard = shards_[s];
                    std::vector<Cell> kept;
                    kept.reserve(shard.cells.size());
                    for (const Cell& cell : shard.cells)
                    {
                      if ((corner(cell.cell) - center).squaredNorm() <= radius2)
                      {
                        kept.push_back(cell);
                      }
                    }
                    if (kept.size() == shard.cells.size())
                    {
                      return;
                    }
                    shard.cells.swap(kept);
                    shard.indexCells();
                  });
}

void SurfaceMap::clear()
{
  for (Shard& shard : shards_)
  {
    shard.hash.clear();
    shard.cells.clear();
  }
}

std::size_t SurfaceMap::size() const
{
  std::size_t total = 0;
  for (const Shard& shard : shards_)
  {
    total += shard.cells.size();
  }
  return total;
}

std::vector<Eigen::Vector3f> SurfaceMap::means() const
{
  std::vector<Eigen::Vector3f> result;
  result.reserve(size());
  for (const Shard& shard : shards_)
  {
    for (const Cell& cell : shard.cells)
    {
      const Eigen::Vector3d center =
          corner(cell.cell) + Eigen::Vector3d::Constant(0.5 * static_cast<double>(size_));
      result.push_back(
          (center + (cell.moments.sum / cell.moments.count).cast<double>()).cast<float>());
    }
  }
  return result;
}

void SurfaceMap::exchangeState(StateArchive& archive)
{
  for (Shard& shard : shards_)
  {
    archive(shard.cells);
    if (archive.isLoading())
    {
      shard.indexCells();
    }
  }
}
}  // namespace dyslam
