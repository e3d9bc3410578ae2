// SPDX-License-Identifier: BSD-3-Clause
#include "ObservationOutput.h"

#include <dyslam/mrpt/Conversions.h>
#include <mrpt/serialization/CArchive.h>

namespace dyslam
{
void writeObject(const mrpt::serialization::CSerializable& object, GzOutput& file)
{
  auto archive = mrpt::serialization::archiveFrom(file);
  archive << object;
  file.check();
}

mrpt::obs::CObservationRobotPose robotPose(double stamp,
                                           const std::string& label,
                                           const Pose& T_world_vehicle)
{
  mrpt::obs::CObservationRobotPose observation;
  observation.timestamp = toMrptTime(stamp);
  observation.sensorLabel = label;
  observation.pose.mean = toMrpt(T_world_vehicle);
  observation.pose.cov.setZero();
  return observation;
}
}  // namespace dyslam
