// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/SwappedStore.h>
#include <dyslam/core/Pose.h>
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
  /** Size of the squares that are in memory [bytes]. */
  [[nodiscard]] std::size_t memory() const { return tiles_.memory(); }
  [[nodiscard]] Eigen::Vector3d centroidOf(const Voxel& voxel) const;
  /** The voxel around a point (map frame [m]); null if there is none. */
  [[nodiscard]] const Voxel* find(const Eigen::Vector3d& p) const;

  /** Counts a hit by a keyframe's lidar: finds or adds the voxel around the point (map frame [m]).
   */
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
  /** Carries over the evidence of `old`, the voxel of the same point in an earlier map. */
  static void carryEvidence(const Voxel& old, Voxel& voxel);
  /** Ends continueRun(): each voxel gets the hits of the earlier map if these are more. */
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
  /** Whether each of `suspects` lies within ground_clearance above the ground or below it. */
  [[nodiscard]] std::vector<bool> nearGround(const std::vector<Voxel>& suspects,
                                             const StaticMapOptions& options) const;

  /** Reduces the evidence of earlier runs about a voxel, once per run. */
  void discountEarlierRuns(Voxel& voxel) const;

  double voxel_size_;
  std::uint32_t run_begin_ = 0;  //!< first keyframe of the run
  int earlier_hits_ = 1;         //!< most hits that the observations of earlier runs count as
  static constexpr std::uint8_t most_runs = 255;  // later runs are treated as one
  std::uint8_t run_ = 0;                          //!< number of beginRun() calls
  bool rebuilding_ = false;                       //!< between continueRun() and mergeOldHits()
  std::size_t size_ = 0;
  VoxelHash tile_index_;
  SwappedStore<VoxelTile> tiles_;
};
}  // namespace dyslam
