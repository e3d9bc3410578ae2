// SPDX-License-Identifier: BSD-3-Clause
#include "LiveWindow.h"

#include <chrono>
#include <thread>

namespace dyslam
{
LiveWindow::LiveWindow() : window_(openSceneWindow("DySLAM", "--window")) {}

void LiveWindow::show(const Frame& frame)
{
  if (window_->isOpen())
  {
    const auto scene = scene_.add(frame);
    window_->show(scene, scene_.vehiclePosition());
  }
}

void LiveWindow::waitUntilClosed(const std::function<bool()>& stop) const
{
  constexpr std::chrono::milliseconds step(50);
  while (window_->isOpen() && !stop())
  {
    std::this_thread::sleep_for(step);
  }
}
}  // namespace dyslam
