// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>

namespace mrpt::opengl
{
class COpenGLScene;
}

namespace dyslam
{
/** A window with a 3D scene, turned, moved and zoomed with the mouse. It has a thread of its own,
 * which draws. */
class SceneWindow
{
 public:
  SceneWindow() = default;
  virtual ~SceneWindow() = default;
  SceneWindow(const SceneWindow&) = delete;
  SceneWindow& operator=(const SceneWindow&) = delete;

  /** False once the user has closed it. */
  [[nodiscard]] virtual bool isOpen() const = 0;
  /** Draws another scene; waits while the last one is being drawn. Does nothing once the window is
   * closed. \param centre point of the scene that the camera follows [m]: where the user has moved
   * the camera, it keeps the distance to it */
  virtual void show(const std::shared_ptr<mrpt::opengl::COpenGLScene>& scene,
                    const Eigen::Vector3d& centre) = 0;
};

/** Opens a window, by the runtime module `window`. \param needed_by option that asks for it, for
 * the message \throws UserError if there is no display, or the module cannot be loaded. */
[[nodiscard]] std::unique_ptr<SceneWindow> openSceneWindow(const std::string& title,
                                                           const std::string& needed_by);

/** The function `dyslam_open_window` of the module; null if no window can be opened. */
using OpenSceneWindow = SceneWindow*(const std::string& title);
}  // namespace dyslam
