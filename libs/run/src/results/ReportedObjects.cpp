// SPDX-License-Identifier: BSD-3-Clause
#include "ReportedObjects.h"

#include <dyslam/base/Angle.h>
#include <dyslam/core/SmoothedObject.h>

#include <cmath>
#include <set>
#include <utility>

namespace dyslam
{
namespace
{
/** The tracked object with position, heading, velocity and covariance of the smoothed object,
 * odometry frame.
 * \param T_odom_map transform at the object's scan */
TrackedObject smoothedTrack(const TrackedObject& tracked,
                            const SmoothedObject& smoothed,
                            const Pose& T_odom_map)
{
  TrackedObject result = tracked;
  const Pose T_odom_object = T_odom_map * smoothed.T_map_object;
  result.box.centre = T_odom_object.translation();
  const double yaw = yawPitchRoll(T_odom_object).x();
  const bool reversed = smoothed.from_graph && std::cos(yaw - tracked.box.yaw) < 0;
  result.box.yaw = wrapAngle(reversed ? yaw + M_PI : yaw);
  result.box.size = smoothed.size.value_or(tracked.box.size);
  result.object_class = smoothed.object_class.value_or(tracked.object_class);
  result.velocity = T_odom_map.linear() * smoothed.velocity;
  Eigen::Matrix4d R = Eigen::Matrix4d::Identity();
  R.topLeftCorner<3, 3>() = T_odom_map.linear();
  result.covariance = R * smoothed.covariance * R.transpose();
  result.dynamic = smoothed.moving;
  return result;
}
}  // namespace

TrackCounts countTracks(const RunResults& results)
{
  std::set<int> reported;
  std::set<int> moving;
  forEachReported(results,
                  [&](const ReportedObject& state)
                  {
                    reported.insert(state.object.id);
                    if (state.object.dynamic)
                    {
                      moving.insert(state.object.id);
                    }
                  });
  return {reported.size(), moving.size()};
}

void forEachReported(const RunResults& results,
                     const std::function<void(const ReportedObject&)>& use)
{
  results.history->forEachObject(
      results.merged_tracks,
      [&](const PastObject& past)
      {
        const PastScan& scan = results.history->scans()[past.scan];
        const Pose T_map_odom = results.trajectory[past.scan].pose * scan.T_odom_vehicle.inverse();
        TrackedObject object = past.tracked();
        if (const SmoothedObject* smoothed = findSmoothed(results.objects, scan.index, object.id))
        {
          object = smoothedTrack(object, *smoothed, T_map_odom.inverse());
          object.dynamic = smoothed->from_graph ? past.dynamic : smoothed->moving;
        }
        use({std::move(object), scan, past.scan, T_map_odom});
      });
}
}  // namespace dyslam
