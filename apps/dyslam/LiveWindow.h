// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>
#include <dyslam/io/LiveScene.h>
#include <dyslam/window/SceneWindow.h>

#include <functional>
#include <memory>

namespace dyslam
{
/** The window of `dyslam --window`, which shows the run while it goes on. */
class LiveWindow
{
 public:
  /** Opens the window. \throws UserError if that is not possible. */
  LiveWindow();

  /** Shows the run up to this frame; does nothing once the user has closed the window. */
  void show(const Frame& frame);
  /** Waits until the user closes the window, or `stop` returns true. */
  void waitUntilClosed(const std::function<bool()>& stop) const;

 private:
  std::unique_ptr<SceneWindow> window_;
  LiveScene scene_;
};
}  // namespace dyslam
