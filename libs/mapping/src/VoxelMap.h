// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Pose.h>
#include <dyslam/core/SwappedStore.h>
#include <dyslam/core/VoxelGrid.h>
#include <dyslam/mapping/StaticMap.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "ScanVisibility.h"
#include "VoxelTile.h"

namespace dyslam
{
class StateArchive;

/** The voxels of the static map with the evidence for and against each. Squares that were not used
 * recently are on disk. References to voxels are valid until the next call. */
class VoxelMap
{
 public:
  VoxelMap(double voxel_size, const MemoryLimit& memory) : voxel_size_(voxel_size), tiles_(memory)
  {
  }

  [[nodiscard]] double voxelSize() const { return voxel_size_; }
  [[nodiscard]] std::size_t size() const { return size_; }
  /** Of the squares in memory [bytes]. */
  [[nodiscard]] std::size_t memory() const { return tiles_.memory(); }
  [[nodiscard]] Eigen::Vector3d centroidOf(const Voxel& voxel) const;
  /** The voxel around a point; null if there is none. */
  [[nodiscard]] const Voxel* find(const Eigen::Vector3d& p) const;

  /** The voxel around a point that a lidar of a keyframe saw; it is made where there is none. */
  Voxel& hit(const Eigen::Vector3d& p, std::uint32_t keyframe, std::uint8_t lidar = 0);
  /** Observations of a voxel by keyframes before this one count as `hits` hits and no free
   * observation, from the first keyframe on that observes it again, as free or occupied. */
  void beginRun(std::uint32_t keyframe, int hits)
  {
    run_begin_ = keyframe;
    earlier_hits_ = hits;
    run_ = run_ < most_runs ? static_cast<std::uint8_t>(run_ + 1) : most_runs;
  }
  /** Goes on with the run of another map of the same keyframes, which are inserted again. Until
   * mergeOldHits() free observations are only carried over: the other map has reset them. */
  void continueRun(const VoxelMap& other)
  {
    run_begin_ = other.run_begin_;
    earlier_hits_ = other.earlier_hits_;
    run_ = other.run_;
    rebuilding_ = true;
  }
  void addPoint(Voxel& voxel, const Eigen::Vector3d& p, float intensity) const;
  /** Carries over the evidence of an earlier map about the voxel of the same point. */
  static void carryEvidence(const Voxel& old, Voxel& voxel);
  /** The hits of the earlier map count where they are more. */
  void mergeOldHits();
  /** Counts the voxels near the vehicle that a scan observed as free. */
  void countObservedFree(const ScanVisibility& rays,
                         const Pose& T_map_vehicle,
                         const StaticMapOptions& options);

  /** Calls `use` with every voxel of the cleaned map, square by square. */
  void forEachCleaned(const StaticMapOptions& options,
                      const std::function<void(const Voxel&)>& use) const;

  void exchangeState(StateArchive& archive);

 private:
  [[nodiscard]] VoxelCell cellOf(const Eigen::Vector3d& p) const;
  [[nodiscard]] Eigen::Vector3d cornerOf(const VoxelCell& cell) const;
  /** Number of the square that a voxel belongs to; VoxelHash::none if there is none. */
  [[nodiscard]] std::uint32_t tileOf(const VoxelCell& cell) const;
  /** Whether rays observed the voxel as free often enough to remove it. */
  [[nodiscard]] static bool wasObservedFree(const Voxel& voxel, const StaticMapOptions& options);
  /** Of voxels above the ground among `suspects`, whether they lie that near to it. */
  [[nodiscard]] std::vector<bool> nearGround(const std::vector<Voxel>& suspects,
                                             const StaticMapOptions& options) const;

  /** Reduces the evidence of earlier runs, once. */
  void discountEarlierRuns(Voxel& voxel) const;

  double voxel_size_;
  std::uint32_t run_begin_ = 0;  //!< first keyframe of the run
  int earlier_hits_ = 1;
  static constexpr std::uint8_t most_runs = 255;  // further ones count as one
  std::uint8_t run_ = 0;
  bool rebuilding_ = false;  //!< between continueRun() and mergeOldHits()
  std::size_t size_ = 0;
  VoxelHash tile_index_;
  SwappedStore<VoxelTile> tiles_;
};
}  // namespace dyslam
