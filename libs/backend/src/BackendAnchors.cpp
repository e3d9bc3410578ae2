// SPDX-License-Identifier: BSD-3-Clause
// The end of a run: the vertical, and the pose of the map on the earth.
#include <dyslam/base/Angle.h>
#include <dyslam/base/Printable.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "BackendState.h"

namespace dyslam
{
/** A sample before a step of the clock belongs to the scan before it. */
double Backend::State::timeOf(double stamp, const Frame& frame) const
{
  const bool is_before_step =
      !frames.empty() && std::abs(stamp - frames.back().stamp) < std::abs(stamp - frame.scan.stamp);
  return stamp - (is_before_step ? frames.back().stamp - frames.back().time : frame.clock_offset);
}

void Backend::State::addAccelerations(const Frame& frame, const Pose& T_previous_vehicle)
{
  std::vector<ImuSample> samples = frame.imu;
  for (ImuSample& sample : samples)
  {
    sample.stamp = timeOf(sample.stamp, frame);
  }
  gravity_anchor.add(frame.time(), samples, T_previous_vehicle);
}

void Backend::State::addPositions(const Frame& frame)
{
  std::vector<GnssFix> fixes = frame.gnss;
  for (GnssFix& fix : fixes)
  {
    fix.stamp = timeOf(fix.stamp, frame);
  }
  gnss.add(fixes);
}

/** Interpolates between the scans before and after. */
std::optional<VehicleInKeyframe> Backend::State::vehicleAt(double time) const
{
  constexpr double longest_gap = 1;  // longest time between the two scans [s]
  const auto after =
      std::lower_bound(frames.begin(), frames.end(), time,
                       [](const FrameInKeyframe& frame, double t) { return frame.time < t; });
  if (after != frames.end() && after->time == time)
  {
    return VehicleInKeyframe{after->keyframe, after->T_keyframe_frame};
  }
  if (after == frames.begin() || after == frames.end() ||
      after->time - std::prev(after)->time > longest_gap)
  {
    return std::nullopt;
  }
  const FrameInKeyframe& before = *std::prev(after);
  const Pose T_before_after = before.T_keyframe_frame.inverse() *
                              graph.pose(Key::ego(before.keyframe)).inverse() *
                              graph.pose(Key::ego(after->keyframe)) * after->T_keyframe_frame;
  const double part = (time - before.time) / (after->time - before.time);
  return VehicleInKeyframe{before.keyframe,
                           before.T_keyframe_frame * expSE3(part * logSE3(T_before_after))};
}

void Backend::State::restore(const Solved& before)
{
  graph.restore(before.values);
  correction.restoreLast(before.result);
  correctKeyframes(0);
}

void Backend::State::tieToVertical()
{
  const Solved before = solved();
  if (!gravity_anchor.addTo(graph, frames))
  {
    return;
  }
  const bool fuse =
      gravity_anchor.options().use == GravityUse::fuse && options.mode != BackendMode::odometry;
  if (fuse)
  {
    optimiseAll();
    GravityAnchor::removeYaw(graph);
  }
  const bool fits = gravity_anchor.fits(graph);
  if (fits)
  {
    gravity = gravity_anchor.gravity(graph);
    gravity->fused = fuse;
  }
  else
  {
    gravity_anchor.warn(
        "the accelerations of the IMU are not used: they do not fit the trajectory; is the pose of "
        "the IMU on the vehicle right, and its clock that of the lidar?");
  }
  if (fuse && !fits)
  {
    restore(before);
  }
  const Pose T_level_map = graph.pose(Key::vertical());
  if (!fuse || !fits)
  {
    GravityAnchor::removeFrom(graph);
  }
  if (fits && gravity_anchor.options().level_map && !graph.contains(Key::priorMap()))
  {
    levelMap(T_level_map);
  }
}

void Backend::State::levelMap(const Pose& T_level_map)
{
  moveMap(T_level_map);
  gravity->up_map = Eigen::Vector3d::UnitZ();
  gravity->levelled = true;
}

void Backend::State::tieToEarth()
{
  const Key earth = Key::georeference();
  const auto vehicle_at = [this](double time) { return vehicleAt(time); };
  if (!gnss.addTo(graph, vehicle_at))
  {
    return;
  }
  (void)graph.optimise(solver, {earth});
  constexpr double usual_drift = 0.05;  // fraction of the trajectory's extent
  const bool fuse = gnss.options().use == GnssUse::fuse && options.mode != BackendMode::odometry;
  bool fits = fuse || gnss.fits(graph, usual_drift);
  if (fuse)
  {
    const Solved before = solved();
    optimiseAll();
    fits = gnss.fits(graph, 0);
    if (!fits)
    {
      restore(before);
    }
  }
  if (!fits)
  {
    const bool nearly_fit = gnss.fits(graph, usual_drift);
    graph.remove(earth);
    gnss.warn(
        std::string("the positions of the satellite receiver are not used: most of them do not fit "
                    "the trajectory; ") +
        (!nearly_fit && gnss.fitsIfSwapped(graph, vehicle_at, usual_drift)
             ? "they fit with latitude and longitude swapped: mend this where they are recorded"
             : "is its clock that of the lidar, and the place of its antenna right?"));
    return;
  }
  georeference = gnss.georeference(graph);
  georeference->fused = fuse;
  compareVerticals();
  if (!fuse)
  {
    graph.remove(earth);
  }
}

/** A straight path shows the tilt about its direction only by the map's z axis. */
void Backend::State::compareVerticals()
{
  constexpr double most_sigmas = 3;
  if (!gravity || gravity->levelled)
  {
    return;
  }
  const Eigen::Vector3d up_map =
      georeference->T_enu_map.linear().transpose() * Eigen::Vector3d::UnitZ();
  const double angle = std::acos(std::clamp(up_map.dot(gravity->up_map), -1.0, 1.0));
  if (angle > gnss.options().tilt_sigma + most_sigmas * gravity->tilt_sigma)
  {
    gnss.warn(
        formatted("the satellite positions place the map on the earth with its vertical %.1f "
                  "degrees off that of the IMU's accelerations; gravity.level_map=true levels the "
                  "map first",
                  angle / radians_per_degree));
  }
}
}  // namespace dyslam
