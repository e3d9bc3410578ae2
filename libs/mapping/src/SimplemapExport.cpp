// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/io/GzOutput.h>
#include <dyslam/mapping/MapExport.h>
#include <mrpt/maps/CPointsMapXYZI.h>
#include <mrpt/maps/CSimpleMap.h>
#include <mrpt/obs/CObservationPointCloud.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/poses/CPose3DPDFGaussian.h>
#include <mrpt/serialization/CArchive.h>

#include <cmath>
#include <cstdint>

namespace dyslam
{
namespace
{
mrpt::poses::CPose3D toMrpt(const Pose& pose)
{
  mrpt::math::CMatrixDouble44 matrix;
  for (int i = 0; i < 4; ++i)
  {
    for (int j = 0; j < 4; ++j)
    {
      matrix(i, j) = pose.matrix()(i, j);
    }
  }
  return mrpt::poses::CPose3D(matrix);
}

/** MRPT counts ticks of 100 ns since 1601. */
mrpt::Clock::time_point toMrptTime(double stamp)
{
  constexpr std::int64_t unix_epoch_ticks = 116444736000000000;
  return mrpt::Clock::time_point(
      mrpt::Clock::duration(std::llround(stamp * 1e7) + unix_epoch_ticks));
}

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
}  // namespace

void writeSimplemap(const StaticMap& map,
                    const std::string& path,
                    const Eigen::Vector3d& origin,
                    const MapProgress& on_keyframe)
{
  mrpt::maps::CSimpleMap simplemap;
  map.forEachStaticCloud(
      [&](std::size_t k, const KeyframeCloud& cloud)
      {
        if (!map.poses()[k].matrix().allFinite())
        {
          return;
        }
        auto frame = mrpt::obs::CSensoryFrame::Create();
        frame->insert(observationOf(map.keyframes()[k], cloud));
        const Pose T = Eigen::Translation3d(origin) * map.poses()[k];
        auto pose = mrpt::poses::CPose3DPDFGaussian::Create(toMrpt(T));
        simplemap.insert(pose, frame);
        if (on_keyframe)
        {
          on_keyframe(k + 1);
        }
      });
  constexpr int compression_level = 1;
  GzOutput file(path, compression_level);
  auto archive = mrpt::serialization::archiveFrom(file);
  archive << simplemap;
  file.close();
}
}  // namespace dyslam
