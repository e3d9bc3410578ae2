// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Angle.h>
#include <dyslam/base/Assignment.h>
#include <dyslam/base/Statistics.h>
#include <dyslam/eval/TrackErrors.h>

#include <cmath>
#include <iterator>
#include <limits>

#include "TrackPreparation.h"

namespace dyslam
{
using track_evaluation::isIgnored;
using track_evaluation::sameType;

namespace
{
using Boxes = std::vector<const LabelledBox*>;

std::vector<Boxes> byFrame(const std::vector<LabelledBox>& boxes, int frames)
{
  std::vector<Boxes> result(static_cast<std::size_t>(std::max(0, frames)));
  for (const LabelledBox& box : boxes)
  {
    if (box.frame >= 0 && box.frame < frames && box.id >= 0 && !sameType(box.type, "DontCare"))
    {
      result[static_cast<std::size_t>(box.frame)].push_back(&box);
    }
  }
  return result;
}

double distance(const LabelledBox& a, const LabelledBox& b)
{
  return (a.box.centre - b.box.centre).head<2>().norm();
}

std::optional<double> find(const TrackSpeeds& speeds, const LabelledBox& box)
{
  const auto found = speeds.find({box.frame, box.id});
  return found == speeds.end() ? std::nullopt : std::optional<double>(found->second);
}

TrackError errorOf(const LabelledBox& reference)
{
  TrackError error;
  error.frame = reference.frame;
  error.id = reference.id;
  error.type = reference.type;
  error.range = reference.box.centre.head<2>().norm();
  return error;
}

struct StampedPosition
{
  double stamp;
  Eigen::Vector3d position;  // world frame [m]
};
using StampedPositions = std::map<std::pair<int, int>, StampedPosition>;  // by id and frame

/** The centres of the boxes in frames with a pose. */
StampedPositions positionsOf(const std::vector<LabelledBox>& boxes,
                             const std::map<int, StampedPose>& T_world_lidar)
{
  StampedPositions positions;
  for (const LabelledBox& box : boxes)
  {
    const auto pose = T_world_lidar.find(box.frame);
    if (box.id >= 0 && pose != T_world_lidar.end())
    {
      positions[{box.id, box.frame}] = {pose->second.stamp, pose->second.pose * box.box.centre};
    }
  }
  return positions;
}

void compare(TrackError& error, const LabelledBox& reference, const LabelledBox& estimate)
{
  error.found = true;
  error.same_type = sameType(reference.type, estimate.type);
  error.position = distance(reference, estimate);
  const double angle = std::abs(wrapAngle(estimate.box.yaw - reference.box.yaw));
  error.yaw = std::min(angle, M_PI - angle);
}
}  // namespace

TrackSpeeds speedsFrom(const std::vector<LabelledBox>& boxes,
                       const std::map<int, StampedPose>& T_world_lidar)
{
  const StampedPositions observations = positionsOf(boxes, T_world_lidar);
  TrackSpeeds speeds;
  for (auto now = observations.begin(); now != observations.end(); ++now)
  {
    const auto [id, frame] = now->first;
    auto first = observations.find({id, frame - 1});
    auto last = observations.find({id, frame + 1});
    first = first == observations.end() ? now : first;
    last = last == observations.end() ? now : last;
    const double dt = last->second.stamp - first->second.stamp;
    if (dt > 0)
    {
      speeds[{frame, id}] = (last->second.position - first->second.position).head<2>().norm() / dt;
    }
  }
  return speeds;
}

CentresByFrame hiddenCentres(const std::vector<LabelledBox>& boxes,
                             const std::map<int, StampedPose>& T_world_lidar)
{
  const StampedPositions observations = positionsOf(boxes, T_world_lidar);
  CentresByFrame hidden;
  for (auto after = observations.begin(); after != observations.end(); ++after)
  {
    const auto before = after == observations.begin() ? after : std::prev(after);
    const double dt = after->second.stamp - before->second.stamp;
    if (before->first.first != after->first.first || !(dt > 0))
    {
      continue;  // of another object, or at the same time
    }
    const auto end = T_world_lidar.lower_bound(after->first.second);
    for (auto pose = T_world_lidar.upper_bound(before->first.second); pose != end; ++pose)
    {
      const double part = (pose->second.stamp - before->second.stamp) / dt;
      const Eigen::Vector3d position =
          before->second.position + part * (after->second.position - before->second.position);
      hidden[pose->first].push_back(pose->second.pose.inverse() * position);
    }
  }
  return hidden;
}

std::vector<TrackError> trackErrors(const TrackSequence& sequence,
                                    const TrackRules& rules,
                                    double max_distance,
                                    const TrackSpeeds& true_speeds,
                                    const TrackSpeeds& estimated_speeds)
{
  const std::vector<Boxes> references = byFrame(sequence.reference, sequence.frames);
  const std::vector<Boxes> estimates = byFrame(sequence.estimate, sequence.frames);
  std::vector<TrackError> errors;
  for (std::size_t f = 0; f < references.size(); ++f)
  {
    CostMatrix cost(static_cast<Eigen::Index>(references[f].size()),
                    static_cast<Eigen::Index>(estimates[f].size()));
    for (Eigen::Index i = 0; i < cost.rows(); ++i)
    {
      for (Eigen::Index j = 0; j < cost.cols(); ++j)
      {
        const double separation = distance(*references[f][static_cast<std::size_t>(i)],
                                           *estimates[f][static_cast<std::size_t>(j)]);
        cost(i, j) =
            separation <= max_distance ? separation : std::numeric_limits<double>::infinity();
      }
    }
    const Assignment assignment = assignShortestPaths(cost);
    for (std::size_t i = 0; i < references[f].size(); ++i)
    {
      const LabelledBox& reference = *references[f][i];
      if (isIgnored(reference, rules))
      {
        continue;
      }
      TrackError error = errorOf(reference);
      if (assignment.column_of_row[i] >= 0)
      {
        const LabelledBox& estimate =
            *estimates[f][static_cast<std::size_t>(assignment.column_of_row[i])];
        compare(error, reference, estimate);
        const auto truth = find(true_speeds, reference);
        const auto ours = find(estimated_speeds, estimate);
        if (truth && ours)
        {
          error.speed = *ours - *truth;
        }
      }
      errors.push_back(std::move(error));
    }
  }
  return errors;
}

TrackErrorSummary summaryOf(const std::vector<TrackError>& errors,
                            const std::string& type,
                            double min_range,
                            double max_range)
{
  TrackErrorSummary summary;
  std::vector<double> positions;
  std::vector<double> yaws;
  for (const TrackError& error : errors)
  {
    if ((!type.empty() && !sameType(type, error.type)) || error.range < min_range ||
        error.range >= max_range)
    {
      continue;
    }
    ++summary.boxes;
    if (!error.found)
    {
      continue;
    }
    ++summary.found;
    summary.same_type += error.same_type ? 1 : 0;
    positions.push_back(error.position);
    yaws.push_back(error.yaw);
    if (error.speed)
    {
      ++summary.speeds;
      summary.speed_mean_abs += std::abs(*error.speed);
      summary.speed_bias += *error.speed;
    }
  }
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  const bool any = summary.found > 0;
  const Statistics position = statisticsOf(positions);
  summary.position_mean = any ? position.mean : none;
  summary.position_rmse = any ? position.rmse : none;
  summary.yaw_median = any ? statisticsOf(yaws).median : none;
  const double speeds = summary.speeds > 0 ? static_cast<double>(summary.speeds) : none;
  summary.speed_mean_abs /= speeds;
  summary.speed_bias /= speeds;
  return summary;
}
}  // namespace dyslam
