// SPDX-License-Identifier: BSD-3-Clause
#include "SmoothedTracks.h"

#include <dyslam/core/BoxOverlap.h>
#include <dyslam/tracking/TrackMerging.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <tuple>

#include "TrackCompletion.h"

namespace dyslam
{
namespace
{
using Tracks = std::map<int, Sightings>;  //!< by the id of the object

Sighting sightingOf(const PastObject& object,
                    const PastScan& scan,
                    const Pose& T_vehicle_lidar,
                    const StampedPose& T_map_vehicle)
{
  const Pose T_map_odom = T_map_vehicle.pose * scan.T_odom_vehicle.inverse();
  Sighting s;
  s.scan = scan.index;
  s.stamp = T_map_vehicle.stamp;
  s.time = scan.time;
  s.object_class = object.object_class;
  s.box = transformed(object.box, T_map_odom);
  s.velocity = T_map_odom.linear() * object.velocity;
  s.sensor = T_map_vehicle.pose * T_vehicle_lidar.translation();
  s.observed = object.observed;
  s.dynamic = object.dynamic;
  s.reported = object.reported;
  return s;
}

/** Sightings of all objects that were reported at some scan. */
Tracks reportedTracks(const RunHistory& history,
                      const Trajectory& trajectory,
                      const std::map<int, int>& merged)
{
  Tracks tracks;
  history.forEachObject(
      merged,
      [&](const PastObject& object)
      {
        const PastScan& scan = history.scans()[object.scan];
        const StampedPose& pose = trajectory[object.scan];
        Sightings& track = tracks[object.id];
        if (track.empty() || scan.time > track.back().time)
        {
          track.push_back(sightingOf(object, scan, history.mounts()[scan.mount], pose));
        }
      });
  for (auto track = tracks.begin(); track != tracks.end();)
  {
    const bool reported = std::any_of(track->second.begin(), track->second.end(),
                                      [](const Sighting& s) { return s.reported; });
    track = reported ? std::next(track) : tracks.erase(track);
  }
  return tracks;
}

std::vector<TrackBox> boxesOf(const Tracks& tracks)
{
  std::vector<TrackBox> boxes;
  for (const auto& [id, track] : tracks)
  {
    for (const Sighting& sighting : track)
    {
      boxes.push_back({sighting.scan, id, sighting.box});
    }
  }
  return boxes;
}

SmoothedObject smoothedObject(int id, const Sighting& sighting)
{
  SmoothedObject object;
  object.id = id;
  object.from_graph = false;
  object.scan = sighting.scan;
  object.stamp = sighting.stamp;
  object.T_map_object = Eigen::Translation3d(sighting.box.centre) *
                        Eigen::AngleAxisd(sighting.box.yaw, Eigen::Vector3d::UnitZ());
  object.velocity = sighting.velocity;
  object.moving = sighting.dynamic;
  object.size = sighting.box.size;
  object.object_class = sighting.object_class;
  return object;
}
}  // namespace

SmoothedTracks smoothTracks(const RunHistory& history,
                            const Trajectory& trajectory,
                            const TrackSmoothingOptions& options,
                            bool complete_boxes)
{
  SmoothedTracks result;
  if (options.window <= 0)
  {
    return result;
  }
  const auto completed_tracks = [&]
  {
    Tracks tracks = reportedTracks(history, trajectory, result.merged);
    for (auto& [id, track] : tracks)
    {
      completeAndSmooth(options, complete_boxes, track);
    }
    return tracks;
  };
  Tracks tracks = completed_tracks();
  result.merged = findMergedTracks(boxesOf(tracks), options.merge_overlap);
  if (!result.merged.empty())
  {
    tracks.clear();  // frees memory first: there may be millions of sightings
    tracks = completed_tracks();
  }
  for (const auto& [id, track] : tracks)
  {
    for (const Sighting& sighting : track)
    {
      result.objects.push_back(smoothedObject(id, sighting));
    }
  }
  std::sort(result.objects.begin(), result.objects.end(),
            [](const SmoothedObject& a, const SmoothedObject& b)
            { return std::tie(a.scan, a.id) < std::tie(b.scan, b.id); });
  return result;
}
}  // namespace dyslam
