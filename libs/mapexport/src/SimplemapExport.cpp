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
                    const MapProgress& on_keyframe)
{
  constexpr int compression_level = 1;
  GzOutput file(path, compression_level);
  auto archive = mrpt::serialization::archiveFrom(file);
  writeStart(archive, static_cast<std::uint32_t>(
                          std::count_if(map.poses().begin(), map.poses().end(),
                                        [](const Pose& T) { return T.matrix().allFinite(); })));
  map.forEachStaticCloud(
      [&](std::size_t k, const KeyframeCloud& cloud)
      {
        if (map.poses()[k].matrix().allFinite())
        {
          mrpt::obs::CSensoryFrame frame;
          frame.insert(observationOf(map.keyframes()[k], cloud));
          const Pose T = Eigen::Translation3d(origin) * map.poses()[k];
          archive << mrpt::poses::CPose3DPDFGaussian(toMrpt(T)) << frame;
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
