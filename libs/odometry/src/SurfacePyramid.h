// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "SurfaceMap.h"

namespace dyslam
{
class StateArchive;

/** Maps of the same points in cells of one, two, four ... times a size. Where a sensor's rings are
 * too far apart for surfaces in small cells, a larger cell has one. */
class SurfacePyramid
{
 public:
  static constexpr int max_levels = 5;

  SurfacePyramid(double cell_size, int levels, double max_count, ThreadPool& pool);

  /** Origins of positions near a place: corners of a cell of each level. */
  struct Base
  {
    Eigen::Vector3d origin = Eigen::Vector3d::Zero();  //!< corner of the smallest [m]
    std::array<VoxelCell, max_levels> cell{};
    std::array<Eigen::Vector3f, max_levels> shift{};  //!< `origin` from each level's corner [m]
  };
  [[nodiscard]] Base baseAt(const Eigen::Vector3d& p) const;

  /** Surface around `p` of at least that planarity, from the smallest cells that hold one; none
   * (count 0) if there is none. `p` and the result are relative to the base's origin [m]. */
  [[nodiscard]] Surface surfaceAt(const Eigen::Vector3f& p,
                                  const Base& base,
                                  float min_planarity) const;

  void add(const std::vector<Eigen::Vector3f>& points,
           const std::vector<float>& weights,
           const Pose& T_map_body);
  /** The same map in cells `factor` times as large as the smallest: of one level. */
  [[nodiscard]] SurfacePyramid coarser(int factor) const;
  void crop(const Eigen::Vector3d& center, double radius);
  void clear();
  /** Empty, with so many levels of cells of these sizes. */
  void restart(double cell_size, int levels);
  /** Cells, and their mean points, of the finest level. */
  [[nodiscard]] std::size_t size() const { return levels_.front().size(); }
  [[nodiscard]] std::vector<Eigen::Vector3f> means() const { return levels_.front().means(); }
  [[nodiscard]] float cellSize() const { return levels_.front().cellSize(); }
  [[nodiscard]] int levels() const { return static_cast<int>(levels_.size()); }
  /** Levels, size and content of the cells. */
  void exchangeState(StateArchive& archive);

 private:
  double cell_size_;
  double max_count_;
  ThreadPool* pool_;
  std::vector<SurfaceMap> levels_;
};
}  // namespace dyslam
