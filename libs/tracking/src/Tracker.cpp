// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Angle.h>
#include <dyslam/base/Assignment.h>
#include <dyslam/base/Error.h>
#include <dyslam/base/StateArchive.h>
#include <dyslam/core/BoxInterior.h>
#include <dyslam/core/BoxOverlap.h>
#include <dyslam/tracking/Tracker.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>

#include "NoiseScale.h"
#include "PredictedPoints.h"
#include "Track.h"

namespace dyslam
{
namespace
{
constexpr double forbidden = std::numeric_limits<double>::infinity();
/** Longest time between scans over which tracks are predicted [s]. */
constexpr double longest_gap = 5;

bool isValid(const Detection& detection)
{
  return detection.box.centre.allFinite() && detection.box.size.allFinite() &&
         std::isfinite(detection.box.yaw) && detection.box.size.minCoeff() > 0 &&
         std::isfinite(detection.score) && detection.covariance.allFinite();
}

/** \param lidar position in the vehicle frame [m] */
Observation toObservation(const Detection& detection,
                          int index,
                          const Pose& T_odom_vehicle,
                          const Eigen::Vector3d& lidar)
{
  Observation observation;
  observation.index = index;
  observation.box = transformed(detection.box, T_odom_vehicle);
  Eigen::Matrix4d turn = Eigen::Matrix4d::Identity();
  turn.topLeftCorner<3, 3>() = T_odom_vehicle.linear();
  observation.covariance = turn * detection.covariance * turn.transpose();
  observation.sensor = (T_odom_vehicle * lidar).head<2>();
  observation.object_class = detection.object_class;
  observation.score = detection.score;
  observation.from_points = !detection.points.empty() && !detection.external;
  observation.predicted = detection.predicted;
  return observation;
}

/** Observations of a scan, and those that are not assigned to a track. */
struct Observations
{
  std::vector<Observation> all;
  std::vector<std::size_t> strong;  //!< indices of those with at least birth_score
  std::vector<std::size_t> weak;    //!< indices of the others
};

bool isReported(const Track& track, const TrackedObject& object)
{
  return object.confirmed &&
         (object.observed || track.misses() <= track.classOptions().report_misses);
}

Assignment solveAssignment(AssociationMethod method, const CostMatrix& cost)
{
  constexpr double unassigned = 1;  // cost; all costs are relative to max_cost
  switch (method)
  {
    case AssociationMethod::greedy:
      return assignGreedy(cost, unassigned);
    default:
      return assignShortestPaths(cost, unassigned);
  }
}
}  // namespace

struct Tracker::Implementation
{
  Implementation(const TrackerOptions& o, MovingLabels of_clusters)
      : options(o), labels(of_clusters)
  {
    validate(options, "tracker");
    if (options.static_speed > options.dynamic_speed)
    {
      throw UserError("[tracker] static_speed must not be above dynamic_speed");
    }
  }

  const TrackerOptions options;
  const MovingLabels labels;
  std::vector<Track> tracks;
  std::map<const ClassTracking*, NoiseScale> noise;  //!< noise of boxes by class options
  int next_id = 0;
  bool started = false;
  double stamp = 0;

  /** Whether tracks are continued at the time of a scan [s]. */
  bool continuesAt(double time) const { return time - stamp <= longest_gap; }

  /** Association cost of a pair, relative to max_cost; infinite outside the gates. */
  double associationCost(const Track& track,
                         const Eigen::Matrix2d& information,
                         const Observation& observation) const
  {
    const ClassTracking& class_options = track.classOptions();
    const Box seen = track.alignedBox(observation);
    const Eigen::Vector2d difference = (seen.centre - track.box().centre).head<2>();
    if (difference.norm() > track.gateDistance())
    {
      return forbidden;
    }
    const double gate_ratio = difference.dot(information * difference) /
                              (class_options.gate_sigmas * class_options.gate_sigmas);
    if (gate_ratio > 1)
    {
      return forbidden;
    }
    double cost = gate_ratio;
    if (&class_options != &optionsFor(options, observation.object_class) &&
        observation.object_class != ObjectClass::unknown &&
        track.objectClass() != ObjectClass::unknown &&
        !(observation.from_points && observation.box.size.x() < track.box().size.x()))
    {
      cost += options.class_mismatch_cost;
    }
    const double angle = std::abs(wrapAngle(seen.yaw - track.box().yaw));
    cost += class_options.heading_weight * std::min(angle, M_PI - angle) / (M_PI / 2);
    if (class_options.overlap_weight > 0 || class_options.min_overlap > -1)
    {
      Box predicted = track.box();
      if (track.isNew())
      {
        predicted.centre = seen.centre;  // motion unknown: only sizes and headings are compared
      }
      const double overlap = boxOverlap(predicted, seen).giou;
      if (overlap < class_options.min_overlap)
      {
        return forbidden;
      }
      cost += class_options.overlap_weight * 0.5 * (1 - overlap);
    }
    return cost / class_options.max_cost;
  }

  /** Whether a cluster is a fragment of an object that is already tracked: windows and poles split
   * objects. */
  bool isFragment(const Observation& observation) const
  {
    // Only the footprint counts: a fragment may be higher or lower.
    const Eigen::Vector3d margin(0.3, 0.3, std::numeric_limits<double>::infinity());  // [m]
    return observation.from_points &&
           std::any_of(tracks.begin(), tracks.end(),
                       [&](const Track& track)
                       {
                         if (track.misses() > 0)
                         {
                           return false;  // the cluster may be this object
                         }
                         const BoxInterior<double> inside(track.box(), margin);
                         return inside.contains(observation.box.centre);
                       });
  }

  /** A detection in the odometry frame, with the noise found for its kind. */
  Observation observationOf(const Detection& detection,
                            int index,
                            const Pose& T_odom_vehicle,
                            const Eigen::Vector3d& lidar)
  {
    Observation observation = toObservation(detection, index, T_odom_vehicle, lidar);
    observation.complete = observation.from_points && labels == MovingLabels::hindsight;
    if (options.adapt_noise && !observation.from_points)
    {
      const double factor = noise[&optionsFor(options, detection.object_class)].factor();
      observation.noise_factor = factor;
      observation.covariance.topLeftCorner<2, 2>() *= factor * factor;
    }
    return observation;
  }

  void recordNoise(const Track& track, const Observation& observation)
  {
    if (!options.adapt_noise || observation.from_points)
    {
      return;
    }
    const auto found = whiteNoise(track.history(), observation.covariance.topLeftCorner<2, 2>());
    if (found)
    {
      noise[&optionsFor(options, observation.object_class)].add(*found * observation.noise_factor);
    }
  }

  /** Associates tracks with observations; unassigned ones remain in both lists. */
  void associate(const std::vector<Observation>& observations,
                 std::vector<std::size_t>& unmatched_tracks,
                 std::vector<std::size_t>& unmatched_observations)
  {
    if (unmatched_tracks.empty() || unmatched_observations.empty())
    {
      return;
    }
    CostMatrix cost(static_cast<Eigen::Index>(unmatched_tracks.size()),
                    static_cast<Eigen::Index>(unmatched_observations.size()));
    for (std::size_t i = 0; i < unmatched_tracks.size(); ++i)
    {
      const Track& track = tracks[unmatched_tracks[i]];
      const Eigen::Matrix2d information = track.positionCovariance().inverse();
      for (std::size_t j = 0; j < unmatched_observations.size(); ++j)
      {
        cost(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
            associationCost(track, information, observations[unmatched_observations[j]]);
      }
    }
    const Assignment assignment = solveAssignment(options.association, cost);
    std::vector<std::size_t> remaining_tracks;
    std::vector<std::size_t> remaining_observations;
    for (std::size_t i = 0; i < unmatched_tracks.size(); ++i)
    {
      const int j = assignment.column_of_row[i];
      if (j >= 0)
      {
        const Observation& observation =
            observations[unmatched_observations[static_cast<std::size_t>(j)]];
        Track& track = tracks[unmatched_tracks[i]];
        track.match(observation);
        recordNoise(track, observation);
      }
      else
      {
        remaining_tracks.push_back(unmatched_tracks[i]);
      }
    }
    for (std::size_t j = 0; j < unmatched_observations.size(); ++j)
    {
      if (assignment.row_of_column[j] < 0)
      {
        remaining_observations.push_back(unmatched_observations[j]);
      }
    }
    unmatched_tracks = std::move(remaining_tracks);
    unmatched_observations = std::move(remaining_observations);
  }

  /** The detections of a scan that may belong to tracks. */
  Observations observationsOf(const std::vector<Detection>& detections,
                              const Pose& T_odom_vehicle,
                              const Eigen::Vector3d& lidar)
  {
    Observations result;
    for (std::size_t i = 0; i < detections.size(); ++i)
    {
      const ClassTracking& class_options = optionsFor(options, detections[i].object_class);
      if (!isValid(detections[i]) || detections[i].score < class_options.match_score)
      {
        continue;
      }
      (detections[i].score >= class_options.birth_score ? result.strong : result.weak)
          .push_back(result.all.size());
      result.all.push_back(
          observationOf(detections[i], static_cast<int>(i), T_odom_vehicle, lidar));
    }
    return result;
  }

  /** Associates all tracks, predicted to the stamp of the observations, and updates them. New
   * tracks have wide gates, so that they are associated last. Unassigned observations remain in the
   * lists of strong and weak ones. */
  void updateTracks(Observations& seen)
  {
    tracks.erase(std::remove_if(tracks.begin(), tracks.end(),
                                [&](const Track& track) { return track.isAliased(seen.all); }),
                 tracks.end());
    std::vector<std::size_t> known_tracks;
    std::vector<std::size_t> new_tracks;
    for (std::size_t i = 0; i < tracks.size(); ++i)
    {
      (tracks[i].isNew() ? new_tracks : known_tracks).push_back(i);
    }
    for (std::vector<std::size_t>* unmatched_tracks : {&known_tracks, &new_tracks})
    {
      associate(seen.all, *unmatched_tracks, seen.strong);
      associate(seen.all, *unmatched_tracks, seen.weak);
      for (const std::size_t i : *unmatched_tracks)
      {
        tracks[i].miss();
      }
    }
  }
};

Tracker::Tracker(const TrackerOptions& options, MovingLabels labels)
    : implementation_(std::make_unique<Implementation>(options, labels))
{
}
Tracker::~Tracker() = default;
Tracker::Tracker(Tracker&&) noexcept = default;
Tracker& Tracker::operator=(Tracker&&) noexcept = default;

void Tracker::markPredicted(Frame& frame) const
{
  frame.moving_by_prediction.clear();
  if (!implementation_->continuesAt(frame.time()))
  {
    return;
  }
  for (const Track& track : implementation_->tracks)
  {
    if (track.movesByPrediction())
    {
      Track ahead = track;
      ahead.predict(frame.time());
      markMissed(transformed(ahead.box(), frame.T_odom_vehicle.inverse()), implementation_->labels,
                 frame);
    }
  }
}

void Tracker::update(Frame& frame)
{
  frame.objects = update(frame.time(), frame.detections, frame.T_odom_vehicle,
                         frame.scan.T_vehicle_lidar.translation());
}

std::vector<TrackedObject> Tracker::update(double stamp,
                                           const std::vector<Detection>& detections,
                                           const Pose& T_odom_vehicle,
                                           const Eigen::Vector3d& lidar)
{
  Implementation& self = *implementation_;
  if (!std::isfinite(stamp) || (self.started && stamp <= self.stamp))
  {
    throw std::invalid_argument("Tracker::update: stamps must increase");
  }
  if (!self.continuesAt(stamp))
  {
    self.tracks.clear();
  }
  self.started = true;
  self.stamp = stamp;

  Observations seen = self.observationsOf(detections, T_odom_vehicle, lidar);
  for (Track& track : self.tracks)
  {
    track.predict(stamp);
  }
  self.updateTracks(seen);
  self.tracks.erase(std::remove_if(self.tracks.begin(), self.tracks.end(),
                                   [](const Track& track) { return track.dead(); }),
                    self.tracks.end());
  seen.strong.erase(std::remove_if(seen.strong.begin(), seen.strong.end(),
                                   [&](std::size_t i) { return self.isFragment(seen.all[i]); }),
                    seen.strong.end());
  for (const std::size_t i : seen.strong)
  {
    self.tracks.emplace_back(self.next_id++, stamp, seen.all[i], self.options);
  }

  std::vector<TrackedObject> objects;
  objects.reserve(self.tracks.size());
  for (const Track& track : self.tracks)
  {
    objects.push_back(track.object());
    objects.back().reported = isReported(track, objects.back());
  }
  return objects;
}

void Tracker::exchangeState(StateArchive& archive)
{
  Implementation& self = *implementation_;
  std::size_t count = self.tracks.size();
  archive(self.next_id, self.started, self.stamp, count);
  if (archive.isLoading())
  {
    self.tracks.clear();
  }
  for (std::size_t i = 0; i < count; ++i)
  {
    if (archive.isLoading())
    {
      self.tracks.emplace_back(self.options);
    }
    archive(self.tracks[i]);
  }
  for (const ClassTracking* kind :
       {&self.options.vehicle, &self.options.cyclist, &self.options.pedestrian})
  {
    archive(self.noise[kind]);
  }
}
}  // namespace dyslam
