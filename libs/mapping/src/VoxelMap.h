// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Pose.h>
#include <dyslam/core/VoxelGrid.h>
#include <dyslam/mapping/StaticMap.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "VisibilityImage.h"

namespace dyslam
{
class StateArchive;

struct Voxel
{
  Eigen::Vector3f corner_offset =
      Eigen::Vector3f::Zero();  //!< sum over points, from the cell's corner
  float intensity = 0;          //!< sum over points
  VoxelCell cell;
  std::uint32_t last_keyframe = 0xFFFFFFFFU;  //!< that hit it
  std::uint16_t points = 0;                   //!< kept with their keyframes
  std::uint16_t hits = 0;                     //!< keyframes that hit it
  std::uint16_t old_hits = 0;       //!< in the map before the last correction, of the points in it
  std::uint16_t observed_free = 0;  //!< keyframes that observed it as free
  bool has_evidence = false;        //!< carried over from the map before the last correction
};

/** The voxels of the static map and what speaks for and against each. */
class VoxelMap
{
 public:
  /** \param expected number of voxels to make room for */
  explicit VoxelMap(double voxel_size, std::size_t expected = 0)
      : voxel_size_(voxel_size), index_(expected)
  {
    voxels_.reserve(expected);
  }

  [[nodiscard]] double voxelSize() const { return voxel_size_; }
  [[nodiscard]] const std::vector<Voxel>& voxels() const { return voxels_; }
  [[nodiscard]] Eigen::Vector3d centroidOf(const Voxel& voxel) const;
  /** Number of the voxel around a point; VoxelHash::none if there is none. */
  [[nodiscard]] std::uint32_t find(const Eigen::Vector3d& p) const;

  /** The voxel around a point that a keyframe saw; it is made where there is none. */
  Voxel& hit(const Eigen::Vector3d& p, std::uint32_t keyframe);
  void addPoint(Voxel& voxel, const Eigen::Vector3d& p, float intensity) const;
  /** Carries over the evidence of an earlier map about the voxel of the same point. */
  static void carryEvidence(const Voxel& old, Voxel& voxel);
  /** The hits of the earlier map count where they are more. */
  void mergeOldHits();
  /** Counts the voxels near the vehicle that a scan observed as free. */
  void countObservedFree(const VisibilityImage& image,
                         const Pose& T_map_vehicle,
                         const StaticMapOptions& options);

  /** For each voxel, whether it is part of the cleaned map. */
  [[nodiscard]] std::vector<bool> cleaned(const StaticMapOptions& options) const;

  void exchangeState(StateArchive& archive);

 private:
  [[nodiscard]] VoxelCell cellOf(const Eigen::Vector3d& p) const;
  /** Puts voxel `number`, which is in that cell, into the list of its square. */
  void list(const VoxelCell& cell, std::uint32_t number);
  [[nodiscard]] Eigen::Vector3d cornerOf(const VoxelCell& cell) const;
  [[nodiscard]] std::vector<float> groundHeights(VoxelHash& columns) const;

  double voxel_size_;
  std::vector<Voxel> voxels_;
  VoxelHash index_;
  VoxelHash block_index_;
  std::vector<std::vector<std::uint32_t>> blocks_;  //!< voxels by squares of the map
};
}  // namespace dyslam
