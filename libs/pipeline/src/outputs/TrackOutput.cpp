// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/PendingFile.h>
#include <dyslam/formats/GroundTruth.h>

#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "../RunOutput.h"
#include "SmoothedTracks.h"
#include "StreamedFile.h"

namespace dyslam
{
namespace
{
constexpr const char* table = "tracks.csv";
constexpr const char* kitti = "tracks.txt";
constexpr const char* header =
    "frame,stamp,id,class,x,y,z,length,width,height,yaw,vx,vy,vz,speed,dynamic,observed,score\n";

/** Where and when a scan was taken. */
struct ScanPlace
{
  std::size_t index = 0;
  double stamp = 0;  //!< [s]
  Pose T_odom_vehicle = Pose::Identity();
  Pose T_vehicle_lidar = Pose::Identity();
};

ScanPlace scanOf(const Frame& frame)
{
  return {frame.index, frame.scan.stamp, frame.T_odom_vehicle, frame.scan.T_vehicle_lidar};
}

/** Box of the odometry frame in the lidar frame of a scan. */
Box inLidarFrame(const Box& box, const ScanPlace& scan)
{
  const Pose T_lidar_odom = (scan.T_odom_vehicle * scan.T_vehicle_lidar).inverse();
  Box result = box;
  result.center = T_lidar_odom * box.center;
  const Eigen::Vector3d heading =
      T_lidar_odom.linear() * Eigen::Vector3d(std::cos(box.yaw), std::sin(box.yaw), 0);
  result.yaw = std::atan2(heading.y(), heading.x());
  return result;
}

LabelledBox labelledBox(const TrackedObject& object, const ScanPlace& scan)
{
  LabelledBox box;
  box.frame = static_cast<int>(scan.index);
  box.id = object.id;
  box.object_class = object.object_class;
  box.type = toString(object.object_class);
  box.box = inLidarFrame(object.box, scan);
  box.score = object.score;
  return box;
}

std::string rowOf(const TrackedObject& object, const ScanPlace& scan)
{
  const auto& c = object.box.center;
  const auto& s = object.box.size;
  const auto& v = object.velocity;
  char text[512];
  std::snprintf(
      text, sizeof text,
      "%zu,%.6f,%d,%s,%.3f,%.3f,%.3f,%.2f,%.2f,%.2f,%.4f,%.3f,%.3f,%.3f,%.3f,%d,%d,%.3f\n",
      scan.index, scan.stamp, object.id, toString(object.object_class).c_str(), c.x(), c.y(), c.z(),
      s.x(), s.y(), s.z(), object.box.yaw, v.x(), v.y(), v.z(), v.norm(), object.dynamic ? 1 : 0,
      object.observed ? 1 : 0, object.score);
  return text;
}

/** The reported objects: `tracks.csv`, boxes in the odometry frame, and `tracks.txt`, in the lidar
 * frame of each scan. */
class TrackOutput : public RunOutput
{
 public:
  explicit TrackOutput(const RunOutputContext& context) : RunOutput(context, {table, kitti}) {}
  void open() override { rows_.open(path(table), header); }
  void add(const Frame& frame) override
  {
    std::string rows;
    for (const TrackedObject& object : frame.objects)
    {
      if (object.reported)
      {
        reported_.push_back({scans_.size(), object});
        rows += rowOf(object, scanOf(frame));
      }
    }
    scans_.push_back(scanOf(frame));
    rows_.write(rows);
  }
  void checkpoint(const RunResults& /*results*/) override
  {
    std::vector<LabelledBox> boxes;
    for (const auto& [ordinal, object] : reported_)
    {
      boxes.push_back(labelledBox(object, scans_[ordinal]));
    }
    writeTracks(path(kitti), boxes);
  }
  void exchangeState(StateArchive& archive) override
  {
    archive(scans_, reported_);
    rows_.exchangeState(path(table), archive);
  }
  void finish(const RunResults& results) override
  {
    std::vector<LabelledBox> boxes;
    std::string text = header;
    for (auto& [ordinal, object] : reported_)
    {
      const ScanPlace& scan = scans_[ordinal];
      if (const SmoothedObject* smoothed = findSmoothed(results.objects, scan.index, object.id))
      {
        object = smoothedTrack(object, *smoothed,
                               scan.T_odom_vehicle * results.trajectory[ordinal].pose.inverse());
      }
      boxes.push_back(labelledBox(object, scan));
      text += rowOf(object, scan);
    }
    eachByItself({[&] { writeTracks(path(kitti), boxes); },
                  [&]
                  {
                    rows_.close();
                    if (!results.objects.empty())
                    {
                      writeWhole(path(table), text);
                    }
                  }});
  }

 private:
  StreamedFile rows_;
  std::vector<ScanPlace> scans_;
  std::vector<std::pair<std::size_t, TrackedObject>> reported_;  //!< with the scan's ordinal
};
}  // namespace

std::unique_ptr<RunOutput> makeTrackOutput(const RunOutputContext& context)
{
  return std::make_unique<TrackOutput>(context);
}
}  // namespace dyslam
