// SPDX-License-Identifier: BSD-3-Clause
#include "BagMotion.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Printable.h>
#include <dyslam/formats/RosPackets.h>

#include <algorithm>

#include "BagTopics.h"

namespace dyslam
{
BagMotion::BagMotion(const std::string& input,
                     const Bag& bag,
                     BagScans& lidar,
                     const BagFrames& frames,
                     const ScanConverterOptions& options,
                     ScanSink& sink)
    : bag_(bag), lidar_(lidar), frames_(frames), options_(options), sink_(sink)
{
  if (!options.imu_topic.empty())
  {
    requireLidarPackets(input);
    imu_ = topicNamed(input, bag, "--imu-topic", options.imu_topic,
                      [this](const BagTopic& topic) { return isImu(topic); });
  }
  if (!options.odometry_topic.empty())
  {
    odometry_ = topicNamed(input, bag, "--odometry-topic", options.odometry_topic, isRosTwist);
  }
  if (!options.gnss_topic.empty())
  {
    gnss_ = topicNamed(input, bag, "--gnss-topic", options.gnss_topic, isRosFix);
  }
  if (!options.imu_pose.empty())
  {
    T_vehicle_imu_ = poseFromOption("--imu-pose", options.imu_pose);
    imu_mounting_ = "mounted as --imu-pose states";
  }
}

void BagMotion::requireLidarPackets(const std::string& input) const
{
  const auto& topics = bag_.topics();
  const bool are_packets = std::any_of(
      topics.begin(), topics.end(),
      [this](const BagTopic& topic)
      { return topic.name == options_.imu_topic && packetMakerOf(topic) == PacketMaker::ouster; });
  if (are_packets && frames_.imu_packets.empty())
  {
    throw UserError(
        input + ": --imu-topic " + options_.imu_topic +
        ": packets of an IMU are read with those of its lidar; give their --topic, too");
  }
}

bool BagMotion::isImu(const BagTopic& topic) const
{
  return isRosImu(topic) ||
         std::any_of(frames_.imu_packets.begin(), frames_.imu_packets.end(),
                     [&](std::size_t packets) { return &bag_.topics()[packets] == &topic; });
}

std::vector<std::size_t> BagMotion::topicsWith(std::size_t scans) const
{
  std::vector<std::size_t> topics{scans};
  for (const auto& topic : {imu_, odometry_, gnss_})
  {
    if (topic)
    {
      topics.push_back(*topic);
    }
  }
  return topics;
}

void BagMotion::add(const BagMessage& message)
{
  if (message.topic == imu_)
  {
    addImu(message);
  }
  else if (message.topic == gnss_)
  {
    addFix(message);
  }
  else
  {
    addTwist(message);
  }
}

bool BagMotion::hasSamplesFrom(double stamp) const
{
  return (!imu_ || sink_.motion().hasImuFrom(stamp)) &&
         (!odometry_ || sink_.motion().hasWheelsFrom(stamp));
}

std::optional<Pose> BagMotion::mountingOf(const std::string& frame) const
{
  if (frame.empty() || frames_.lidar.empty())
  {
    return std::nullopt;
  }
  const auto T_lidar_frame = transformBetween(frames_.transforms, frames_.lidar, frame);
  return T_lidar_frame ? std::optional<Pose>(sink_.T_vehicle_lidar() * *T_lidar_frame)
                       : std::nullopt;
}

void BagMotion::mountImu(const std::string& frame)
{
  const std::optional<Pose> mounting = mountingOf(frame);
  imu_mounting_ =
      mounting ? "mounted as the bag states for the frames " + frame + " and " + frames_.lidar
               : "its axes are assumed to be those of the vehicle, as the bag does not "
                 "state how it is mounted (--imu-pose)";
  T_vehicle_imu_ = mounting.value_or(Pose::Identity());
}

void BagMotion::mountBody(const std::string& frame)
{
  const std::optional<Pose> mounting = mountingOf(frame);
  body_mounting_ = mounting
                       ? "of the frame " + frame
                       : "of the vehicle's origin, as the bag does not state where its frame is";
  T_vehicle_body_ = mounting.value_or(Pose::Identity());
}

void BagMotion::addImuPackets(const BagMessage& message)
{
  const std::vector<ImuSample> samples = lidar_.addImu(bag_.topics()[message.topic], message);
  for (ImuSample sample : samples)
  {
    if (!T_vehicle_imu_)
    {
      T_vehicle_imu_ = sink_.T_vehicle_lidar() * sample.T_vehicle_imu;
      imu_mounting_ = "mounted as the metadata of the lidar state";
    }
    sample.T_vehicle_imu = *T_vehicle_imu_;
    sink_.add(sample);
  }
}

void BagMotion::addImu(const BagMessage& message)
{
  if (!isRosImu(bag_.topics()[message.topic]))
  {
    addImuPackets(message);
    return;
  }
  const std::optional<RosImu> imu = decodeRosImu(bag_.topics()[message.topic], message);
  if (!imu)
  {
    ++imu_left_out_;
    return;
  }
  if (!T_vehicle_imu_)
  {
    mountImu(imu->frame);
  }
  sink_.add(ImuSample{imu->stamp, imu->angular_velocity, imu->acceleration, *T_vehicle_imu_});
}

void BagMotion::addTwist(const BagMessage& message)
{
  const std::optional<RosTwist> twist = decodeRosTwist(bag_.topics()[message.topic], message);
  if (!twist)
  {
    ++twists_left_out_;
    return;
  }
  if (!T_vehicle_body_)
  {
    mountBody(twist->frame);
  }
  Vector6 measured;
  measured << twist->linear, twist->angular;
  if (const auto velocity = velocities_.add(twist->stamp, measured, twist->T_parent_body))
  {
    sink_.add(wheelSampleOf(*velocity));
  }
}

void BagMotion::addFix(const BagMessage& message)
{
  const std::optional<RosFix> fix =
      decodeRosFix(bag_.topics()[message.topic], message, &fixes_swapped_);
  if (!fix)
  {
    ++fixes_left_out_;
    return;
  }
  if (!T_vehicle_antenna_)
  {
    const std::optional<Pose> mounting = mountingOf(fix->frame);
    antenna_mounting_ = mounting ? "antenna at the frame " + fix->frame
                                 : "antenna assumed at the vehicle's origin, as the bag does not "
                                   "state where it is";
    T_vehicle_antenna_ = mounting.value_or(Pose::Identity());
  }
  sink_.add(GnssFix{fix->stamp, fix->position, fix->horizontal_sigma, fix->vertical_sigma,
                    T_vehicle_antenna_->translation()});
}

WheelSample BagMotion::wheelSampleOf(const StampedVelocity& body) const
{
  // The vehicle's origin is at -t from the body's, in the vehicle's axes.
  const Eigen::Vector3d rotation = T_vehicle_body_->linear() * body.velocity.tail<3>();
  const Eigen::Vector3d velocity = T_vehicle_body_->linear() * body.velocity.head<3>() -
                                   rotation.cross(T_vehicle_body_->translation());
  return {body.stamp, velocity.x(), rotation.z()};
}

void BagMotion::report()
{
  if (imu_)
  {
    reportTopic("IMU: ", options_.imu_topic, imu_mounting_, sink_.motion().imu());
    reportLeftOut(options_.imu_topic, "an angular velocity", imu_left_out_);
  }
  else
  {
    noteImuTopics();
  }
  if (odometry_)
  {
    reportTopic("wheel odometry: ", options_.odometry_topic, body_mounting_,
                sink_.motion().wheels());
    reportLeftOut(options_.odometry_topic, "a velocity", twists_left_out_);
    if (velocities_.replacesZeros())
    {
      sink_.note("the velocities of " + options_.odometry_topic +
                 " are all zero: the differences of its poses are taken instead");
    }
  }
  if (gnss_)
  {
    reportTopic("satellite receiver: ", options_.gnss_topic, antenna_mounting_,
                sink_.motion().gnss());
    reportLeftOut(options_.gnss_topic, "a fix", fixes_left_out_ - fixes_swapped_);
    if (fixes_swapped_ > 0)
    {
      sink_.warn(options_.gnss_topic + ": " + counted(fixes_swapped_, "message") +
                 " with a latitude beyond 90 degrees left out: its driver seems to swap latitude "
                 "and longitude");
    }
  }
  else
  {
    noteGnssTopics();
  }
}

void BagMotion::reportTopic(const std::string& kind,
                            const std::string& name,
                            const std::string& mounting,
                            const MotionSampleWriter::Written& written)
{
  if (written.samples > 0)
  {
    sink_.note(kind + name + ", " + counted(written.samples, "sample") + "; " + mounting);
  }
  if (written.scans == 0)
  {
    sink_.warn(
        name + ": has no sample at the times of the scans" +
        (written.samples > 0 ? ", all are more than 0.25 s older; is it on another clock?" : ""));
  }
}

void BagMotion::reportLeftOut(const std::string& name, const std::string& what, std::size_t count)
{
  if (count > 0)
  {
    sink_.warn(name + ": " + counted(count, "message") + " without " + what + " left out");
  }
}

void BagMotion::noteGnssTopics()
{
  const std::string names =
      namesOf(bag_, [](const BagTopic& topic) { return isRosFix(topic) && topic.messages > 0; });
  if (!names.empty())
  {
    sink_.note("--gnss-topic adds the positions of a satellite receiver: " + names);
  }
}

void BagMotion::noteImuTopics()
{
  const std::string names =
      namesOf(bag_, [this](const BagTopic& topic) { return isImu(topic) && topic.messages > 0; });
  if (!names.empty())
  {
    const bool one = names.find(", ") == std::string::npos;
    sink_.note(one ? "--imu-topic " + names + " adds the gyroscope"
                   : "--imu-topic adds the gyroscope: one of " + names);
  }
}
}  // namespace dyslam
