// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>

#include <Eigen/Core>
#include <memory>

namespace mrpt::opengl
{
class COpenGLScene;
}

namespace dyslam
{
/** What a window shows while a run goes on, in the odometry frame: the static points of the last
 * 200 m of the way, coloured by height, with one point per cube of 0.25 m; the moving points of the
 * newest scan, boxes of the reported objects with ids, speeds and velocity arrows, and the
 * trajectory.
 *
 * The frames are causal: the map has points that are removed from the final one, and no loops. */
class LiveScene
{
 public:
  LiveScene();
  ~LiveScene();
  LiveScene(LiveScene&&) noexcept;
  LiveScene& operator=(LiveScene&&) noexcept;

  /** Adds a frame; one of an index that is not higher than the last one begins a new scene.
   * \return a new scene of it, which shares the earlier points with those before */
  [[nodiscard]] std::shared_ptr<mrpt::opengl::COpenGLScene> add(const Frame& frame);
  /** Position of the vehicle in the last scene [m]. */
  [[nodiscard]] Eigen::Vector3d vehiclePosition() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};
}  // namespace dyslam
