// SPDX-License-Identifier: BSD-3-Clause
// The end of a run: the vertical, and the pose of the map on the earth.
#include <algorithm>
#include <iterator>
#include <utility>

#include "BackendState.h"

namespace dyslam
{
/** Interpolates between the scans before and after the stamp. */
std::optional<VehicleInKeyframe> Backend::State::vehicleAt(double stamp) const
{
  constexpr double longest_gap = 1;  // longest time between the two scans [s]
  const auto after = std::lower_bound(frames.begin(), frames.end(), stamp,
                                      [](const FrameInKeyframe& frame, double time)
                                      { return frame.stamp < time; });
  if (after != frames.end() && after->stamp == stamp)
  {
    return VehicleInKeyframe{after->keyframe, after->T_keyframe_frame};
  }
  if (after == frames.begin() || after == frames.end() ||
      after->stamp - std::prev(after)->stamp > longest_gap)
  {
    return std::nullopt;
  }
  const FrameInKeyframe& before = *std::prev(after);
  const Pose T_before_after = before.T_keyframe_frame.inverse() *
                              graph.pose(Key::ego(before.keyframe)).inverse() *
                              graph.pose(Key::ego(after->keyframe)) * after->T_keyframe_frame;
  const double part = (stamp - before.stamp) / (after->stamp - before.stamp);
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
  if (fits && gravity_anchor.options().level_map)
  {
    levelMap(T_level_map);
  }
}

void Backend::State::levelMap(const Pose& T_level_map)
{
  std::vector<std::pair<Key, Pose>> levelled;
  for (const auto& [key, variable] : graph.variables())
  {
    if (key.isPose())
    {
      const Pose T = unpackPose(variable.block.data());
      levelled.emplace_back(key,
                            key == Key::vertical() ? T * T_level_map.inverse() : T_level_map * T);
    }
  }
  for (const auto& [key, pose] : levelled)
  {
    graph.setPose(key, pose);
  }
  gravity->up_map = Eigen::Vector3d::UnitZ();
  gravity->levelled = true;
  correctKeyframes(0);
}

void Backend::State::tieToEarth()
{
  const Key earth = Key::georeference();
  if (!gnss.addTo(graph, [this](double stamp) { return vehicleAt(stamp); }))
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
    graph.remove(earth);
    gnss.warn(
        "the positions of the satellite receiver are not used: most of them do not fit the "
        "trajectory; is its clock that of the lidar, and the place of its antenna right?");
    return;
  }
  georeference = gnss.georeference(graph);
  georeference->fused = fuse;
  if (!fuse)
  {
    graph.remove(earth);
  }
}
}  // namespace dyslam
