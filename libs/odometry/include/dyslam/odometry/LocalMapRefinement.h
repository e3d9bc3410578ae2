// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>
#include <dyslam/core/Options.h>
#include <dyslam/core/Parallel.h>
#include <dyslam/core/Pose.h>

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace dyslam
{
enum class RefineMethod
{
  none,            //!< the guess is taken as it is; no map is kept
  point_to_plane,  //!< distance to the plane of the map's nearest surface element
  gicp             //!< distribution to distribution
};

/** Ini section `[refine]`. */
struct RefineOptions : Options
{
  RefineMethod method = RefineMethod::point_to_plane;
  double voxel_size = 0.5;         //!< of the map [m]
  double sample_voxel_size = 1.0;  //!< scan points are thinned to one per cube of this side [m]
  int max_points = 6000;           //!< cap on registered points per scan
  double map_radius = 100;         //!< farther map cells are dropped [m]
  int max_iterations = 12;

  void describe(OptionsVisitor& visitor) override;
};

struct RefineResult
{
  Pose T_odom_vehicle = Pose::Identity();
  /** Motion since the frame before. Its information is that of the registration to the map, of
   * r = log(T_measured^-1 T) at this frame: honest along directions the scene does not fix, where
   * it is small. */
  MotionEstimate motion;
  /** The scene leaves at least one direction of motion open; there the guess was kept. */
  bool degenerate = false;
  double threshold = 0;  //!< correspondence distance in force [m]
  std::size_t map_cells = 0;
};

/** Registration of each scan to a local map that it then joins: scan to map odometry.
 *
 * Points are weighted by static_confidence and 1 - moving_probability where the frame has them. Not
 * thread-safe. Same bytes for any number of threads.
 */
class LocalMapRefinement
{
 public:
  /** \throws UserError for options out of range. The pool must outlive the object. */
  LocalMapRefinement(const RefineOptions& options, ThreadPool& pool);
  ~LocalMapRefinement();
  LocalMapRefinement(LocalMapRefinement&&) noexcept;

  /** Register Frame::cloud, starting from a guess of the pose, and add it to the map.
   *
   * The first frame with points only starts the map, at the guess. On trouble the guess is kept,
   * motion.converged is false with a reason and the map stays as it is. */
  RefineResult refine(const Frame& frame, const Pose& T_odom_vehicle_guess);

  /** Pose after the last frame. */
  [[nodiscard]] const Pose& pose() const;
  /** Mean points of the map's cells, odom frame [m]; in a fixed order. */
  [[nodiscard]] std::vector<Eigen::Vector3f> mapPoints() const;
  void reset();

 private:
  struct State;
  std::unique_ptr<State> state_;
};
}  // namespace dyslam
