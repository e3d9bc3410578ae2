// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Printable.h>
#include <dyslam/base/SharedFiles.h>
#include <dyslam/base/Splitmix.h>
#include <dyslam/benchmarks/JsonText.h>
#include <dyslam/benchmarks/MapSelf.h>
#include <dyslam/core/TimeRange.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/mapbuilder/ScanReading.h>
#include <dyslam/odometry/Preprocessor.h>
#include <dyslam/odometry/ScanPoses.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

namespace dyslam
{
namespace
{
using Points = std::vector<Eigen::Vector3f>;

/** \throws UserError for a damaged recording. */
void forEachScan(const MapSelfArguments& a,
                 const std::string& purpose,
                 MapListener& listener,
                 const std::function<void(const Frame&)>& use)
{
  RawlogSource source(a.rawlog, a.source);
  const std::string damage = readScans(source, purpose, listener, use);
  if (!damage.empty())
  {
    throw UserError(damage);
  }
}

/** Reads trajectories and gives them the times of the scans; the lines of KITTI files belong to the
 * scans used. */
std::vector<Trajectory> readTrajectories(const MapSelfArguments& a, MapListener& listener)
{
  std::vector<Trajectory> result;
  std::vector<double> stamps;
  for (const MapSelfTrajectory& given : a.trajectories)
  {
    TrajectoryFile file = readTrajectory(given.path);
    const bool timed = file.format == TrajectoryFormat::tum;
    if (!timed && given.time_offset != 0)
    {
      throw UserError(given.path +
                      ": has no time stamps; --time-offset is for poses that have them (TUM)");
    }
    if (!timed && stamps.empty())
    {
      forEachScan(a, "times", listener, [&](const Frame& f) { stamps.push_back(f.scan.stamp); });
    }
    if (!timed && file.trajectory.size() != stamps.size())
    {
      throw UserError(given.path + ": has " + counted(file.trajectory.size(), "pose") + ", but " +
                      counted(stamps.size(), "scan") + " of " + a.rawlog +
                      " are used; give the --skip-first-n and --only-first-n that it was made "
                      "with, or a TUM file");
    }
    for (std::size_t i = 0; i < file.trajectory.size(); ++i)
    {
      StampedPose& pose = file.trajectory[i];
      pose.stamp = timed ? pose.stamp + given.time_offset : stamps[i];
    }
    result.push_back(std::move(file.trajectory));
  }
  return result;
}

/** Reads the scans with their pose on each trajectory. */
class ScanPlacer
{
 public:
  ScanPlacer(const MapSelfArguments& a, MapListener& listener)
      : a_(a), pool_(0), preprocessor_(preprocess(a), pool_)
  {
    for (Trajectory& trajectory : readTrajectories(a, listener))
    {
      trajectories_.emplace_back(std::move(trajectory), a.tolerance);
    }
  }

  /** Pose of a scan on each trajectory; empty unless all trajectories have one. */
  [[nodiscard]] std::vector<Pose> posesOf(const Frame& frame) const
  {
    std::vector<Pose> poses;
    for (const ScanPoses& trajectory : trajectories_)
    {
      const auto pose = trajectory.at(frame.scan.stamp);
      if (!pose || !pose->matrix().allFinite())
      {
        return {};
      }
      poses.push_back(*pose);
    }
    return poses;
  }

  /** Points of the scan in the frame of a trajectory, with their numbers in the scan. */
  [[nodiscard]] std::pair<Points, std::vector<std::uint32_t>> place(const Frame& frame,
                                                                    std::size_t trajectory,
                                                                    const Pose& pose) const
  {
    const ScanPoses& t = trajectories_[trajectory];
    const Pose T_body_vehicle = a_.trajectories[trajectory].of_lidar
                                    ? frame.scan.T_vehicle_lidar.inverse()
                                    : Pose::Identity();
    const double sweep = frame.sweep_duration;
    const TimedMotion motion =
        t.motionDuring(frame.scan.stamp, preprocessor_.sweepSpan(frame.scan, sweep));
    const Pose T_previous_current =
        (motion.from * T_body_vehicle).inverse() * (motion.to * T_body_vehicle);
    Cloud cloud = preprocessor_.prepare(frame.scan, T_previous_current, motion.dt, sweep);
    // Coordinates such as UTM's are too large for single precision.
    const Eigen::Vector3d origin =
        (t.trajectory()[0].pose.translation() / 1000).array().round() * 1000;
    const Eigen::Isometry3f T =
        (Eigen::Translation3d(-origin) * pose * T_body_vehicle).cast<float>();
    for (auto& point : cloud.points)
    {
      point = T * point;
    }
    return {std::move(cloud.points), std::move(cloud.source)};
  }

  [[nodiscard]] std::size_t size() const { return trajectories_.size(); }

  /** Text for messages: ", FILE: from and to" of each trajectory. */
  [[nodiscard]] std::string times() const
  {
    std::string text;
    for (std::size_t i = 0; i < trajectories_.size(); ++i)
    {
      text += ", " + a_.trajectories[i].path + ": " +
              (trajectories_[i].trajectory().empty() ? "no poses"
                                                     : timesOf(trajectories_[i].trajectory()));
    }
    return text;
  }

 private:
  static PreprocessOptions preprocess(const MapSelfArguments& a)
  {
    PreprocessOptions options;
    if (!a.config.empty())
    {
      const Config config =
          Config::fromFile(findGivenOrShared(a.config, "config_files", ".ini", "", "dyslam"));
      config.requireFor("dyslam");
      load(options, config, "preprocess");
    }
    return options;
  }

  const MapSelfArguments& a_;
  std::vector<ScanPoses> trajectories_;
  ThreadPool pool_;
  Preprocessor preprocessor_;
};

/** The same points of the recording along each trajectory. */
class PointChoice
{
 public:
  PointChoice(std::size_t wanted, std::size_t trajectories)
      : wanted_(wanted), trajectories_(trajectories)
  {
  }

  void add(const ScanPlacer& placer, const Frame& frame, const std::vector<Pose>& poses)
  {
    for (std::size_t t = 0; t < trajectories_; ++t)
    {
      const auto [points, source] = placer.place(frame, t, poses[t]);
      for (std::size_t i = 0; i < points.size(); ++i)
      {
        const std::uint64_t number = (static_cast<std::uint64_t>(frame.index) << 32U) | source[i];
        // The smallest hashes are a random choice.
        offer(t, splitmix64(number), points[i]);
      }
    }
  }

  /** One list of points per trajectory; points that range limits exclude on one trajectory are left
   * out of all. */
  [[nodiscard]] std::vector<Points> finish() const
  {
    std::vector<Points> result(trajectories_);
    for (const auto& [key, entry] : chosen_)
    {
      const bool whole = std::all_of(entry.begin(), entry.end(),
                                     [](const auto& point) { return point.has_value(); });
      for (std::size_t t = 0; whole && t < trajectories_; ++t)
      {
        result[t].push_back(*entry[t]);
      }
    }
    return result;
  }

 private:
  /** Keeps the points with the smallest keys. */
  void offer(std::size_t trajectory, std::uint64_t key, const Eigen::Vector3f& point)
  {
    auto found = chosen_.find(key);
    if (found == chosen_.end())
    {
      if (chosen_.size() >= wanted_ && key > chosen_.rbegin()->first)
      {
        return;
      }
      found =
          chosen_.emplace(key, std::vector<std::optional<Eigen::Vector3f>>(trajectories_)).first;
      if (chosen_.size() > wanted_)
      {
        chosen_.erase(std::prev(chosen_.end()));
      }
    }
    found->second[trajectory] = point;
  }

  std::size_t wanted_;
  std::size_t trajectories_;
  std::map<std::uint64_t, std::vector<std::optional<Eigen::Vector3f>>> chosen_;
};
/** The scans of a recording that have a pose on every trajectory. */
struct Coverage
{
  std::size_t scans = 0;   //!< number of all scans
  std::size_t placed = 0;  //!< number of those with poses
  double first = 0;        //!< time stamp of the first scan [s]
  double last = 0;         //!< time stamp of the last scan [s]
};

/** Calls `use` for each scan that has a pose on every trajectory, with these poses. */
Coverage forEachPlaced(const MapSelfArguments& a,
                       const ScanPlacer& placer,
                       const std::string& purpose,
                       MapListener& listener,
                       const std::function<void(const Frame&, const std::vector<Pose>&)>& use)
{
  Coverage coverage;
  forEachScan(a, purpose, listener,
              [&](const Frame& frame)
              {
                coverage.last = frame.scan.stamp;
                coverage.first = coverage.scans == 0 ? coverage.last : coverage.first;
                ++coverage.scans;
                const auto poses = placer.posesOf(frame);
                if (!poses.empty())
                {
                  ++coverage.placed;
                  use(frame, poses);
                }
              });
  return coverage;
}

/** Warns if many scans lack a pose. \throws UserError if all do. */
void checkCoverage(const MapSelfArguments& a,
                   const ScanPlacer& placer,
                   const Coverage& coverage,
                   MapListener& listener)
{
  if (10 * coverage.placed >= 9 * coverage.scans && coverage.placed > 0)
  {
    return;
  }
  const std::string reasons = " (scans: " + timesFrom(coverage.first, coverage.last) +
                              placer.times() + "; another clock: --time-offset; --tolerance " +
                              shortNumber(a.tolerance) + " s)";
  if (coverage.placed == 0)
  {
    throw UserError(a.rawlog + ": none of its " + std::to_string(coverage.scans) +
                    " scans has a pose in every trajectory; are they of this recording?" + reasons);
  }
  listener.warn(a.rawlog + ": " + std::to_string(coverage.placed) + " of " +
                counted(coverage.scans, "scan") + (coverage.placed == 1 ? " has" : " have") +
                " a pose in every trajectory; the others are in no map" + reasons);
}
}  // namespace

std::vector<MapSelfScores> evaluateMapSelf(const MapSelfArguments& a, MapListener& listener)
{
  const ScanPlacer placer(a, listener);
  PointChoice choice(a.points, placer.size());
  const Coverage coverage = forEachPlaced(a, placer, "choosing points", listener,
                                          [&](const Frame& frame, const std::vector<Pose>& poses)
                                          { choice.add(placer, frame, poses); });
  checkCoverage(a, placer, coverage, listener);
  std::vector<MapQuality> maps;
  for (auto& points : choice.finish())
  {
    maps.emplace_back(std::move(points), a.quality);
  }
  (void)forEachPlaced(a, placer, "map", listener,
                      [&](const Frame& frame, const std::vector<Pose>& poses)
                      {
                        for (std::size_t t = 0; t < maps.size(); ++t)
                        {
                          maps[t].add(placer.place(frame, t, poses[t]).first);
                        }
                      });
  std::vector<std::vector<std::optional<PointSharpness>>> sharpness;
  for (const MapQuality& map : maps)
  {
    sharpness.push_back(map.sharpness());
  }
  std::vector<MapSelfScores> result;
  for (const MapSharpness& mean : meanSharpness(sharpness))
  {
    result.push_back({mean, coverage.placed});
  }
  if (!result.empty() && result.front().mean.points == 0)
  {
    listener.warn("no point has " + std::to_string(a.quality.min_neighbours) +
                  " neighbours within " + shortNumber(a.quality.radius) +
                  " m in every map: no figures; raise --neighbourhood or lower --min-neighbours");
  }
  return result;
}

Table mapSelfTable(const std::vector<std::string>& names, const std::vector<MapSelfScores>& scores)
{
  constexpr double square_millimetres = 1e6;  // in a square metre
  Table table({"trajectory", "scans", "points", "entropy", "plane variance [mm2]"});
  for (std::size_t i = 0; i < scores.size(); ++i)
  {
    const MapSharpness& mean = scores[i].mean;
    table.addRow({names[i], TableCell(static_cast<double>(scores[i].scans), 0),
                  TableCell(static_cast<double>(mean.points), 0), TableCell(mean.mean_entropy, 4),
                  TableCell(square_millimetres * mean.mean_plane_variance, 1)});
  }
  return table;
}

std::string mapSelfJson(const MapSelfArguments& a,
                        const std::vector<std::string>& names,
                        const std::vector<MapSelfScores>& scores)
{
  nlohmann::ordered_json json;
  json["rawlog"] = a.rawlog;
  json["neighbourhood_m"] = a.quality.radius;
  json["min_neighbours"] = a.quality.min_neighbours;
  json["trajectories"] = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < scores.size(); ++i)
  {
    const MapSharpness& mean = scores[i].mean;
    json["trajectories"].push_back({{"name", names[i]},
                                    {"scans", scores[i].scans},
                                    {"points", mean.points},
                                    {"mean_map_entropy", mean.mean_entropy},
                                    {"mean_plane_variance_m2", mean.mean_plane_variance}});
  }
  return textOf(json);
}
}  // namespace dyslam
