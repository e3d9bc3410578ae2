// SPDX-License-Identifier: BSD-3-Clause
#include "SampleMessages.h"

#include <algorithm>
#include <utility>

namespace dyslam
{
void SampleMessages::push(double stamp, const BagOutputTopic& topic, std::string data)
{
  const auto later =
      std::upper_bound(waiting_.begin(), waiting_.end(), stamp,
                       [](double value, const Message& message) { return value < message.stamp; });
  waiting_.insert(later, {stamp, topic, std::move(data)});
}

void SampleMessages::take(const Frame& frame, BagOutput& bag)
{
  for (const ImuSample& sample : frame.imu)
  {
    if (sample.stamp >= 0)
    {
      bag.place("imu", sample.T_vehicle_imu);
      push(sample.stamp, {"/imu", RosType::imu},
           imuMessage({sample.stamp, "imu", sample.angular_velocity, sample.acceleration}));
    }
  }
  for (const GnssFix& fix : frame.gnss)
  {
    if (fix.stamp >= 0)
    {
      Pose T_vehicle_antenna = Pose::Identity();
      T_vehicle_antenna.translation() = fix.antenna;
      bag.place("gnss", T_vehicle_antenna);
      push(fix.stamp, {"/gnss", RosType::nav_sat_fix},
           fixMessage({fix.stamp, "gnss", fix.position, fix.horizontal_sigma, fix.vertical_sigma}));
    }
  }
  for (const WheelSample& sample : frame.wheels)
  {
    if (sample.stamp >= 0)
    {
      RosTwist twist;
      twist.stamp = sample.stamp;
      twist.frame = vehicle_name;
      twist.linear.x() = sample.forward_speed;
      twist.angular.z() = sample.yaw_rate;
      push(sample.stamp, {"/wheels", RosType::twist_stamped}, twistMessage(twist));
    }
  }
}

void SampleMessages::writeUpTo(double stamp, BagOutput& bag)
{
  auto next = waiting_.begin();
  for (; next != waiting_.end() && next->stamp <= stamp; ++next)
  {
    bag.write(next->topic, next->stamp, next->data);
  }
  waiting_.erase(waiting_.begin(), next);
}
}  // namespace dyslam
