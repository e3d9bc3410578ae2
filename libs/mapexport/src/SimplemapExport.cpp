// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/io/GzOutput.h>
#include <dyslam/mapexport/MapExport.h>
#include <dyslam/mrpt/Conversions.h>
#include <mrpt/maps/CPointsMapXYZI.h>
#include <mrpt/maps/CSimpleMap.h>
#include <mrpt/obs/CObservationPointCloud.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/poses/CPose3DPDFGaussian.h>
#include <mrpt/serialization/CArchive.h>

#include <algorithm>
#include <cstdint>
#include <vector>

namespace dyslam
{
namespace
{
mrpt::obs::CObservationPointCloud::Ptr observationOf(const Keyframe& keyframe,
                                                     const KeyframeCloud& cloud)
{
  auto points = mrpt::maps::CPointsMapXYZI::Create();
  points->resize(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i)
  {
    const auto& p = cloud.points[i];
    points->setPointFast(i, p.x(), p.y(), p.z());
    points->setPointColor_fast(i, cloud.intensity[i], 0, 0);
  }
  auto observation = mrpt::obs::CObservationPointCloud::Create();
  observation->sensorLabel = "lidar";
  observation->timestamp = toMrptTime(keyframe.stamp);
  observation->pointcloud = points;  // vehicle frame: the sensor's pose stays the identity
  return observation;
}

/** The points of a keyframe that are in an area, without their lidars. */
KeyframeCloud cloudWithin(const MapRegion& area,
                          const KeyframeCloud& cloud,
                          const Pose& T_map_vehicle)
{
  if (area.isWhole())
  {
    return cloud;
  }
  KeyframeCloud within;
  for (std::size_t i = 0; i < cloud.size(); ++i)
  {
    if (area.contains(T_map_vehicle * cloud.points[i].cast<double>()))
    {
      within.points.push_back(cloud.points[i]);
      within.intensity.push_back(cloud.intensity[i]);
    }
  }
  return within;
}

/** Whether the file has a keyframe, with these points of it. */
bool isWritten(const MapRegion& area, const KeyframeCloud& within, const Pose& T_map_vehicle)
{
  return T_map_vehicle.matrix().allFinite() && (area.isWhole() || within.size() > 0);
}

std::uint32_t countWritten(const StaticMap& map, const MapRegion& area)
{
  if (area.isWhole())
  {
    return static_cast<std::uint32_t>(std::count_if(map.poses().begin(), map.poses().end(),
                                                    [](const Pose& T)
                                                    { return T.matrix().allFinite(); }));
  }
  std::uint32_t count = 0;
  map.forEachStaticCloud(
      [&](std::size_t k, const KeyframeCloud& cloud)
      {
        const Pose& T = map.poses()[k];
        count += isWritten(area, cloudWithin(area, cloud, T), T) ? 1 : 0;
      });
  return count;
}

constexpr std::uint8_t end_of_object = 0x88;  // as MRPT's archives mark it

/** What a CSimpleMap of `count` keyframes begins with: the whole of it would be in memory. */
void writeStart(mrpt::serialization::CArchive& archive, std::uint32_t count)
{
  std::vector<std::uint8_t> empty;  // its start, the count and the end
  const mrpt::maps::CSimpleMap none;
  mrpt::serialization::ObjectToOctetVector(&none, empty);
  archive.WriteBuffer(empty.data(), empty.size() - sizeof count - sizeof end_of_object);
  archive << count;
}
}  // namespace

void writeSimplemap(const StaticMap& map,
                    const std::string& path,
                    const Eigen::Vector3d& origin,
                    const MapRegion& area,
                    const MapProgress& on_keyframe)
{
  constexpr int compression_level = 1;
  GzOutput file(path, compression_level);
  auto archive = mrpt::serialization::archiveFrom(file);
  writeStart(archive, countWritten(map, area));
  map.forEachStaticCloud(
      [&](std::size_t k, const KeyframeCloud& cloud)
      {
        const Pose& T = map.poses()[k];
        const KeyframeCloud within = cloudWithin(area, cloud, T);
        if (isWritten(area, within, T))
        {
          mrpt::obs::CSensoryFrame frame;
          frame.insert(observationOf(map.keyframes()[k], within));
          const Pose T_file_vehicle = Eigen::Translation3d(origin) * T;
          archive << mrpt::poses::CPose3DPDFGaussian(toMrpt(T_file_vehicle)) << frame;
        }
        if (on_keyframe)
        {
          on_keyframe(k + 1);
        }
      });
  archive << end_of_object;
  file.close();
}
}  // namespace dyslam
