// SPDX-License-Identifier: BSD-3-Clause
#include "ObservationScans.h"

#include <dyslam/base/Error.h>
#include <dyslam/mrpt/Conversions.h>
#include <dyslam/packets/VelodynePackets.h>
#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/obs/CObservation3DRangeScan.h>
#include <mrpt/obs/CObservationPointCloud.h>
#include <mrpt/obs/CObservationRotatingScan.h>
#include <mrpt/obs/CObservationVelodyneScan.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "ExternalScans.h"

namespace dyslam
{
namespace
{
using mrpt::obs::CObservation;
using mrpt::obs::CObservation3DRangeScan;
using mrpt::obs::CObservationPointCloud;
using mrpt::obs::CObservationRotatingScan;
using mrpt::obs::CObservationVelodyneScan;
using mrpt::obs::VelodyneCalibration;

Scan fromPointCloud(const CObservationPointCloud& observation, const ExternalFiles& external)
{
  if (observation.pointcloud)
  {
    return scanFromPointsMap(*observation.pointcloud);
  }
  return observation.isExternallyStored() ? readExternalCloud(observation, external) : Scan();
}

Scan fromVelodyne(CObservationVelodyneScan& observation)
{
  if (observation.scan_packets.empty())
  {
    const auto& cloud = observation.point_cloud;
    Scan scan;
    for (std::size_t i = 0; i < cloud.size(); ++i)
    {
      scan.points.emplace_back(cloud.x[i], cloud.y[i], cloud.z[i]);
      if (i < cloud.intensity.size())
      {
        scan.intensity.push_back(static_cast<float>(cloud.intensity[i]) / 255.0F);
      }
    }
    return scan;
  }
  static_assert(sizeof(CObservationVelodyneScan::TVelodyneRawPacket) == velodyne_packet_size);
  const auto view = [&observation](std::size_t i) {
    return VelodynePacketView{reinterpret_cast<const std::uint8_t*>(&observation.scan_packets[i])};
  };
  const std::size_t lasers = observation.calibration.laser_corrections.size();
  const auto model = velodyneModelOf(lasers, view(0).modelByte());
  if (!model)
  {
    throw std::invalid_argument("a calibration of " + std::to_string(lasers) +
                                " lasers, which no Velodyne has");
  }
  const VelodyneDecoder decoder(*model, observation.calibration, observation.minRange,
                                observation.maxRange);
  Scan scan;
  for (std::size_t i = 0; i < observation.scan_packets.size(); ++i)
  {
    const double time = 1e-6 * microsecondsBetween(view(0).clock(), view(i).clock());
    for (std::size_t block = 0; block < velodyne_blocks; ++block)
    {
      (void)decoder.decodeBlock(view(i), block, time, scan);
    }
  }
  return scan;
}

const VelodyneCalibration& calibrationOfRows(const CObservationRotatingScan& observation)
{
  if (observation.rowCount != 16 && observation.rowCount != 32)
  {
    throw UserError("CObservationRotatingScan '" + observation.sensorLabel + "' of model '" +
                    observation.lidarModel + "' has " + std::to_string(observation.rowCount) +
                    " rows: beam angles are known for 16 (VLP-16) and 32 (HDL-32E) only");
  }
  return VelodyneCalibration::LoadDefaultCalibration(observation.rowCount == 16 ? "VLP16"
                                                                                : "HDL32");
}

/** Rows are written twice, as a count and with the image: in a damaged file they may differ. */
void requireRows(const CObservationRotatingScan& observation)
{
  const auto& ranges = observation.rangeImage;
  if (ranges.size() != 0 && ranges.rows() != observation.rowCount)
  {
    throw UserError("CObservationRotatingScan '" + observation.sensorLabel + "' says " +
                    std::to_string(observation.rowCount) + " rows, but its range image has " +
                    std::to_string(ranges.rows()) + "; the file is damaged");
  }
}

/** Columns in use. MRPT's fromVelodyne() makes as many times more columns as there are lasers and
 * leaves them empty; the sweep is spread over the first ones only. */
Eigen::Index usedColumns(const CObservationRotatingScan& observation)
{
  const auto& ranges = observation.rangeImage;
  const Eigen::Index used = ranges.cols() / std::max<Eigen::Index>(1, ranges.rows());
  for (Eigen::Index column = used; column < ranges.cols(); ++column)
  {
    for (Eigen::Index row = 0; row < ranges.rows(); ++row)
    {
      if (ranges(row, column) != 0)
      {
        return ranges.cols();
      }
    }
  }
  return used;
}

/** The class holds ranges by laser and column but no beam angles: those are Velodyne's defaults.
 * Its azimuths count counter-clockwise, except that MRPT's fromVelodyne() fills in the sensor's
 * clockwise ones as they are. */
Scan fromRotatingScan(const CObservationRotatingScan& observation)
{
  requireRows(observation);
  const auto& lasers = calibrationOfRows(observation).laser_corrections;
  const auto rings = ringsOf(calibrationOfRows(observation));
  const auto& ranges = observation.rangeImage;
  const auto& intensities = observation.intensityImage;
  const bool has_intensity =
      intensities.rows() == ranges.rows() && intensities.cols() == ranges.cols();
  const std::string& model = observation.lidarModel;
  const double sense = model == "VLP-16" || model == "HDL-32E" || model == "Unknown" ? -1 : 1;
  const Eigen::Index columns = usedColumns(observation);
  // The lasers of one column fire one after the other while the head turns on.
  const double rate =
      observation.sweepDuration > 0 ? observation.azimuthSpan / observation.sweepDuration : 0;
  const auto velodyne = velodyneModelOf(lasers.size(), 0);
  const double laser_time = sense < 0 && velodyne ? traitsOf(*velodyne).shot_time : 0;
  Scan scan;
  for (Eigen::Index column = 0; column < columns; ++column)
  {
    const double fraction = static_cast<double>(column) / static_cast<double>(columns);
    for (Eigen::Index row = 0; row < ranges.rows(); ++row)
    {
      const double range = ranges(row, column) * observation.rangeResolution;
      if (ranges(row, column) == 0 || range < observation.minRange || range > observation.maxRange)
      {
        continue;
      }
      const auto& laser = lasers[static_cast<std::size_t>(row)];
      const double elevation = laser.verticalCorrection * M_PI / 180;
      const double time =
          observation.sweepDuration * fraction + laser_time * static_cast<double>(row);
      const double azimuth =
          sense * (observation.startAzimuth + observation.azimuthSpan * fraction +
                   rate * laser_time * static_cast<double>(row));
      const double heading = azimuth + laser.azimuthCorrection * M_PI / 180;
      const double flat = range * std::cos(elevation);
      scan.points.emplace_back(Eigen::Vector3d(flat * std::cos(heading), flat * std::sin(heading),
                                               range * std::sin(elevation))
                                   .cast<float>());
      scan.ring.push_back(rings[static_cast<std::size_t>(row)]);
      scan.time.push_back(static_cast<float>(time));
      if (has_intensity)
      {
        scan.intensity.push_back(static_cast<float>(intensities(row, column)) / 255.0F);
      }
    }
  }
  return scan;
}

Scan fromRangeImage(CObservation3DRangeScan& observation, const ExternalFiles& external)
{
  loadExternalParts(observation, external);
  if (observation.hasPoints3D)
  {
    if (observation.points3D_y.size() != observation.points3D_x.size() ||
        observation.points3D_z.size() != observation.points3D_x.size())
    {
      throw UserError("its points have x, y and z of different numbers; the file is damaged");
    }
    Scan scan;
    for (std::size_t i = 0; i < observation.points3D_x.size(); ++i)
    {
      scan.points.emplace_back(observation.points3D_x[i], observation.points3D_y[i],
                               observation.points3D_z[i]);
    }
    return scan;
  }
  mrpt::maps::CSimplePointsMap map;
  mrpt::obs::T3DPointsProjectionParams parameters;
  parameters.takeIntoAccountSensorPoseOnRobot = false;
  observation.unprojectInto(map, parameters);
  return scanFromPointsMap(map);
}
}  // namespace

bool is3dScan(const CObservation& observation)
{
  return dynamic_cast<const CObservationPointCloud*>(&observation) != nullptr ||
         dynamic_cast<const CObservationVelodyneScan*>(&observation) != nullptr ||
         dynamic_cast<const CObservationRotatingScan*>(&observation) != nullptr ||
         dynamic_cast<const CObservation3DRangeScan*>(&observation) != nullptr;
}

Scan scanFromObservation(CObservation& observation, const ExternalFiles& external)
{
  Scan scan;
  if (const auto* cloud = dynamic_cast<const CObservationPointCloud*>(&observation))
  {
    scan = fromPointCloud(*cloud, external);
  }
  else if (auto* velodyne = dynamic_cast<CObservationVelodyneScan*>(&observation))
  {
    scan = fromVelodyne(*velodyne);
  }
  else if (const auto* rotating = dynamic_cast<const CObservationRotatingScan*>(&observation))
  {
    scan = fromRotatingScan(*rotating);
  }
  else if (auto* range_image = dynamic_cast<CObservation3DRangeScan*>(&observation))
  {
    scan = fromRangeImage(*range_image, external);
  }
  scan.stamp = toStamp(observation.timestamp);
  scan.sensor_label = observation.sensorLabel;
  mrpt::poses::CPose3D sensor_pose;
  observation.getSensorPose(sensor_pose);
  scan.T_vehicle_lidar = toPose(sensor_pose);
  return scan;
}

bool applyTimeRing(CObservation& companion, const ExternalFiles& external, Scan& scan)
{
  const Scan values = scanFromObservation(companion, external);
  if (values.size() != scan.size())
  {
    return false;
  }
  bool has_time = false;
  bool has_ring = true;  // of every point: a point without one must not count as of another's
  for (const Eigen::Vector3f& value : values.points)
  {
    has_time = has_time || std::isfinite(value.x());
    has_ring = has_ring && value.y() >= 0 && value.y() <= 65535;  // false for NaN
  }
  scan.time.clear();
  scan.ring.clear();
  for (const Eigen::Vector3f& value : values.points)
  {
    if (has_time)
    {
      scan.time.push_back(value.x());
    }
    if (has_ring)
    {
      scan.ring.push_back(static_cast<std::uint16_t>(value.y()));
    }
  }
  return true;
}
}  // namespace dyslam
