// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/SwappedStore.h>
#include <dyslam/mapping/StaticMap.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "VoxelMap.h"

namespace dyslam
{
/** The points of the cleaned map in the order in which their voxels were first met. */
class CleanedMap
{
 public:
  CleanedMap(const VoxelMap& map, const StaticMapOptions& options, const MemoryLimit& memory);

  [[nodiscard]] std::size_t size() const { return size_; }
  /** Whether a voxel, by its number, is part of the cleaned map. */
  [[nodiscard]] bool contains(std::uint32_t voxel) const { return kept_[voxel]; }
  void forEachPart(const std::function<void(const MapPoints&)>& use) const;

 private:
  struct Point
  {
    std::array<float, 3> position;
    float intensity;
    std::uint16_t hits;
    std::uint8_t lidar;
    std::uint32_t voxel;
    std::uint32_t keyframe;
  };
  /** Points of successive voxels, in any order. */
  struct Part
  {
    std::vector<Point> points;
    [[nodiscard]] std::size_t memory() const { return points.capacity() * sizeof(Point); }
    [[nodiscard]] std::string toBytes() const;
    [[nodiscard]] static Part fromBytes(std::string_view bytes);
  };

  std::size_t size_ = 0;
  std::vector<bool> kept_;
  SwappedStore<Part> parts_;
};
}  // namespace dyslam
