// SPDX-License-Identifier: BSD-3-Clause
// The observations of inertial measurement units, wheel odometry and satellite receivers.
#include <stdexcept>

#include "ObjectLayout.h"

namespace dyslam
{
bool ObjectLayout::knowsMotionSensor(const ObjectHeader& header)
{
  const auto& [name, version] = header;
  return (name == "CObservationIMU" && version >= 1 && version <= 4) ||
         (name == "CObservationOdometry" && version <= 2) ||
         (name == "CObservationGPS" && version >= 10 && version <= 11);
}

void ObjectLayout::motionSensor(const ObjectHeader& header)
{
  if (header.class_name == "CObservationIMU")
  {
    inertial(header.version);
  }
  else if (header.class_name == "CObservationGPS")
  {
    satelliteReceiver(header.version);
  }
  else
  {
    wheelOdometry(header.version);
  }
  end();
}

void ObjectLayout::label()
{
  constexpr std::uint32_t longest = 1U << 16U;
  const std::uint32_t size = in_.u32();
  if (size > longest || in_.ahead(size).size() < size)
  {
    throw std::runtime_error("a label of " + std::to_string(size) + " characters");
  }
  in_.skip(size);
}

/** How many values the observation has, from its count before version 4. */
std::uint32_t ObjectLayout::inertialValues(int version)
{
  constexpr std::uint32_t most = 31;  // MRPT's arrays
  const std::uint32_t count = version >= 4 ? most : in_.u32();
  if (count > most)
  {
    throw std::runtime_error("a CObservationIMU of " + std::to_string(count) + " values");
  }
  return count;
}

void ObjectLayout::inertial(int version)
{
  pose();
  flags(static_cast<int>(inertialValues(version)));
  in_.skip(sizeof(std::uint64_t));  // time stamp
  in_.skipAll(inertialValues(version), sizeof(double));
  label();
}

void ObjectLayout::wheelOdometry(int version)
{
  const ObjectHeader found = headerOf("CPose2D", 1);
  in_.skipAll(3, found.version == 0 ? sizeof(float) : sizeof(double));
  end();
  label();
  in_.skip(sizeof(std::uint64_t));  // time stamp
  if (version == 0)
  {
    return;
  }
  const bool has_encoders = flag();
  in_.skipAll(has_encoders || version < 2 ? 2 : 0, sizeof(std::int32_t));
  const bool has_velocities = flag();
  if (version < 2)
  {
    in_.skipAll(2, sizeof(float));
  }
  else
  {
    in_.skipAll(has_velocities ? 3 : 0, sizeof(double));
  }
}

void ObjectLayout::satelliteReceiver(int version)
{
  constexpr std::uint32_t most_messages = 1000;
  constexpr std::uint32_t longest_message = 1U << 16U;
  // Messages of other kinds have parts whose sizes would have to be checked one by one.
  constexpr std::int32_t first_nmea = 10;
  constexpr std::int32_t last_nmea = 17;
  constexpr std::int32_t best_position = 1042;
  in_.skipAll(2, sizeof(std::uint64_t));  // time stamps
  label();
  pose();
  if (version >= 11)
  {
    (void)flag();
  }
  const std::uint32_t messages = in_.u32();
  for (std::uint32_t i = 0; i < messages; ++i)
  {
    const auto kind = static_cast<std::int32_t>(in_.u32());
    const std::uint32_t size = in_.u32();
    const bool is_known = (kind >= first_nmea && kind <= last_nmea) || kind == best_position;
    if (messages > most_messages || !is_known || size > longest_message)
    {
      throw std::runtime_error("a message of a satellite receiver of kind " + std::to_string(kind) +
                               " and " + std::to_string(size) + " bytes");
    }
    in_.skip(size);
  }
}
}  // namespace dyslam
