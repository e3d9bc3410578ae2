// SPDX-License-Identifier: BSD-3-Clause
#include "MergeTable.h"

#include <dyslam/base/Angle.h>
#include <dyslam/base/Statistics.h>

#include <cmath>
#include <optional>

namespace dyslam
{
namespace
{
constexpr double same_place = 5;    // true positions this near to each other [m]
constexpr double stamp_gap = 0.01;  // of a pose and its truth [s]

/** Estimated and true pose of the run's keyframes. */
struct Checked
{
  std::vector<Pose> merged;
  std::vector<Pose> truth;
};

Checked checkedPoses(const RunFolder& run, const Trajectory& merged, const Trajectory& truth)
{
  Checked result;
  for (const double stamp : run.keyframe_stamps)
  {
    const auto estimate = merged.nearest(stamp, stamp_gap);
    const auto true_pose = truth.nearest(stamp, stamp_gap);
    if (estimate && true_pose)
    {
      result.merged.push_back(merged[*estimate].pose);
      result.truth.push_back(truth[*true_pose].pose);
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

Table mergeTable(const std::vector<RunFolder>& runs,
                 const MergedRuns& joined,
                 const std::vector<Trajectory>& merged)
{
  Table table(
      {"runs", "loops", "left out", "residual [m]", "places", "error: median [m]", "RMSE", "max"});
  std::vector<Checked> checked;
  for (std::size_t r = 0; r < runs.size(); ++r)
  {
    checked.push_back(checkedPoses(runs[r], merged[r], joined.truth[r]));
  }
  for (std::size_t b = 1; b < runs.size(); ++b)
  {
    for (std::size_t a = 0; a < b; ++a)
    {
      const LoopCount count = loopsBetween(joined.merge, a, b);
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

Table referenceTable(const std::vector<RunFolder>& runs, const RunMerge& merge)
{
  Table table({"run", "positions", "horizontal RMSE [m]", "vertical RMSE [m]", "vertical off [deg]",
               "sigma [deg]"});
  for (std::size_t r = 0; r < runs.size(); ++r)
  {
    const ReferenceFit& fit = merge.fits[r];
    if (fit.positions == 0 && !fit.up_error)
    {
      continue;
    }
    const auto ofPositions = [&](double value)
    { return fit.positions > 0 ? std::optional<double>(value) : std::nullopt; };
    const auto ofVertical = [&](double angle)
    { return fit.up_error ? std::optional<double>(degrees_per_radian * angle) : std::nullopt; };
    table.addRow({runs[r].name,
                  {ofPositions(static_cast<double>(fit.positions)), 0},
                  {ofPositions(fit.horizontal_rmse), 2},
                  {ofPositions(fit.vertical_rmse), 2},
                  {ofVertical(fit.up_error.value_or(0)), 2},
                  {ofVertical(fit.up_sigma), 2}});
  }
  return table;
}
}  // namespace dyslam
