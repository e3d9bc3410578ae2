// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Assignment.h>
#include <dyslam/core/BoxOverlap.h>
#include <dyslam/tracking/Tracker.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "Track.h"

namespace dyslam
{
namespace
{
constexpr double forbidden = std::numeric_limits<double>::infinity();

bool usable(const Detection& detection)
{
  return detection.box.center.allFinite() && detection.box.size.allFinite() &&
         std::isfinite(detection.box.yaw) && detection.box.size.minCoeff() > 0 &&
         std::isfinite(detection.score) && detection.covariance.allFinite();
}

Sighting sightingOf(const Detection& detection, int index, const Pose& T_odom_vehicle)
{
  Sighting sighting;
  sighting.index = index;
  sighting.box = transformed(detection.box, T_odom_vehicle);
  Eigen::Matrix4d turn = Eigen::Matrix4d::Identity();
  turn.topLeftCorner<3, 3>() = T_odom_vehicle.linear();
  sighting.covariance = turn * detection.covariance * turn.transpose();
  sighting.sensor = T_odom_vehicle.translation().head<2>();
  sighting.object_class = detection.object_class;
  sighting.score = detection.score;
  sighting.from_points = !detection.points.empty();
  return sighting;
}

bool isReported(const Track& track, const TrackedObject& object)
{
  return object.confirmed && (object.observed || track.misses() <= track.kind().report_misses);
}

Assignment solve(AssociationMethod method, const CostMatrix& cost)
{
  constexpr double unassigned = 1;  // costs are divided by the dearest allowed
  switch (method)
  {
    case AssociationMethod::hungarian:
      return assignHungarian(cost, unassigned);
    case AssociationMethod::greedy:
      return assignGreedy(cost, unassigned);
    default:
      return assignShortestPaths(cost, unassigned);
  }
}
}  // namespace

struct Tracker::Implementation
{
  explicit Implementation(const TrackerOptions& o) : options(o) { validate(options, "tracker"); }

  const TrackerOptions options;
  std::vector<Track> tracks;
  int next_id = 0;
  bool started = false;
  double stamp = 0;

  /** Cost of a pair over the dearest allowed; infinite outside the gates. */
  double pairCost(const Track& track,
                  const Eigen::Matrix2d& information,
                  const Sighting& sighting) const
  {
    const ClassTracking& kind = track.kind();
    const Box seen = track.seenAs(sighting);
    const Eigen::Vector2d apart = (seen.center - track.box().center).head<2>();
    if (apart.squaredNorm() > kind.gate_distance * kind.gate_distance)
    {
      return forbidden;
    }
    const double sigmas = apart.dot(information * apart) / (kind.gate_sigmas * kind.gate_sigmas);
    if (sigmas > 1)
    {
      return forbidden;
    }
    double cost = kind.position_weight * sigmas;
    if (&kind != &kindOf(options, sighting.object_class) &&
        sighting.object_class != ObjectClass::unknown &&
        track.objectClass() != ObjectClass::unknown &&
        !(sighting.from_points && sighting.box.size.x() < track.box().size.x()))
    {
      cost += options.class_mismatch_cost;
    }
    const double angle = std::abs(wrapAngle(seen.yaw - track.box().yaw));
    cost += kind.heading_weight * std::min(angle, M_PI - angle) / (M_PI / 2);
    if (kind.overlap_weight > 0 || kind.min_overlap > -1)
    {
      const double overlap = boxOverlap(track.box(), seen).giou;
      if (overlap < kind.min_overlap)
      {
        return forbidden;
      }
      cost += kind.overlap_weight * 0.5 * (1 - overlap);
    }
    return cost / kind.max_cost;
  }

  /** Whether a cluster is a piece of an object that is tracked already: windows and poles cut
   * bodies in two. */
  bool isPiece(const Sighting& sighting) const
  {
    constexpr double margin = 0.3;  // [m]
    return sighting.from_points &&
           std::any_of(tracks.begin(), tracks.end(),
                       [&](const Track& track)
                       {
                         if (track.misses() > 0)
                         {
                           return false;  // it may be this very object, missed
                         }
                         const Box& box = track.box();
                         const Eigen::Vector2d apart = (sighting.box.center - box.center).head<2>();
                         const Eigen::Rotation2Dd turn(-box.yaw);
                         const Eigen::Vector2d inside = (turn * apart).cwiseAbs();
                         return inside.x() < 0.5 * box.size.x() + margin &&
                                inside.y() < 0.5 * box.size.y() + margin;
                       });
  }

  /** Match the given tracks with the given sightings; what is left of each comes back. */
  void associate(const std::vector<Sighting>& sightings,
                 std::vector<std::size_t>& free_tracks,
                 std::vector<std::size_t>& free_sightings)
  {
    if (free_tracks.empty() || free_sightings.empty())
    {
      return;
    }
    CostMatrix cost(static_cast<Eigen::Index>(free_tracks.size()),
                    static_cast<Eigen::Index>(free_sightings.size()));
    for (std::size_t i = 0; i < free_tracks.size(); ++i)
    {
      const Track& track = tracks[free_tracks[i]];
      const Eigen::Matrix2d information = track.positionCovariance().inverse();
      for (std::size_t j = 0; j < free_sightings.size(); ++j)
      {
        cost(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
            pairCost(track, information, sightings[free_sightings[j]]);
      }
    }
    const Assignment assignment = solve(options.association, cost);
    std::vector<std::size_t> tracks_left;
    std::vector<std::size_t> sightings_left;
    for (std::size_t i = 0; i < free_tracks.size(); ++i)
    {
      const int j = assignment.column_of_row[i];
      if (j >= 0)
      {
        tracks[free_tracks[i]].match(sightings[free_sightings[static_cast<std::size_t>(j)]]);
      }
      else
      {
        tracks_left.push_back(free_tracks[i]);
      }
    }
    for (std::size_t j = 0; j < free_sightings.size(); ++j)
    {
      if (assignment.row_of_column[j] < 0)
      {
        sightings_left.push_back(free_sightings[j]);
      }
    }
    free_tracks = std::move(tracks_left);
    free_sightings = std::move(sightings_left);
  }
};

Tracker::Tracker(const TrackerOptions& options)
    : implementation_(std::make_unique<Implementation>(options))
{
}
Tracker::~Tracker() = default;
Tracker::Tracker(Tracker&&) noexcept = default;
Tracker& Tracker::operator=(Tracker&&) noexcept = default;

void Tracker::update(Frame& frame)
{
  frame.objects = update(frame.scan.stamp, frame.detections, frame.T_odom_vehicle);
}

std::vector<TrackedObject> Tracker::update(double stamp,
                                           const std::vector<Detection>& detections,
                                           const Pose& T_odom_vehicle)
{
  Implementation& self = *implementation_;
  if (!std::isfinite(stamp) || (self.started && stamp <= self.stamp))
  {
    throw std::invalid_argument("Tracker::update: stamps must rise");
  }
  self.started = true;
  self.stamp = stamp;

  std::vector<Sighting> sightings;
  std::vector<std::size_t> strong;
  std::vector<std::size_t> weak;
  for (std::size_t i = 0; i < detections.size(); ++i)
  {
    const ClassTracking& kind = kindOf(self.options, detections[i].object_class);
    if (!usable(detections[i]) || detections[i].score < kind.match_score)
    {
      continue;
    }
    (detections[i].score >= kind.birth_score ? strong : weak).push_back(sightings.size());
    sightings.push_back(sightingOf(detections[i], static_cast<int>(i), T_odom_vehicle));
  }

  std::vector<std::size_t> free_tracks(self.tracks.size());
  for (std::size_t i = 0; i < free_tracks.size(); ++i)
  {
    free_tracks[i] = i;
    self.tracks[i].predict(stamp);
  }
  self.associate(sightings, free_tracks, strong);
  self.associate(sightings, free_tracks, weak);
  for (const std::size_t i : free_tracks)
  {
    self.tracks[i].miss();
  }
  self.tracks.erase(std::remove_if(self.tracks.begin(), self.tracks.end(),
                                   [](const Track& track) { return track.dead(); }),
                    self.tracks.end());
  strong.erase(std::remove_if(strong.begin(), strong.end(),
                              [&](std::size_t i) { return self.isPiece(sightings[i]); }),
               strong.end());
  for (const std::size_t i : strong)
  {
    self.tracks.emplace_back(self.next_id++, stamp, sightings[i], self.options);
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

}  // namespace dyslam
