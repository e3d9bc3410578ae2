// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>
#include <dyslam/sim/Simulator.h>

#include <utility>
#include <vector>

namespace dyslam::test
{
/** The first frames of a simulated recording, with ground truth and the samples of motion sensors.
 */
inline std::vector<Frame> simulatedFrames(const sim::SimulatorOptions& options, std::size_t count)
{
  sim::Simulator simulator(options, 2);
  std::vector<Frame> frames(count);
  for (std::size_t i = 0; i < count; ++i)
  {
    auto simulated = simulator.next();
    frames[i].index = i;
    frames[i].T_world_vehicle_truth = simulated.T_map_vehicle;
    frames[i].scan = std::move(simulated.scan);
    frames[i].imu = std::move(simulated.imu);
    frames[i].wheels = std::move(simulated.wheels);
  }
  return frames;
}
}  // namespace dyslam::test
