// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Printable.h>
#include <dyslam/core/Deskew.h>
#include <dyslam/core/Scan.h>
#include <dyslam/formats/SustechFiles.h>
#include <dyslam/formats/TextFile.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/sim/Simulator.h>
#include <dyslam/train/DysegData.h>
#include <dyslam/train/ScanFiles.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace dyslam
{
namespace
{
/** Marks the points in a box as those of an object, and those just around it as unknown if the
 * object moves. */
void claimPoints(const Box& box, std::int32_t object, bool moving, DysegClip::Frame& frame)
{
  const Eigen::Isometry3f T_box_sensor =
      poseFromYpr(box.centre.x(), box.centre.y(), box.centre.z(), box.yaw, 0, 0)
          .inverse()
          .cast<float>();
  const Eigen::Vector3f half = 0.5F * box.size.cast<float>();
  const Eigen::Vector3f inner = half + Eigen::Vector3f::Constant(0.05F);
  const Eigen::Vector3f outer = half + Eigen::Vector3f(0.4F, 0.4F, 0.3F);
  const Eigen::Vector3f centre = box.centre.cast<float>();
  const float reach = outer.norm();
  for (std::size_t i = 0; i < frame.points.size(); ++i)
  {
    if ((frame.points[i] - centre).squaredNorm() > reach * reach)
    {
      continue;
    }
    const Eigen::Array3f at = (T_box_sensor * frame.points[i]).array().abs();
    if ((at < inner.array()).all())
    {
      frame.object[i] = object;
    }
    else if (moving && (at < outer.array()).all() && frame.object[i] == DysegClip::still)
    {
      frame.object[i] = DysegClip::unknown;
    }
  }
}

// Number of frames to each side that give an object's speed. Boxes drawn by hand jump by up to half
// a metre from frame to frame: with three frames to each side, parked trucks would be faster than
// 0.5 m/s.
constexpr std::size_t speed_window = 8;
constexpr int least_positions = 4;  // least number of positions that give a speed

UserError tooFewPoses(const std::string& file, std::size_t poses, std::size_t last_frame)
{
  return UserError(file + ": has " + counted(poses, "pose") + ", but frame " +
                   std::to_string(last_frame) +
                   " is requested (frames count from 0); request fewer frames");
}
}  // namespace

double SweepDrift::revolutions() const
{
  return 1 + std::abs(step) / (2 * M_PI);
}

namespace
{
/** The sweeps of a run: motion during each, and poses at their middle. */
class Sweeps
{
 public:
  /** \param matched T_world_sensor by scan matching, one per scan */
  Sweeps(const std::vector<Pose>& matched, const SweepDrift& drift) : drift_(drift)
  {
    Pose T = matched.front();
    for (std::size_t f = 0; f < matched.size(); ++f)
    {
      // The motion during the first sweep is not known; that of the second is nearly the same.
      const std::size_t later = std::max<std::size_t>(f, 1);
      const Vector6 motion = later < matched.size()
                                 ? logSE3(matched[later - 1].inverse() * matched[later])
                                 : Vector6(Vector6::Zero());
      T = f > 0 ? T * expSE3(drift.revolutions() * motion) : T;
      motions_.push_back(motion);
      poses_.push_back(T);
    }
  }

  [[nodiscard]] const Pose& pose(std::size_t frame) const { return poses_[frame]; }

  void deskew(std::size_t frame, std::vector<Eigen::Vector3f>& points) const
  {
    const SweepMotion motion(expSE3(motions_[frame]), middle);
    for (Eigen::Vector3f& p : points)
    {
      p = drift_.step != 0 && isReturn(p) ? motion.toReference(p, sweepFraction(p, model(frame)))
                                          : p;
    }
  }

  [[nodiscard]] Pose deskewed(std::size_t frame, const Pose& T_sensor_object) const
  {
    if (drift_.step == 0)
    {
      return T_sensor_object;
    }
    const double fraction =
        sweepFraction(T_sensor_object.translation().cast<float>(), model(frame));
    return expSE3((fraction - middle) * motions_[frame]) * T_sensor_object;
  }

 private:
  static constexpr double middle = 0.5;

  [[nodiscard]] SweepModel model(std::size_t frame) const
  {
    return {-1, drift_.start_azimuth + drift_.step * static_cast<double>(frame)};
  }

  SweepDrift drift_;
  std::vector<Vector6> motions_;
  std::vector<Pose> poses_;  // T_world_sensor at the middle of each sweep
};

using Track = std::map<std::size_t, Eigen::Vector2d>;  // positions by frame

/** Velocity by a least-squares line through at least two positions [m per frame]. */
Eigen::Vector2d fittedVelocity(Track::const_iterator begin, Track::const_iterator end)
{
  const auto count = static_cast<double>(std::distance(begin, end));
  double mean_frame = 0;
  for (auto it = begin; it != end; ++it)
  {
    mean_frame += static_cast<double>(it->first) / count;
  }
  double spread = 0;
  Eigen::Vector2d moment = Eigen::Vector2d::Zero();
  for (auto it = begin; it != end; ++it)
  {
    const double offset = static_cast<double>(it->first) - mean_frame;
    spread += offset * offset;
    moment += offset * it->second;
  }
  return moment / spread;
}

Pose poseOf(const Box& box)
{
  return poseFromYpr(box.centre.x(), box.centre.y(), box.centre.z() - 0.5 * box.size.z(), box.yaw,
                     0, 0);
}
}  // namespace

DysegClip loadBoxedRun(const std::string& folder,
                       std::size_t first,
                       std::size_t last,
                       const BoxedRunOptions& options)
{
  DysegClip clip;
  clip.name = folder;
  clip.period = options.revolution * options.drift.revolutions();
  const std::string pose_file = folder + "/poses_icp_frame_to_frame.txt";
  const auto matched = readKittiPoses(pose_file);
  if (matched.size() <= last)
  {
    throw tooFewPoses(pose_file, matched.size(), last);
  }
  const Sweeps sweeps(matched, options.drift);
  std::vector<std::vector<LabelledBox>> boxes;
  std::map<std::int32_t, Track> tracks;
  for (std::size_t f = first; f <= last; ++f)
  {
    boxes.push_back(
        readSustechJson(numberedPath(folder + "/label_json", f, ".json"), static_cast<int>(f)));
    for (const auto& b : boxes.back())
    {
      tracks[b.id][f] =
          (sweeps.pose(f) * sweeps.deskewed(f, poseOf(b.box))).translation().head<2>();
    }
  }
  for (std::size_t f = first; f <= last; ++f)
  {
    DysegClip::Frame frame;
    frame.T_world_sensor = sweeps.pose(f);
    frame.points = readTrainingPoints(numberedPath(folder + "/velodyne", f, ".bin"), 0);
    frame.object.assign(frame.points.size(), DysegClip::still);
    for (const auto& labelled : boxes[f - first])
    {
      if (labelled.id >= options.standing_first && labelled.id <= options.standing_last)
      {
        continue;
      }
      if (labelled.id <= DysegClip::still)  // of no track: whether it moves is not known
      {
        claimPoints(labelled.box, DysegClip::unknown, false, frame);
        continue;
      }
      const auto& track = tracks[labelled.id];
      const auto begin = track.lower_bound(f < speed_window ? 0 : f - speed_window);
      const auto end = track.upper_bound(f + speed_window);
      const bool known = std::distance(begin, end) >= least_positions;
      const double speed = known ? fittedVelocity(begin, end).norm() / clip.period : 0;
      DysegClip::Object object;
      object.T_sensor_object = sweeps.deskewed(f, poseOf(labelled.box));
      object.moving = speed > min_moving_speed;
      object.doubtful = !object.moving && (speed > max_static_speed || !known);
      frame.objects[labelled.id] = object;
      claimPoints(labelled.box, labelled.id, object.moving, frame);
    }
    sweeps.deskew(f, frame.points);
    clip.frames.push_back(std::move(frame));
  }
  return clip;
}

namespace
{
DysegClip::Frame simulatedFrame(sim::SimulatedScan scan, bool deskewed)
{
  DysegClip::Frame frame;
  frame.T_world_sensor = scan.T_map_vehicle * scan.scan.T_vehicle_lidar;
  frame.points = deskewed ? std::move(scan.deskewed) : std::move(scan.scan.points);
  frame.object.assign(frame.points.size(), DysegClip::still);
  for (const auto& o : scan.objects)
  {
    DysegClip::Object object;
    const Box& box = o.points > 0 ? o.box_seen : o.box;
    object.T_sensor_object =
        poseFromYpr(box.centre.x(), box.centre.y(), box.centre.z(), box.yaw, 0, 0);
    const double speed = o.velocity.norm();
    object.moving = speed > min_moving_speed;
    object.doubtful = !object.moving && speed > max_static_speed;
    frame.objects[o.id] = object;
  }
  for (std::size_t i = 0; i < frame.points.size(); ++i)
  {
    // Bodies at rest are included: they may have moved between the scans of a pair.
    const auto id = static_cast<std::int32_t>(scan.label[i] >> 16U);
    if (frame.objects.count(id) != 0)
    {
      frame.object[i] = id;
    }
  }
  return frame;
}
}  // namespace

DysegClip simulateClip(std::uint64_t seed, int scans, bool deskewed, const DysegClipScene& scene)
{
  constexpr std::uint64_t most_seed = std::numeric_limits<std::int32_t>::max();
  if (seed > most_seed)
  {
    throw UserError("seed " + std::to_string(seed) + " of the simulator is above " +
                    std::to_string(most_seed) + ", the largest; choose a smaller one");
  }
  RandomDraws draws(0x5EED, seed);
  sim::SimulatorOptions options;
  options.world = scene.world;
  options.sensor = scene.sensor;
  options.columns = scene.columns;
  options.ego = scene.ego;
  options.ego_speed = scene.ego_speed;
  options.seed = static_cast<int>(seed);
  options.traffic = draws.uniform(0.3, 1.0);
  options.traffic = scene.traffic < 0 ? options.traffic : scene.traffic;
  options.start_fraction = draws.uniform();
  options.start_time = draws.uniform(3, 15);
  options.loop_length = 300;
  options.stops = true;
  sim::Simulator simulator(options);
  DysegClip clip;
  clip.name = "simulated " + std::to_string(seed);
  for (int s = 0; s < scans; ++s)
  {
    clip.frames.push_back(simulatedFrame(simulator.next(), deskewed));
  }
  return clip;
}
}  // namespace dyslam
