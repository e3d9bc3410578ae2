// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Environment.h>
#include <dyslam/base/Error.h>
#include <dyslam/base/RuntimeModule.h>
#include <dyslam/window/SceneWindow.h>

namespace dyslam
{
std::unique_ptr<SceneWindow> openSceneWindow(const std::string& title, const std::string& needed_by)
{
  const std::string advice =
      "; run on a machine with a screen, over ssh -X, or without " + needed_by;
  const std::string display = environmentValue("DISPLAY");
  const std::string wayland = environmentValue("WAYLAND_DISPLAY");
  if (display.empty() && wayland.empty())
  {
    throw UserError(needed_by + ": there is no display (DISPLAY is not set)" + advice);
  }
  auto* open = runtimeModuleFunction<OpenSceneWindow>("window", "dyslam_open_window", needed_by);
  std::unique_ptr<SceneWindow> window(open(title));
  if (!window)
  {
    throw UserError(needed_by + ": no window can be opened on the display " +
                    (display.empty() ? wayland : display) + advice);
  }
  return window;
}
}  // namespace dyslam
