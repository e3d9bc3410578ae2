// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "SurfaceMap.h"

namespace dyslam
{
class StateArchive;

/** Maps of the same points in cells of one, two, four ... times a size. If the rings of a sensor
 * are too far apart for a surface in a small cell, a larger cell has one. */
class SurfacePyramid
{
 public:
  static constexpr int max_levels = 5;

  SurfacePyramid(double cell_size, int levels, double max_count, ThreadPool& pool);

  /** Origins for positions near a place: corner of a cell of each level. */
  struct Base
  {
    Eigen::Vector3d origin = Eigen::Vector3d::Zero();  //!< corner of the smallest cell [m]
    std::array<VoxelCell, max_levels> cell{};
    std::array<Eigen::Vector3f, max_levels> shift{};  //!< `origin` from each level's corner [m]
  };
  [[nodiscard]] Base baseAt(const Eigen::Vector3d& p) const;

  /** Surface around `p` of at least the given planarity, from the smallest cells that have one;
   * count is 0 if there is none. `p` and the result are relative to the base's origin [m]. */
  [[nodiscard]] Surface surfaceAt(const Eigen::Vector3f& p,
                                  const Base& base,
                                  float min_planarity) const;

  void add(const std::vector<Eigen::Vector3f>& points,
           const std::vector<float>& weights,
           const Pose& T_map_body);
  /** A map of one level with cells `factor` times as large as the smallest ones. */
  [[nodiscard]] SurfacePyramid coarser(int factor) const;
  void crop(const Eigen::Vector3d& centre, double radius);
  void clear();
  /** Empties the map and sets its cell size [m] and its number of levels. */
  void restart(double cell_size, int levels);
  /** Cells of the finest level and their mean points. */
  [[nodiscard]] std::size_t size() const { return levels_.front().size(); }
  [[nodiscard]] std::vector<Eigen::Vector3f> means() const { return levels_.front().means(); }
  [[nodiscard]] float cellSize() const { return levels_.front().cellSize(); }
  [[nodiscard]] int levels() const { return static_cast<int>(levels_.size()); }
  /** Saves or loads levels, size and content of the cells. */
  void exchangeState(StateArchive& archive);

 private:
  double cell_size_;
  double max_count_;
  ThreadPool* pool_;
  std::vector<SurfaceMap> levels_;
};
}  // namespace dyslam
