// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/StateArchive.h>
#include <dyslam/formats/ExternalFiles.h>
#include <dyslam/formats/TextFile.h>
#include <dyslam/io/GzOutput.h>
#include <dyslam/io/RawlogWriter.h>
#include <dyslam/mrpt/Conversions.h>
#include <mrpt/maps/CPointsMapXYZI.h>
#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/obs/CObservationGPS.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationPointCloud.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <set>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

#include "ObservationOutput.h"
#include "ObservationScans.h"

namespace dyslam
{
namespace fs = std::filesystem;
using mrpt::obs::CObservationPointCloud;

namespace
{
/** Stands for "no time" in the time and ring cloud; no ring is -1. */
constexpr float no_time = std::numeric_limits<float>::quiet_NaN();

constexpr const char* cloud_ending = ".gz";  //!< of an externally stored cloud

/** Whether a file has a name as putExternally() gives it: `<label>_NNNNNN.gz`. */
bool isCloudName(const std::string& name)
{
  const auto at = name.rfind('_');
  if (at == std::string::npos || at == 0)
  {
    return false;
  }
  const std::string numbered = name.substr(at + 1);
  const auto number = numberOfName(numbered, cloud_ending);
  return number && numbered == numberedName(static_cast<std::size_t>(*number), cloud_ending);
}

template <typename Map>
typename Map::Ptr pointsMap(const Scan& scan)
{
  auto map = Map::Create();
  map->resize(scan.size());
  for (std::size_t i = 0; i < scan.size(); ++i)
  {
    map->setPointFast(i, scan.points[i].x(), scan.points[i].y(), scan.points[i].z());
  }
  return map;
}

mrpt::maps::CPointsMap::Ptr cloudOf(const Scan& scan)
{
  if (scan.intensity.empty())
  {
    return pointsMap<mrpt::maps::CSimplePointsMap>(scan);
  }
  auto map = pointsMap<mrpt::maps::CPointsMapXYZI>(scan);
  for (std::size_t i = 0; i < scan.size(); ++i)
  {
    map->setPointColor_fast(i, scan.intensity[i], 0, 0);
  }
  return map;
}

mrpt::maps::CPointsMap::Ptr timeRingOf(const Scan& scan)
{
  auto map = mrpt::maps::CSimplePointsMap::Create();
  map->resize(scan.size());
  for (std::size_t i = 0; i < scan.size(); ++i)
  {
    map->setPointFast(i, scan.time.empty() ? no_time : scan.time[i],
                      scan.ring.empty() ? -1.0F : static_cast<float>(scan.ring[i]), 0);
  }
  return map;
}

void requireSameLength(const Scan& scan)
{
  for (const std::size_t size : {scan.intensity.size(), scan.time.size(), scan.ring.size()})
  {
    if (size != 0 && size != scan.size())
    {
      throw std::logic_error("Scan's arrays differ in length");
    }
  }
}

void setVector(mrpt::obs::CObservationIMU& observation,
               mrpt::obs::TIMUDataIndex x,
               mrpt::obs::TIMUDataIndex y,
               mrpt::obs::TIMUDataIndex z,
               const Eigen::Vector3d& vector)
{
  observation.set(x, vector.x());
  observation.set(y, vector.y());
  observation.set(z, vector.z());
}
}  // namespace

void RawlogWriterOptions::describe(OptionsVisitor& visitor)
{
  visitor.flag("external_storage", external_storage,
               "write clouds as .bin files in <name>_Images/");
  visitor.integer("compression_level", compression_level, 0, 9,
                  "level of the gzip compression: 0 none, 1 fast, 9 small");
  visitor.text("sensor_label", sensor_label, "sensor label of scans that have none");
  visitor.text("ground_truth_label", ground_truth_label, "sensor label of the true poses");
}

struct RawlogWriter::Impl
{
  std::string path;
  RawlogWriterOptions options;
  GzOutput file;
  std::size_t frames = 0;
  bool finished = false;
  bool closed = false;
  std::vector<std::string> external;       //!< names of the clouds' files
  std::optional<WheelSample> wheels;       //!< the last one
  Pose T_odom_vehicle = Pose::Identity();  //!< at that one, integrated from the first

  Impl(const std::string& path_in, const RawlogWriterOptions& options_in)
      : path(path_in),
        options(options_in),
        file(path_in,
             options_in.compression_level,
             options_in.growing ? FileName::at_start : FileName::at_end)
  {
    if (options.external_storage && options.growing)
    {
      throw std::logic_error("a growing rawlog has no external storage");
    }
    if (options.external_storage)
    {
      fs::remove_all(pendingFolder());  // of a killed program
      makeFolder(pendingFolder());
    }
  }
  Impl(const std::string& path_in, const RawlogWriterOptions& options_in, StateArchive& saved)
      : path(path_in), options(options_in), file(path_in, options_in.compression_level, saved)
  {
    saved(frames, external, wheels, T_odom_vehicle);
  }
  ~Impl()
  {
    if (options.external_storage)
    {
      std::error_code ignored;
      fs::remove_all(pendingFolder(), ignored);
    }
  }

  /** Folder of external clouds until the rawlog is complete. */
  [[nodiscard]] std::string pendingFolder() const { return externalStorageFolder(path) + ".tmp"; }

  /** An earlier rawlog whose clouds are replaced is removed before: a killed program must not leave
   * it with the clouds of another. */
  void installClouds() const
  {
    const fs::path folder = externalStorageFolder(path);
    makeFolder(folder.string());
    const bool are_replaced =
        std::any_of(external.begin(), external.end(),
                    [&folder](const std::string& name) { return fs::exists(folder / name); });
    if (are_replaced)
    {
      std::error_code ignored;
      fs::remove(path, ignored);
    }
    for (const std::string& name : external)
    {
      std::error_code error;
      fs::rename(fs::path(pendingFolder()) / name, folder / name, error);
      if (error)
      {
        throw UserError((folder / name).string() + ": cannot be written: " + error.message());
      }
    }
  }

  /** Removes the clouds of an earlier rawlog of the name, which this one does not refer to; files
   * of other names and a folder behind a link stay. */
  void removeEarlierClouds() const
  {
    const std::string folder = externalStorageFolder(path);
    std::error_code ignored;
    if (fs::is_symlink(fs::symlink_status(folder, ignored)))
    {
      return;
    }
    const std::set<std::string> own(external.begin(), external.end());
    for (const auto& entry : entriesIfReadable(folder))
    {
      const std::string name = entry.path().filename().string();
      if (isCloudName(name) && own.count(name) == 0)
      {
        fs::remove(entry.path(), ignored);
      }
    }
  }

  /** \param what is to be written at that time [s], for messages */
  void requireWritable(double stamp, const std::string& what) const
  {
    if (finished || closed)
    {
      throw std::logic_error("RawlogWriter is closed");
    }
    // Ticks of 100 ns in 64 bits; a stamp far outside is no time.
    if (!std::isfinite(stamp) || std::abs(stamp) > 1e11)
    {
      throw UserError(path + ": " + what + " has no usable time stamp");
    }
  }

  void putCloud(const Scan& scan, const std::string& label, const mrpt::maps::CPointsMap::Ptr& map)
  {
    CObservationPointCloud observation;
    observation.timestamp = toMrptTime(scan.stamp);
    observation.sensorLabel = label;
    observation.sensorPose = toMrpt(scan.T_vehicle_lidar);
    observation.pointcloud = map;
    if (options.external_storage && scan.size() > 0)
    {
      putExternally(observation, label);
    }
    writeObject(observation, file);
  }

  void putExternally(CObservationPointCloud& observation, const std::string& label)
  {
    std::string name = label + "_" + numberedName(frames, cloud_ending);
    std::replace(name.begin(), name.end(), '/', '_');
    external.push_back(name);
    GzOutput out((fs::path(pendingFolder()) / name).string(), options.compression_level);
    writeObject(*observation.pointcloud, out);
    out.close();
    observation.setAsExternalStorage(
        name, CObservationPointCloud::ExternalStorageFormat::MRPT_Serialization);
  }

  /** Integrates the mean of both velocities since the sample before. */
  void addToOdometry(const WheelSample& sample)
  {
    const WheelSample before = wheels.value_or(sample);
    const double dt = std::max(0.0, sample.stamp - before.stamp);
    Vector6 motion = Vector6::Zero();
    motion[0] = 0.5 * dt * (before.forward_speed + sample.forward_speed);
    motion[5] = 0.5 * dt * (before.yaw_rate + sample.yaw_rate);
    T_odom_vehicle = T_odom_vehicle * expSE3(motion);
    wheels = sample;
  }
};

RawlogWriter::RawlogWriter(const std::string& path, const RawlogWriterOptions& options)
{
  validate(options, "rawlog writer");
  impl_ = std::make_unique<Impl>(path, options);
}

RawlogWriter::~RawlogWriter()
{
  try
  {
    // If nothing was written, or close() did not follow finish(), an earlier file of the name is
    // kept.
    if (impl_ && impl_->frames > 0 && !impl_->finished)
    {
      close();
    }
  }
  catch (const std::exception&)
  {
    // Errors are reported by close().
  }
}

RawlogWriter::RawlogWriter(RawlogWriter&&) noexcept = default;
RawlogWriter& RawlogWriter::operator=(RawlogWriter&&) noexcept = default;

void RawlogWriter::write(const Scan& scan, const std::optional<Pose>& truth)
{
  requireSameLength(scan);
  impl_->requireWritable(scan.stamp, "scan " + std::to_string(impl_->frames));
  const std::string label =
      scan.sensor_label.empty() ? impl_->options.sensor_label : scan.sensor_label;
  if (truth)
  {
    writeObject(robotPose(scan.stamp, impl_->options.ground_truth_label, *truth), impl_->file);
  }
  if (!scan.time.empty() || !scan.ring.empty())
  {
    impl_->putCloud(scan, label + time_ring_suffix, timeRingOf(scan));
  }
  impl_->putCloud(scan, label, cloudOf(scan));
  ++impl_->frames;
}

void RawlogWriter::write(const ImuSample& sample)
{
  impl_->requireWritable(sample.stamp, "a sample of the IMU");
  mrpt::obs::CObservationIMU observation;
  observation.timestamp = toMrptTime(sample.stamp);
  observation.sensorLabel = "imu";
  observation.sensorPose = toMrpt(sample.T_vehicle_imu);
  setVector(observation, mrpt::obs::IMU_WX, mrpt::obs::IMU_WY, mrpt::obs::IMU_WZ,
            sample.angular_velocity);
  if (sample.acceleration)
  {
    setVector(observation, mrpt::obs::IMU_X_ACC, mrpt::obs::IMU_Y_ACC, mrpt::obs::IMU_Z_ACC,
              *sample.acceleration);
  }
  writeObject(observation, impl_->file);
}

void RawlogWriter::write(const WheelSample& sample)
{
  impl_->requireWritable(sample.stamp, "a sample of the wheel odometry");
  impl_->addToOdometry(sample);
  const Pose& pose = impl_->T_odom_vehicle;
  mrpt::obs::CObservationOdometry observation;
  observation.timestamp = toMrptTime(sample.stamp);
  observation.sensorLabel = "odometry";
  observation.odometry =
      mrpt::poses::CPose2D(pose.translation().x(), pose.translation().y(), yawPitchRoll(pose).x());
  observation.hasVelocities = true;
  observation.velocityLocal = mrpt::math::TTwist2D(sample.forward_speed, 0, sample.yaw_rate);
  writeObject(observation, impl_->file);
}

void RawlogWriter::write(const GnssFix& fix)
{
  impl_->requireWritable(fix.stamp, "a fix of the satellite receiver");
  mrpt::obs::gnss::Message_NMEA_GGA message;
  message.fields.latitude_degrees = fix.position.latitude;
  message.fields.longitude_degrees = fix.position.longitude;
  message.fields.altitude_meters = fix.position.height;
  message.fields.fix_quality = 1;
  mrpt::obs::CObservationGPS observation;
  observation.timestamp = toMrptTime(fix.stamp);
  observation.originalReceivedTimestamp = observation.timestamp;
  observation.has_satellite_timestamp = true;
  observation.sensorLabel = "gnss";
  Pose T_vehicle_antenna = Pose::Identity();
  T_vehicle_antenna.translation() = fix.antenna;
  observation.sensorPose = toMrpt(T_vehicle_antenna);
  observation.setMsg(message);
  if (fix.horizontal_sigma > 0 && fix.vertical_sigma > 0)
  {
    // A GGA message has no standard deviations.
    mrpt::obs::gnss::Message_NV_OEM6_BESTPOS accuracy;
    accuracy.fields.solution_stat = mrpt::obs::gnss::nv_oem6_solution_status::SOL_COMPUTED;
    accuracy.fields.position_type = mrpt::obs::gnss::nv_oem6_position_type::SINGLE;
    accuracy.fields.lat = fix.position.latitude;
    accuracy.fields.lon = fix.position.longitude;
    accuracy.fields.hgt = fix.position.height;
    accuracy.fields.lat_sigma = static_cast<float>(fix.horizontal_sigma);
    accuracy.fields.lon_sigma = static_cast<float>(fix.horizontal_sigma);
    accuracy.fields.hgt_sigma = static_cast<float>(fix.vertical_sigma);
    observation.setMsg(accuracy);
  }
  writeObject(observation, impl_->file);
}

void RawlogWriter::flush()
{
  impl_->file.flush();
}

void RawlogWriter::finish()
{
  impl_->finished = true;
  impl_->file.finish();
}

void RawlogWriter::close()
{
  if (impl_->closed)
  {
    return;
  }
  impl_->closed = true;
  finish();  // first: if the disk is full, an earlier rawlog keeps its clouds
  if (impl_->options.external_storage)
  {
    impl_->installClouds();
  }
  impl_->file.close();
  if (impl_->options.external_storage)
  {
    impl_->removeEarlierClouds();
  }
}

void RawlogWriter::abandon()
{
  impl_->closed = true;  // without a commit the file goes with the writer
  if (impl_->options.growing)
  {
    std::error_code ignored;
    fs::remove(impl_->path, ignored);
  }
}

RawlogWriter::RawlogWriter(const std::string& path,
                           const RawlogWriterOptions& options,
                           StateArchive& saved)
    : impl_(std::make_unique<Impl>(path, options, saved))
{
}

void RawlogWriter::saveState(StateArchive& archive)
{
  archive(impl_->file, impl_->frames, impl_->external, impl_->wheels, impl_->T_odom_vehicle);
}
}  // namespace dyslam
