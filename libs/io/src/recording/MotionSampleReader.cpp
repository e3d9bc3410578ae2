// SPDX-License-Identifier: BSD-3-Clause
#include "MotionSampleReader.h"

#include <dyslam/io/RawlogSource.h>
#include <dyslam/io/ScanDecoder.h>
#include <dyslam/mrpt/Conversions.h>

#include <algorithm>
#include <cmath>

namespace dyslam
{
namespace
{
using mrpt::obs::CObservationGPS;
using mrpt::obs::CObservationIMU;
using mrpt::obs::CObservationOdometry;

std::optional<Eigen::Vector3d> vectorOf(const CObservationIMU& observation,
                                        mrpt::obs::TIMUDataIndex x,
                                        mrpt::obs::TIMUDataIndex y,
                                        mrpt::obs::TIMUDataIndex z)
{
  if (!observation.has(x) || !observation.has(y) || !observation.has(z))
  {
    return std::nullopt;
  }
  const Eigen::Vector3d vector(observation.get(x), observation.get(y), observation.get(z));
  return vector.allFinite() ? std::make_optional(vector) : std::nullopt;
}

/** With the stamp as recorded; nothing without a whole angular velocity. */
std::optional<ImuSample> sampleOf(const CObservationIMU& observation)
{
  const auto angular_velocity =
      vectorOf(observation, mrpt::obs::IMU_WX, mrpt::obs::IMU_WY, mrpt::obs::IMU_WZ);
  ImuSample sample;
  sample.T_vehicle_imu = toPose(observation.sensorPose);
  if (!angular_velocity || !sample.T_vehicle_imu.matrix().allFinite())
  {
    return std::nullopt;
  }
  sample.stamp = toStamp(observation.timestamp);
  sample.angular_velocity = *angular_velocity;
  sample.acceleration =
      vectorOf(observation, mrpt::obs::IMU_X_ACC, mrpt::obs::IMU_Y_ACC, mrpt::obs::IMU_Z_ACC);
  return sample;
}

/** Along the vehicle's axes; nothing if the observation has none. */
std::optional<Vector6> velocityOf(const CObservationOdometry& observation)
{
  if (!observation.hasVelocities)
  {
    return std::nullopt;
  }
  const mrpt::math::TTwist2D& twist = observation.velocityLocal;
  Vector6 velocity = Vector6::Zero();
  velocity[0] = twist.vx;
  velocity[1] = twist.vy;
  velocity[5] = twist.omega;
  return velocity;
}

/** Nothing if the observation has no message of the class. */
template <typename Message>
const Message* messageOf(const CObservationGPS& observation)
{
  return observation.hasMsgClass<Message>() ? &observation.getMsgByClass<Message>() : nullptr;
}

/** With the stamp as recorded; nothing without a position. */
std::optional<GnssFix> fixOf(const CObservationGPS& observation)
{
  const auto* message = messageOf<mrpt::obs::gnss::Message_NMEA_GGA>(observation);
  if (message == nullptr || message->fields.fix_quality == 0)
  {
    return std::nullopt;
  }
  const auto& fields = message->fields;
  GnssFix fix;
  fix.stamp = toStamp(observation.timestamp);
  fix.position = {fields.latitude_degrees, fields.longitude_degrees,
                  fields.altitude_meters + fields.geoidal_distance};
  fix.antenna = toPose(observation.sensorPose).translation();
  if (const auto* best = messageOf<mrpt::obs::gnss::Message_NV_OEM6_BESTPOS>(observation))
  {
    const double horizontal = 0.5 * (best->fields.lat_sigma + best->fields.lon_sigma);
    const double vertical = best->fields.hgt_sigma;
    if (horizontal > 0 && vertical > 0 && std::isfinite(horizontal + vertical))
    {
      fix.horizontal_sigma = horizontal;
      fix.vertical_sigma = vertical;
    }
  }
  return isOnEarth(fix.position) && fix.antenna.allFinite() ? std::optional(fix) : std::nullopt;
}

Pose poseOf(const CObservationOdometry& observation)
{
  const mrpt::poses::CPose2D& pose = observation.odometry;
  return poseFromYpr(pose.x(), pose.y(), 0, pose.phi(), 0, 0);
}
}  // namespace

bool SensorChoice::takes(const std::string& label, RecordingNotes& notes)
{
  if (!pattern_.fits(label))
  {
    return false;
  }
  chosen_ = chosen_.value_or(label);
  if (label != *chosen_)
  {
    notes.add("samples of '" + label + "' are ignored: '" + *chosen_ +
              "' came first; choose with " + pattern_.option());
    return false;
  }
  return true;
}

template <typename Sample>
void SampleQueue<Sample>::push(const Sample& sample)
{
  waiting_.push_back(sample);
  if (waiting_.size() > most)
  {
    waiting_.pop_front();
  }
}

template <typename Sample>
void SampleQueue<Sample>::shiftClock(double shift)
{
  std::optional<double> before = last_stamp_;
  std::size_t begin = waiting_.size();
  double farthest = 0;
  for (std::size_t i = 0; i < waiting_.size(); ++i)
  {
    const double back = before.value_or(waiting_[i].stamp) - waiting_[i].stamp;
    if (back > farthest)
    {
      begin = i;
      farthest = back;
    }
    before = waiting_[i].stamp;
  }
  for (; begin < waiting_.size(); ++begin)
  {
    waiting_[begin].stamp += shift;
  }
}

/** A sample that is far ahead of the scans must not make those behind it count as old. */
template <typename Sample>
bool SampleQueue<Sample>::isNear(const Sample& sample, double stamp)
{
  return sample.stamp >= stamp - memory && sample.stamp <= stamp + longest_lead;
}

template <typename Sample>
bool SampleQueue<Sample>::isFar(double stamp) const
{
  return !waiting_.empty() &&
         std::none_of(waiting_.begin(), waiting_.end(),
                      [stamp](const Sample& sample) { return isNear(sample, stamp); });
}

template <typename Sample>
std::vector<Sample> SampleQueue<Sample>::takeNear(double stamp, bool leaves_later)
{
  std::vector<Sample> samples;
  std::deque<Sample> left;
  for (const Sample& sample : waiting_)
  {
    if (!isNear(sample, stamp) || (last_stamp_ && sample.stamp <= *last_stamp_))
    {
      continue;
    }
    if (leaves_later && sample.stamp > stamp)
    {
      left.push_back(sample);
      continue;
    }
    last_stamp_ = sample.stamp;
    samples.push_back(sample);
  }
  waiting_ = std::move(left);
  return samples;
}

MotionSampleReader::MotionSampleReader(const RawlogSourceOptions& options)
    : imu_choice_(LabelPattern("imu_label", options.imu_label)),
      wheel_choice_(LabelPattern("odometry_label", options.odometry_label)),
      gnss_choice_(LabelPattern("gnss_label", options.gnss_label))
{
}

template <typename Sample>
void MotionSampleReader::takeSample(std::optional<Sample> sample,
                                    const mrpt::obs::CObservation& observation,
                                    SensorChoice& choice,
                                    SampleQueue<Sample>& queue,
                                    double clock_shift,
                                    RecordingNotes& notes)
{
  if (sample && observation.timestamp != INVALID_TIMESTAMP &&
      choice.takes(observation.sensorLabel, notes))
  {
    sample->stamp += clock_shift;
    queue.push(*sample);
  }
}

bool MotionSampleReader::take(const mrpt::obs::CObservation& observation,
                              double clock_shift,
                              RecordingNotes& notes)
{
  if (const auto* imu = dynamic_cast<const CObservationIMU*>(&observation))
  {
    takeSample(sampleOf(*imu), observation, imu_choice_, imu_, clock_shift, notes);
    return true;
  }
  if (const auto* odometry = dynamic_cast<const CObservationOdometry*>(&observation))
  {
    takeOdometry(*odometry, clock_shift, notes);
    return true;
  }
  if (const auto* gps = dynamic_cast<const CObservationGPS*>(&observation))
  {
    takeSample(fixOf(*gps), observation, gnss_choice_, gnss_, clock_shift, notes);
    return true;
  }
  return false;
}

void MotionSampleReader::takeOdometry(const CObservationOdometry& observation,
                                      double clock_shift,
                                      RecordingNotes& notes)
{
  if (observation.timestamp == INVALID_TIMESTAMP ||
      !wheel_choice_.takes(observation.sensorLabel, notes))
  {
    return;
  }
  const std::optional<Vector6> measured = velocityOf(observation);
  if (measured && !measured->allFinite())
  {
    return;
  }
  if (const auto body =
          velocities_.add(toStamp(observation.timestamp), measured, poseOf(observation)))
  {
    wheels_.push({body->stamp + clock_shift, body->velocity[0], body->velocity[5]});
  }
}

void MotionSampleReader::shiftClock(double shift)
{
  gnss_.shiftClock(shift);
  imu_.shiftClock(shift);
  wheels_.shiftClock(shift);
}

void MotionSampleReader::handOver(double stamp, RecordedScan& scan, RecordingNotes& notes)
{
  const auto noteFar = [&](bool is_far, const SensorChoice& choice)
  {
    if (is_far)
    {
      notes.add("samples of '" + choice.label() +
                "' are ignored: their times are more than 10 s before or 1 s after those of the "
                "scans");
    }
  };
  noteFar(imu_.isFar(stamp), imu_choice_);
  noteFar(wheels_.isFar(stamp), wheel_choice_);
  noteFar(gnss_.isFar(stamp), gnss_choice_);
  const bool was_late = scan.late_shift != 0;
  scan.imu = imu_.takeNear(stamp, was_late);
  scan.wheels = wheels_.takeNear(stamp, was_late);
  scan.gnss = gnss_.takeNear(stamp, was_late);
}

std::vector<std::string> MotionSampleReader::missing() const
{
  std::vector<std::string> lines;
  for (const SensorChoice* choice : {&imu_choice_, &wheel_choice_, &gnss_choice_})
  {
    if (choice->misses())
    {
      lines.push_back(choice->pattern().option() + " = " + choice->pattern().pattern() +
                      " matches the label of no such sensor in the recording");
    }
  }
  return lines;
}
}  // namespace dyslam
