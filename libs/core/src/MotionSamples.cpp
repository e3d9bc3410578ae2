// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/MotionSamples.h>
#include <dyslam/core/StateArchive.h>

namespace dyslam
{
void ImuSample::exchangeState(StateArchive& archive)
{
  archive(stamp, angular_velocity, acceleration, T_vehicle_imu);
}
}  // namespace dyslam
