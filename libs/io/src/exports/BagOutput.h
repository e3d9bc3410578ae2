// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Pose.h>
#include <dyslam/formats/BagWriter.h>
#include <dyslam/formats/RosWriter.h>

#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace dyslam
{
constexpr const char* vehicle_name = "base_link";  //!< the vehicle

/** A topic of the exported bag. */
struct BagOutputTopic
{
  const char* name;
  RosType type;
  bool latched = false;  //!< as in BagWriterTopic
};

/** The exported bag with its sensors' places on the vehicle. */
class BagOutput
{
 public:
  explicit BagOutput(const std::string& path) : writer_(path) {}

  /** Writes a message. \param stamp of its header [s] */
  void write(const BagOutputTopic& topic, double stamp, const std::string& data);

  /** Sets the pose of a sensor on the vehicle, for the next call of writeSensors(). \param frame of
   * the sensor: "lidar" */
  void place(const std::string& frame, const Pose& T_vehicle_sensor);
  /** Writes the poses of all sensors to `/tf_static` if one is new. \param stamp [s] */
  void writeSensors(double stamp);

  void close() { writer_.close(); }

 private:
  BagWriter writer_;
  std::map<std::string, std::size_t> topics_;  //!< numbers, by name
  std::vector<RosPose> sensors_;               //!< in the order of their first use
  bool sensors_changed_ = false;
};
}  // namespace dyslam
