// SPDX-License-Identifier: BSD-3-Clause
#include "BagOutput.h"

#include <algorithm>

namespace dyslam
{
void BagOutput::write(const BagOutputTopic& topic, double stamp, const std::string& data)
{
  auto known = topics_.find(topic.name);
  if (known == topics_.end())
  {
    const std::size_t number = writer_.addTopic(
        {topic.name, rosTypeName(topic.type), rosDefinition(topic.type), topic.latched});
    known = topics_.emplace(topic.name, number).first;
  }
  writer_.write(known->second, rosNanoseconds(stamp), data);
}

void BagOutput::place(const std::string& frame, const Pose& T_vehicle_sensor)
{
  const auto known = std::find_if(sensors_.begin(), sensors_.end(),
                                  [&frame](const RosPose& pose) { return pose.child == frame; });
  if (known == sensors_.end())
  {
    sensors_.push_back({0, vehicle_name, frame, T_vehicle_sensor});
    sensors_changed_ = true;
  }
  else if (known->pose.matrix() != T_vehicle_sensor.matrix())
  {
    known->pose = T_vehicle_sensor;
    sensors_changed_ = true;
  }
}

void BagOutput::writeSensors(double stamp)
{
  if (!sensors_changed_)
  {
    return;
  }
  for (RosPose& sensor : sensors_)
  {
    sensor.stamp = stamp;
  }
  write({"/tf_static", RosType::transforms, true}, stamp, transformsMessage(sensors_));
  sensors_changed_ = false;
}
}  // namespace dyslam
