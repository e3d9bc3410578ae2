// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Printable.h>
#include <dyslam/benchmarks/JsonText.h>
#include <dyslam/benchmarks/MethodGroups.h>
#include <dyslam/benchmarks/TrajectoryComparison.h>
#include <dyslam/core/TimeRange.h>
#include <dyslam/eval/Axes.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

namespace dyslam
{
namespace
{
/** Diagonal of the box around the positions [m]. */
double extentOf(const std::vector<Pose>& poses)
{
  Eigen::AlignedBox3d box;
  for (const Pose& pose : poses)
  {
    box.extend(pose.translation());
  }
  return box.diagonal().norm();
}

/** The poses as meant by a file whose quaternions have w first, read with w last. */
std::vector<Pose> withScalarFirst(std::vector<Pose> poses)
{
  for (Pose& pose : poses)
  {
    const Eigen::Quaterniond read(pose.linear());
    pose.linear() = Eigen::Quaterniond(read.x(), read.y(), read.z(), read.w()).toRotationMatrix();
  }
  return poses;
}

constexpr double turned_deg = 45;  //!< orientations with a larger error do not fit

/** Which side has orientations that fit if w is the first number of its file's quaternions: 'e' the
 * estimate, 'r' the reference, nothing if they fit as read or not at all. */
std::optional<char> sideWithScalarFirst(const PosePairs& pairs)
{
  const auto turn = [](const PosePairs& of)
  { return absoluteTrajectoryError(of, Alignment::se3).rotation_deg.rmse; };
  if (turn(pairs) <= turned_deg)
  {
    return std::nullopt;
  }
  PosePairs estimate = pairs;
  estimate.estimate = withScalarFirst(pairs.estimate);
  if (pairs.estimate_has_quaternions && compareBodyAxes(estimate) == BodyAxes::same &&
      turn(estimate) <= turned_deg)
  {
    return 'e';
  }
  PosePairs reference = pairs;
  reference.reference = withScalarFirst(pairs.reference);
  const bool fits = pairs.reference_has_quaternions &&
                    compareBodyAxes(reference) == BodyAxes::same && turn(reference) <= turned_deg;
  return fits ? std::optional<char>('r') : std::nullopt;
}

/** Mean over the estimates, for benchmarks of several sequences; the drift over those that are long
 * enough to have one. */
TrajectoryReport meanDrift(const std::vector<TrajectoryReport>& reports, const std::string& method)
{
  TrajectoryReport mean;
  mean.name = method.empty() ? "mean" : "mean of " + method;
  const auto with_drift = static_cast<double>(
      std::count_if(reports.begin(), reports.end(),
                    [](const TrajectoryReport& r) { return r.drift.overall.segments > 0; }));
  for (const auto& r : reports)
  {
    mean.pairs += r.pairs;
    mean.length += r.length;
    if (r.drift.overall.segments > 0)
    {
      mean.drift.overall.segments += r.drift.overall.segments;
      mean.drift.overall.translation_percent += r.drift.overall.translation_percent / with_drift;
      mean.drift.overall.rotation_deg_per_100m +=
          r.drift.overall.rotation_deg_per_100m / with_drift;
    }
  }
  return mean;
}

void addMeanRow(Table& table, const TrajectoryReport& mean)
{
  const SegmentDrift& drift = mean.drift.overall;
  const auto shown = [&](double value)
  { return drift.segments > 0 ? std::optional<double>(value) : std::nullopt; };
  std::vector<TableCell> cells{mean.name, TableCell(static_cast<double>(mean.pairs), 0),
                               TableCell(mean.length, 1),
                               TableCell(shown(drift.translation_percent), 4),
                               TableCell(shown(drift.rotation_deg_per_100m), 4)};
  while (cells.size() < table.columns())
  {
    cells.emplace_back("-");
  }
  table.addRow(std::move(cells));
}

/** Warns of poses of a camera that are compared with those of a lidar. \param is_estimate whether
 * the estimate is the camera's */
std::string cameraWarning(const std::string& reference,
                          const std::string& estimate,
                          const PoseReading& reading,
                          bool is_estimate)
{
  const std::string& camera = is_estimate ? estimate : reference;
  const std::string& lidar = is_estimate ? reference : estimate;
  if (reading.camera == (is_estimate ? "reference" : "estimate"))
  {
    return "--camera " + reading.camera + " has converted " + lidar +
           " to the axes of a lidar, but " + camera +
           " has those of a camera (z ahead), too; without --camera the files decide";
  }
  return "the poses of " + camera + " have the axes of a camera (z ahead), those of " + lidar +
         " the axes of a lidar (x ahead); compare them with --camera " +
         (is_estimate ? "estimate" : "reference") + " (and --calib calib.txt)";
}
}  // namespace

std::string pairWarning(const std::string& reference,
                        const std::string& estimate,
                        const PoseReading& reading,
                        const PosePairs& pairs,
                        const TrajectoryReport& report)
{
  const auto scalar_first = pairs.positions_only ? std::nullopt : sideWithScalarFirst(pairs);
  if (scalar_first)
  {
    return "the orientations of " + (*scalar_first == 'e' ? estimate : reference) +
           " fit if its quaternions have w first; a TUM file has w last (t x y z qx qy qz qw)";
  }
  const BodyAxes axes = pairs.positions_only ? BodyAxes::same : compareBodyAxes(pairs);
  if (axes == BodyAxes::differ)
  {
    return estimate + " and " + reference +
           " move in different directions of their bodies: their axes differ; --reference-body "
           "'0 0 0 yaw 0 0' states by how much";
  }
  if (axes != BodyAxes::same)
  {
    return cameraWarning(reference, estimate, reading, axes == BodyAxes::estimate_camera);
  }
  constexpr double other_unit = 50;   // least ratio of the extents
  constexpr double least_extent = 1;  // less is mostly noise [m]
  constexpr double fits = 0.1;        // largest error of positions that fit, of the extent
  const double true_extent = extentOf(pairs.reference);
  const double extent = extentOf(pairs.estimate);
  const auto [less, more] = std::minmax(extent, true_extent);
  if (less > 0 && more > least_extent && more > other_unit * less)
  {
    return "the positions of " + estimate + " extend over " + shortNumber(extent) +
           " m, those of " + reference + " over " + shortNumber(true_extent) +
           " m: are both in metres?";
  }
  if (!pairs.positions_only && report.alignment == Alignment::se3 && true_extent > least_extent &&
      report.absolute.translation.rmse < fits * true_extent &&
      report.absolute.rotation_deg.rmse > turned_deg)
  {
    return "the positions of " + estimate + " fit those of " + reference +
           ", the orientations do not (" +
           shortNumber(std::round(report.absolute.rotation_deg.rmse)) + " deg): " +
           (pairs.estimate_has_quaternions || pairs.reference_has_quaternions
                ? "quaternions with w first (TUM has it last), or "
                : "") +
           "other axes (--reference-body)";
  }
  return "";
}

std::vector<std::string> comparisonNotes(const std::vector<TrajectoryReport>& reports,
                                         bool same_reference)
{
  std::vector<std::string> notes;
  const auto fewer = [](const TrajectoryReport& a, const TrajectoryReport& b)
  { return a.pairs < b.pairs; };
  const auto [fewest, most] = std::minmax_element(reports.begin(), reports.end(), fewer);
  if (same_reference && !reports.empty() && 10 * fewest->pairs < 9 * most->pairs)
  {
    notes.push_back("RPE is from one pose to the next, and " + fewest->name + " has " +
                    counted(fewest->pairs, "pose") + ", " + most->name + " " +
                    std::to_string(most->pairs) +
                    ": compare the figures of estimates with poses at the same times");
  }
  for (const TrajectoryReport& report : reports)
  {
    if (report.absolute.turned_by_orientations)
    {
      notes.push_back(report.name +
                      ": its path is nearly straight, so the rotation about it is that of the "
                      "orientations; ATE [m] of evo, by the positions alone, may be lower");
    }
  }
  return notes;
}

std::string addMeanRows(Table& table,
                        const std::vector<TrajectoryReport>& reports,
                        const std::vector<std::string>& files,
                        const std::vector<std::string>& references)
{
  const std::vector<MethodGroup> groups = methodGroups(files, references);
  for (const MethodGroup& group : groups)
  {
    std::vector<TrajectoryReport> of_method;
    for (const std::size_t i : group.estimates)
    {
      of_method.push_back(reports[i]);
    }
    addMeanRow(table, meanDrift(of_method, group.name));
  }
  return groups.empty() ? "no mean, as references are repeated: give the estimates of one method "
                          "after the other, each of the same references and in a folder of its own"
                        : "";
}

Table pathTable(const std::vector<PathSummary>& paths)
{
  Table table({"trajectory", "poses", "duration [s]", "length [m]", "start to end [m]"});
  for (const PathSummary& path : paths)
  {
    table.addRow({path.name, TableCell(static_cast<double>(path.trajectory.size()), 0),
                  TableCell(path.duration, 1), TableCell(path.length, 1),
                  TableCell(path.start_to_end, 3)});
  }
  return table;
}

std::string pathJson(const std::vector<PathSummary>& paths)
{
  nlohmann::ordered_json json;
  json["trajectories"] = nlohmann::ordered_json::array();
  for (const PathSummary& path : paths)
  {
    json["trajectories"].push_back({{"name", path.name},
                                    {"estimated_poses", path.trajectory.size()},
                                    {"duration_s", orNull(path.duration)},
                                    {"length_m", path.length},
                                    {"start_to_end_m", path.start_to_end}});
  }
  return textOf(json);
}
}  // namespace dyslam
