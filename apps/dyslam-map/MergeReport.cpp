// SPDX-License-Identifier: BSD-3-Clause
#include "MergeReport.h"

#include <dyslam/core/PendingFile.h>
#include <dyslam/eval/MapPicture.h>
#include <dyslam/eval/Statistics.h>
#include <dyslam/formats/ScanFiles.h>

#include <cmath>
#include <filesystem>
#include <optional>
#include <string_view>

namespace dyslam
{
namespace
{
namespace fs = std::filesystem;

constexpr double same_place = 5;    // true positions this near to each other [m]
constexpr double stamp_gap = 0.01;  // of a pose and its truth [s]

/** Estimated and true pose of the run's keyframes. */
struct Checked
{
  std::vector<Pose> merged;
  std::vector<Pose> truth;
};

Checked checkedPoses(const Run& run, const Trajectory& merged)
{
  Checked result;
  for (const double stamp : run.keyframe_stamps)
  {
    const auto estimate = merged.nearest(stamp, stamp_gap);
    const auto truth = run.truth.nearest(stamp, stamp_gap);
    if (estimate && truth)
    {
      result.merged.push_back(merged[*estimate].pose);
      result.truth.push_back(run.truth[*truth].pose);
    }
  }
  return result;
}

/** Of each keyframe of `b` that is near one of `a`: the error of their relative position [m]. */
std::vector<double> errorsBetween(const Checked& a, const Checked& b)
{
  std::vector<double> errors;
  for (std::size_t j = 0; j < b.truth.size(); ++j)
  {
    double nearest = same_place;
    std::optional<double> error;
    for (std::size_t i = 0; i < a.truth.size(); ++i)
    {
      const Pose T_true = a.truth[i].inverse() * b.truth[j];
      if (T_true.translation().norm() < nearest)
      {
        nearest = T_true.translation().norm();
        const Pose T = a.merged[i].inverse() * b.merged[j];
        error = (T.translation() - T_true.translation()).norm();
      }
    }
    if (error)
    {
      errors.push_back(*error);
    }
  }
  return errors;
}

struct LoopCount
{
  std::size_t loops = 0;
  std::size_t left_out = 0;
  double squared = 0;  //!< residuals, summed [m^2]
};

LoopCount loopsBetween(const RunMerge& merge, std::size_t a, std::size_t b)
{
  LoopCount count;
  for (const RunLoop& loop : merge.loops)
  {
    if ((loop.run_from == a && loop.run_to == b) || (loop.run_from == b && loop.run_to == a))
    {
      ++count.loops;
      count.left_out += loop.left_out ? 1 : 0;
      count.squared += loop.left_out ? 0 : loop.residual * loop.residual;
    }
  }
  return count;
}
}  // namespace

Table mergeTable(const std::vector<Run>& runs,
                 const RunMerge& merge,
                 const std::vector<Trajectory>& merged)
{
  Table table(
      {"runs", "loops", "left out", "residual [m]", "places", "error: median [m]", "RMSE", "max"});
  std::vector<Checked> checked;
  for (std::size_t r = 0; r < runs.size(); ++r)
  {
    checked.push_back(checkedPoses(runs[r], merged[r]));
  }
  for (std::size_t b = 1; b < runs.size(); ++b)
  {
    for (std::size_t a = 0; a < b; ++a)
    {
      const LoopCount count = loopsBetween(merge, a, b);
      const std::vector<double> errors = errorsBetween(checked[a], checked[b]);
      if (count.loops == 0 && errors.empty())
      {
        continue;
      }
      const std::size_t kept = count.loops - count.left_out;
      const Statistics s = statisticsOf(errors);
      const auto number = [&](double value)
      { return errors.empty() ? std::nullopt : std::optional<double>(value); };
      table.addRow(
          {runs[a].name + " - " + runs[b].name,
           {static_cast<double>(count.loops), 0},
           {static_cast<double>(count.left_out), 0},
           {kept > 0 ? std::optional<double>(std::sqrt(count.squared / static_cast<double>(kept)))
                     : std::nullopt,
            3},
           {number(static_cast<double>(s.count)), 0},
           {number(s.median), 3},
           {number(s.rmse), 3},
           {number(s.max), 3}});
    }
  }
  return table;
}

void writeRunComparison(const std::vector<Run>& runs,
                        const RunMerge& merge,
                        const MapBuilder& builder,
                        const std::string& path)
{
  std::vector<Eigen::Vector3f> points;
  MapPictureContent before;
  for (std::size_t r = 0; r < runs.size(); ++r)
  {
    if (!merge.joined(r))
    {
      continue;
    }
    const fs::path map = fs::path(runs[r].folder) / "map_static.ply";
    if (fs::exists(map))
    {
      const Scan scan = readCloud(map.string());
      points.insert(points.end(), scan.points.begin(), scan.points.end());
    }
    before.path.emplace_back(Eigen::Vector3d::Constant(NAN));
    for (const auto& [stamp, pose] : runs[r].trajectory)
    {
      before.path.emplace_back(pose.translation());
    }
  }
  before.points = &points;
  MapPictureContent after = builder.picture();
  after.objects.clear();
  const MapPoints merged = builder.map().points();
  after.points = &merged.points;
  const auto png = renderMapComparison({"each run in its own frame", before}, {"merged", after});
  writeWhole(path, std::string_view(reinterpret_cast<const char*>(png.data()), png.size()));
}

std::string namesOfUnjoined(const std::vector<Run>& runs, const RunMerge& merge)
{
  std::string names;
  for (std::size_t r = 0; r < runs.size(); ++r)
  {
    if (!merge.joined(r))
    {
      names += (names.empty() ? "" : ", ") + runs[r].folder;
    }
  }
  return names;
}
}  // namespace dyslam
