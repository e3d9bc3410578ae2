// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Parallel.h>
#include <dyslam/core/Pose.h>
#include <dyslam/core/VoxelGrid.h>

#include <array>
#include <cstdint>
#include <vector>

namespace dyslam
{
class StateArchive;

/** Local surface around a place, relative to a base point. */
struct Surface
{
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();
  Eigen::Vector3f mean = Eigen::Vector3f::Zero();  //!< mean of the points minus the base [m]
  Eigen::Matrix3f covariance = Eigen::Matrix3f::Zero();
  float planarity = 0;  //!< 1: plane, 0: line or blob
  float count = 0;      //!< number of points of the surface; 0: no surface
};

/** A map of surfaces: moments of the points in each cell of a voxel hash.
 *
 * A surface is computed from the 3x3x3 cells around a place, weighted by a quadratic B-spline, so
 * that it changes smoothly with the place instead of jumping at cell borders. Cells are found by
 * blocks of 4x4x4, of which a place's 27 cells touch one to eight. Blocks are spread over a fixed
 * number of shards, so that threads can add points without locks and with the same result for any
 * number of threads. Positions are kept relative to their cell: no precision is lost far from the
 * origin.
 */
class SurfaceMap
{
 public:
  SurfaceMap(double cell_size, double max_count, ThreadPool& pool);

  /** Adds points in a body's frame. \param weights one per point; empty: 1 */
  void add(const std::vector<Eigen::Vector3f>& points,
           const std::vector<float>& weights,
           const Pose& T_map_body);

  /** The map with cells `factor` times as large. */
  [[nodiscard]] SurfaceMap coarser(int factor) const;

  /** Base cell for queries around a place. */
  [[nodiscard]] VoxelCell cellOf(const Eigen::Vector3d& p) const;
  [[nodiscard]] Eigen::Vector3d corner(const VoxelCell& c) const;

  /** Surface around `p`, both relative to the corner of `base` [m]. */
  [[nodiscard]] Surface surfaceAt(const Eigen::Vector3f& p, const VoxelCell& base) const;

  /** Removes cells farther than `radius` from `centre` [m]. */
  void crop(const Eigen::Vector3d& centre, double radius);
  void clear();
  [[nodiscard]] std::size_t size() const;
  [[nodiscard]] std::vector<Eigen::Vector3f> means() const;
  [[nodiscard]] float cellSize() const { return size_; }
  /** Saves or loads the cells, of a map with the same cell size. */
  void exchangeState(StateArchive& archive);

 private:
  /** Sums over the points of a cell: weights, offsets from its centre and their products. */
  struct Moments
  {
    float count = 0;
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    std::array<float, 6> products{0, 0, 0, 0, 0, 0};  //!< xx xy xz yy yz zz

    /** Adds `weight` times `other`, whose centre is at `shift` from this cell's centre. */
    void add(const Moments& other, float weight, const Eigen::Vector3f& shift);
    void add(const Eigen::Vector3f& offset, float weight);
  };
  struct Cell
  {
    VoxelCell cell;
    Moments moments;
  };
  /** Numbers of the cells of a block, or VoxelHash::none. */
  using Block = std::array<std::uint32_t, 64>;
  struct Shard
  {
    VoxelHash block_numbers;
    std::vector<Block> blocks;
    std::vector<Cell> cells;

    /** Number of a cell; a new one if it has none yet. */
    std::uint32_t& numberOf(const VoxelCell& cell);
    /** Rebuilds the numbers of the cells. */
    void indexCells();
  };
  static const Block no_numbers;  //!< of a block without cells
  /** Cells of a block. */
  struct Found
  {
    const std::uint32_t* numbers = no_numbers.data();  //!< of 64 cells
    const Cell* cells = nullptr;                       //!< null: there is no such block
  };
  /** A cell of the 3x3x3 around another, with its position among them, 0 to 2 along each axis. */
  struct Neighbour
  {
    const Cell* cell;
    std::size_t x, y, z;
  };
  struct Item
  {
    VoxelCell cell;
    Eigen::Vector3f offset;
    float weight;
  };
  static constexpr std::size_t shard_count = 8;

  /** The blocks from `low` to `high`, at most two along each axis; number 4x + 2y + z from `low`.
   */
  [[nodiscard]] std::array<Found, 8> findBlocks(const VoxelCell& low, const VoxelCell& high) const;
  /** Finds the cells with points around a cell. \return their number */
  std::size_t findAround(const VoxelCell& cell, std::array<Neighbour, 27>& found) const;
  /** Moments of a cell; new ones if it has none yet. */
  static Moments& momentsOf(Shard& shard, const VoxelCell& cell);

  [[nodiscard]] static VoxelCell blockOf(const VoxelCell& cell)
  {
    return {cell.x >> 2, cell.y >> 2, cell.z >> 2};
  }
  /** Index of a cell within its block. */
  [[nodiscard]] static std::size_t placeOf(const VoxelCell& cell)
  {
    return static_cast<std::size_t>(((cell.x & 3) << 4) | ((cell.y & 3) << 2) | (cell.z & 3));
  }
  [[nodiscard]] static std::size_t shardOf(std::uint64_t block_key)
  {
    return static_cast<std::size_t>((block_key ^ (block_key >> 21) ^ (block_key >> 42)) %
                                    shard_count);
  }

  float size_;
  float inverse_;
  float max_count_;
  ThreadPool& pool_;
  std::array<Shard, shard_count> shards_;
  std::vector<std::array<std::vector<Item>, shard_count>> buckets_;  //!< by chunk, reused
};
}  // namespace dyslam
