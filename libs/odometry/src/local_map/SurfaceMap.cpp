// SPDX-License-Identifier: BSD-3-Clause
#include "SurfaceMap.h"

#include <dyslam/base/StateArchive.h>

#include <Eigen/Eigenvalues>

namespace dyslam
{
namespace
{
constexpr std::size_t insert_chunk = 4096;
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

const SurfaceMap::Block SurfaceMap::no_numbers = []
{
  Block block;
  block.fill(VoxelHash::none);
  return block;
}();

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

std::uint32_t& SurfaceMap::Shard::numberOf(const VoxelCell& cell)
{
  const auto next = static_cast<std::uint32_t>(blocks.size());
  const std::uint32_t block = block_numbers.findOrInsert(voxelKey(blockOf(cell)), next);
  if (block == next)
  {
    blocks.emplace_back().fill(VoxelHash::none);
  }
  std::uint32_t& number = blocks[block][placeOf(cell)];
  if (number == VoxelHash::none)
  {
    number = static_cast<std::uint32_t>(cells.size());
  }
  return number;
}

void SurfaceMap::Shard::indexCells()
{
  block_numbers.clear();
  blocks.clear();
  for (std::size_t i = 0; i < cells.size(); ++i)
  {
    numberOf(cells[i].cell) = static_cast<std::uint32_t>(i);
  }
}

SurfaceMap::Moments& SurfaceMap::momentsOf(Shard& shard, const VoxelCell& cell)
{
  const std::uint32_t number = shard.numberOf(cell);
  if (number == shard.cells.size())
  {
    shard.cells.push_back({cell, Moments()});
  }
  return shard.cells[number].moments;
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
  const Eigen::Vector3d c = p / static_cast<double>(size_);
  return {cellNumber(c.x()), cellNumber(c.y()), cellNumber(c.z())};
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
  const std::size_t chunks = ThreadPool::chunkCount(points.size(), insert_chunk);
  if (buckets_.size() < chunks)
  {
    buckets_.resize(chunks);
  }
  pool_.forChunks(points.size(), insert_chunk,
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
                      bucket[shardOf(voxelKey(blockOf(cell)))].push_back({cell, offset, weight});
                    }
                  });
  pool_.forChunks(shard_count, 1,
                  [&](std::size_t s, std::size_t, std::size_t)
                  {
                    for (std::size_t chunk = 0; chunk < chunks; ++chunk)
                    {
                      for (const Item& item : buckets_[chunk][s])
                      {
                        Moments& moments = momentsOf(shards_[s], item.cell);
                        if (moments.count < max_count_)
                        {
                          moments.add(item.offset, item.weight);
                        }
                      }
                    }
                  });
}

namespace
{
/** The cells before, at and after a place along one axis. */
struct Along
{
  explicit Along(std::int32_t cell, int bits) : low((cell - 1) >> 2), high((cell + 1) >> 2)
  {
    for (std::int32_t i = 0; i < 3; ++i)
    {
      const auto at = static_cast<std::size_t>(i);
      block[at] = ((cell - 1 + i) >> 2) - low;
      place[at] = static_cast<std::size_t>((cell - 1 + i) & 3) << bits;
    }
  }

  std::int32_t low, high;             //!< blocks of the cells
  std::array<std::int32_t, 3> block;  //!< block of each cell: 0: `low`, 1: `high`
  std::array<std::size_t, 3> place;   //!< position of each cell in its block
};
}  // namespace

std::array<SurfaceMap::Found, 8> SurfaceMap::findBlocks(const VoxelCell& low,
                                                        const VoxelCell& high) const
{
  std::array<Found, 8> blocks;
  for (std::int32_t x = low.x; x <= high.x; ++x)
  {
    for (std::int32_t y = low.y; y <= high.y; ++y)
    {
      for (std::int32_t z = low.z; z <= high.z; ++z)
      {
        const std::uint64_t key = voxelKey({x, y, z});
        const Shard& shard = shards_[shardOf(key)];
        const std::uint32_t number = shard.block_numbers.find(key);
        if (number != VoxelHash::none)
        {
          blocks[static_cast<std::size_t>(4 * (x - low.x) + 2 * (y - low.y) + z - low.z)] = {
              shard.blocks[number].data(), shard.cells.data()};
        }
      }
    }
  }
  return blocks;
}

std::size_t SurfaceMap::findAround(const VoxelCell& cell, std::array<Neighbour, 27>& found) const
{
  const Along x(cell.x, 4);
  const Along y(cell.y, 2);
  const Along z(cell.z, 0);
  const auto blocks = findBlocks({x.low, y.low, z.low}, {x.high, y.high, z.high});
  std::size_t count = 0;
  for (std::size_t i = 0; i < 3; ++i)
  {
    for (std::size_t j = 0; j < 3; ++j)
    {
      for (std::size_t k = 0; k < 3; ++k)
      {
        const Found& block =
            blocks[static_cast<std::size_t>(4 * x.block[i] + 2 * y.block[j] + z.block[k])];
        const std::uint32_t number = block.numbers[x.place[i] | y.place[j] | z.place[k]];
        const bool has_points = number != VoxelHash::none;
        // Without a branch, as which cells have points cannot be predicted: the place of a cell
        // without points is taken by the next one.
        found[count] = {block.cells + (has_points ? number : 0), i, j, k};
        count += has_points ? 1 : 0;
      }
    }
  }
  return count;
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

  // All cells are looked up before any is used, so that memory latencies overlap.
  std::array<Neighbour, 27> around;
  const std::size_t found =
      findAround({local.x + base.x, local.y + base.y, local.z + base.z}, around);
  float count = 0;
  for (std::size_t i = 0; i < found; ++i)
  {
    count += around[i].cell->moments.count;
  }
  if (count < fewest_points)
  {
    return surface;
  }
  Moments total;
  for (std::size_t i = 0; i < found; ++i)
  {
    const Neighbour& cell = around[i];
    const Eigen::Vector3f step(static_cast<float>(cell.x) - 1, static_cast<float>(cell.y) - 1,
                               static_cast<float>(cell.z) - 1);
    total.add(cell.cell->moments, wx[cell.x] * wy[cell.y] * wz[cell.z], step * size_);
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
      // Moments move from the middle of the small cell to that of the large one.
      const Eigen::Vector3f d =
          Eigen::Vector3f(static_cast<float>(cell.cell.x - target.x * factor),
                          static_cast<float>(cell.cell.y - target.y * factor),
                          static_cast<float>(cell.cell.z - target.z * factor)) *
              size_ +
          Eigen::Vector3f::Constant(0.5F * size_ * static_cast<float>(1 - factor));
      Shard& to = coarse.shards_[shardOf(voxelKey(blockOf(target)))];
      momentsOf(to, target).add(cell.moments, 1, d);
    }
  }
  return coarse;
}

void SurfaceMap::crop(const Eigen::Vector3d& centre, double radius)
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
                      if ((corner(cell.cell) - centre).squaredNorm() <= radius2)
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
    shard.cells.clear();
    shard.indexCells();
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
      const Eigen::Vector3d centre =
          corner(cell.cell) + Eigen::Vector3d::Constant(0.5 * static_cast<double>(size_));
      result.push_back(
          (centre + (cell.moments.sum / cell.moments.count).cast<double>()).cast<float>());
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
