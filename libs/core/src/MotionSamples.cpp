// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/StateArchive.h>
#include <dyslam/core/MotionSamples.h>

namespace dyslam
{
void ImuSample::exchangeState(StateArchive& archive)
{
  archive(stamp, angular_velocity, acceleration, T_vehicle_imu);
}
}  // namespace dyslam
