// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/StateArchive.h>
#include <dyslam/tracking/Tracker.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <utility>

#include "TestDetections.h"

using namespace dyslam;
using Eigen::Vector2d;

namespace
{
using test::carAt;
using test::clusterAt;
using test::dt;

struct Actor
{
  std::function<Vector2d(double)> where;
  std::function<bool(int)> seen = [](int) { return true; };
};

/** Tracking results per actor; actors are identified by the detections' true ids. */
struct Outcome
{
  std::map<int, std::vector<int>> ids;       //!< ids of each actor's reported track, by scan
  std::map<int, TrackedObject> last;         //!< each actor's track when last observed
  std::set<int> all_ids;                     //!< of all reported tracks
  std::vector<TrackedObject> final_objects;  //!< tracks after the last scan
  std::map<int, int> changes;                //!< id switches per actor
  double max_position_error = 0;             //!< of observed reported tracks, after 10 scans [m]
};

Outcome play(
    const std::vector<Actor>& actors,
    int scans,
    double noise,
    const TrackerOptions& options = {},
    const std::function<Pose(double)>& sensor = [](double) { return Pose::Identity(); })
{
  std::mt19937 generator(17);
  std::normal_distribution<double> normal(0, noise);
  Tracker tracker(options);
  Outcome outcome;
  for (int scan = 0; scan < scans; ++scan)
  {
    const double t = dt * scan;
    const Pose T_odom_vehicle = sensor(t);
    std::vector<std::pair<Detection, int>> seen;  // with its actor
    for (std::size_t i = 0; i < actors.size(); ++i)
    {
      if (actors[i].seen(scan))
      {
        const Vector2d w = actors[i].where(t);
        const Eigen::Vector3d v =
            T_odom_vehicle.inverse() *
            Eigen::Vector3d(w.x() + normal(generator), w.y() + normal(generator), 0);
        seen.emplace_back(carAt(v.head<2>()), static_cast<int>(i));
      }
    }
    std::shuffle(seen.begin(), seen.end(), generator);
    std::vector<Detection> detections;
    for (const auto& [detection, actor] : seen)
    {
      detections.push_back(detection);
    }
    outcome.final_objects = tracker.update(t, detections, T_odom_vehicle);
    for (const TrackedObject& object : outcome.final_objects)
    {
      if (!object.reported)
      {
        continue;
      }
      outcome.all_ids.insert(object.id);
      if (object.detection < 0)
      {
        continue;
      }
      const int actor = seen[static_cast<std::size_t>(object.detection)].second;
      std::vector<int>& ids = outcome.ids[actor];
      outcome.changes[actor] += !ids.empty() && ids.back() != object.id ? 1 : 0;
      ids.push_back(object.id);
      outcome.last[actor] = object;
      if (scan >= 10)
      {
        const Vector2d truth = actors[static_cast<std::size_t>(actor)].where(t);
        outcome.max_position_error =
            std::max(outcome.max_position_error, (object.box.centre.head<2>() - truth).norm());
      }
    }
  }
  return outcome;
}

std::function<Vector2d(double)> straightPath(const Vector2d& start, const Vector2d& velocity)
{
  return [=](double t) -> Vector2d { return start + t * velocity; };
}
}  // namespace

TEST(Tracker, followsOneCarWithItsVelocity)
{
  const Outcome o = play({{straightPath({5, 2}, {8, -1})}}, 40, 0.05);
  ASSERT_EQ(o.all_ids.size(), 1u);
  EXPECT_EQ(o.ids.at(0).size(), 38u);  // reported from the third observation on
  EXPECT_LT((o.last.at(0).velocity.head<2>() - Vector2d(8, -1)).norm(), 0.3);
  EXPECT_TRUE(o.last.at(0).dynamic);
  EXPECT_LT(o.max_position_error, 0.3);
}

TEST(Tracker, goesOnFromItsState)
{
  for (const TrackMotion motion :
       {TrackMotion::adaptive, TrackMotion::kalman, TrackMotion::polynomial})
  {
    TrackerOptions options;
    options.motion = motion;
    Tracker tracker(options);
    Tracker loaded(options);
    const auto detections = [](int scan)
    {
      const double x = 0.9 * scan;
      std::vector<Detection> all{carAt({x, 3}), clusterAt({20 - 0.5 * x, -4})};
      all.back().points.clear();
      all.push_back(clusterAt({5 + 0.02 * x, 8}));
      return all;
    };
    for (int scan = 0; scan < 25; ++scan)
    {
      if (scan == 12)
      {
        StateArchive saved;
        saved(tracker);
        StateArchive archive(saved.bytes());
        archive(loaded);
        archive.requireEnd();
      }
      auto a = tracker.update(dt * scan, detections(scan), Pose::Identity());
      if (scan >= 12)
      {
        auto b = loaded.update(dt * scan, detections(scan), Pose::Identity());
        StateArchive of_a;
        StateArchive of_b;
        of_a(a);
        of_b(b);
        EXPECT_EQ(of_a.bytes(), of_b.bytes()) << scan;
      }
    }
  }
}

/** The sensor moves and turns; tracks are in the odometry frame. */
TEST(Tracker, compensatesEgoMotion)
{
  const auto sensor = [](double t) { return poseFromYpr(10 * t, 0.5 * t, 0, 0.4 * t, 0, 0); };
  const Outcome o = play({{straightPath({30, 5}, {0, 0})}, {straightPath({20, -4}, {9, 0})}}, 40,
                         0.03, {}, sensor);
  EXPECT_EQ(o.all_ids.size(), 2u);
  EXPECT_FALSE(o.last.at(0).dynamic);
  EXPECT_LT(o.last.at(0).velocity.norm(), 0.4);
  EXPECT_TRUE(o.last.at(1).dynamic);
  EXPECT_NEAR(o.last.at(1).velocity.x(), 9, 0.4);
}

TEST(Tracker, keepsTheIdThroughAShortOcclusion)
{
  Actor hidden{straightPath({0, 0}, {8, 2})};
  hidden.seen = [](int scan) { return scan < 20 || scan >= 28; };
  const Outcome o = play({hidden}, 50, 0.05);
  EXPECT_EQ(o.all_ids.size(), 1u);
  EXPECT_EQ(o.changes.at(0), 0);
  // After a longer occlusion it is another track.
  hidden.seen = [](int scan) { return scan < 20 || scan >= 40; };
  EXPECT_EQ(play({hidden}, 70, 0.05).all_ids.size(), 2u);
}

/** Predicted states are reported for report_misses scans only. */
TEST(Tracker, reportsPredictionsOnlyBriefly)
{
  Tracker tracker;
  for (int scan = 0; scan < 20; ++scan)
  {
    (void)tracker.update(dt * scan, {carAt({0.8 * scan, 0})}, Pose::Identity());
  }
  const TrackerOptions defaults;
  for (int miss = 1; miss <= defaults.vehicle.max_misses + 1; ++miss)
  {
    const auto objects = tracker.update(dt * (19 + miss), {}, Pose::Identity());
    if (miss > defaults.vehicle.max_misses)
    {
      EXPECT_TRUE(objects.empty());
      continue;
    }
    ASSERT_EQ(objects.size(), 1u);
    EXPECT_FALSE(objects[0].observed);
    EXPECT_EQ(objects[0].reported, miss <= defaults.vehicle.report_misses) << miss;
    EXPECT_NEAR(objects[0].box.centre.x(), 0.8 * (19 + miss), 0.3);
  }
}

/** Paths cross at a right angle; the cars come within 2 m of each other. */
TEST(Tracker, crossingPathsKeepTheirIds)
{
  const Outcome o =
      play({{straightPath({-15, 0.5}, {10, 0})}, {straightPath({0, -16}, {0, 10})}}, 35, 0.05);
  EXPECT_EQ(o.all_ids.size(), 2u);
  EXPECT_EQ(o.changes.at(0) + o.changes.at(1), 0);
  // Head-on in neighbouring lanes, too.
  const Outcome p =
      play({{straightPath({-20, 1.3}, {12, 0})}, {straightPath({20, -1.3}, {-12, 0})}}, 40, 0.05);
  EXPECT_EQ(p.changes.at(0) + p.changes.at(1), 0);
}

TEST(Tracker, createsAndDeletesTracks)
{
  std::vector<Actor> actors;
  for (int i = 0; i < 6; ++i)
  {
    Actor actor{straightPath({-20.0 + 2 * i, 6.0 * i}, {7, 0})};
    actor.seen = [i](int scan) { return scan >= 8 * i && scan < 8 * i + 25; };
    actors.push_back(actor);
  }
  const Outcome o = play(actors, 100, 0.05);
  EXPECT_EQ(o.all_ids.size(), 6u);
  for (int i = 0; i < 6; ++i)
  {
    EXPECT_EQ(o.changes.at(i), 0);
    EXPECT_EQ(o.ids.at(i).size(), 23u);
  }
  EXPECT_TRUE(o.final_objects.empty());  // all were deleted
}

/** A car stands, starts and stops again: `dynamic` changes twice. */
TEST(Tracker, dynamicStateFollowsStartAndStop)
{
  const auto where = [](double t) -> Vector2d
  {
    const double s = std::clamp(t - 3, 0.0, 2.0);    // 0 to 6 m/s within 2 s ...
    const double on = std::clamp(t - 5, 0.0, 2.0);   // ... goes on ...
    const double off = std::clamp(t - 7, 0.0, 2.0);  // ... and stops
    return {10 + 1.5 * s * s + 6 * on + 6 * off - 1.5 * off * off, 4};
  };
  std::mt19937 generator(5);
  std::normal_distribution<double> noise(0, 0.05);
  Tracker tracker;
  std::vector<bool> dynamic;
  std::set<int> ids;
  double worst = 0;
  for (int scan = 0; scan < 130; ++scan)
  {
    const Vector2d p = where(dt * scan);
    const auto objects = tracker.update(
        dt * scan, {carAt(p + Vector2d(noise(generator), noise(generator)))}, Pose::Identity());
    ASSERT_EQ(objects.size(), 1u);
    ids.insert(objects[0].id);
    dynamic.push_back(objects[0].dynamic);
    worst = std::max(worst, (objects[0].box.centre.head<2>() - p).norm());
  }
  EXPECT_EQ(ids.size(), 1u);
  EXPECT_FALSE(std::any_of(dynamic.begin(), dynamic.begin() + 30, [](bool d) { return d; }));
  EXPECT_TRUE(std::all_of(dynamic.begin() + 45, dynamic.begin() + 85, [](bool d) { return d; }));
  EXPECT_FALSE(std::any_of(dynamic.end() - 20, dynamic.end(), [](bool d) { return d; }));
  int flips = 0;
  for (std::size_t i = 1; i < dynamic.size(); ++i)
  {
    flips += dynamic[i] != dynamic[i - 1] ? 1 : 0;
  }
  EXPECT_EQ(flips, 2);
  EXPECT_LT(worst, 0.5);
}

/** Detections are missed with a probability of 35 %; false positives appear at random places. */
TEST(Tracker, toleratesMissedAndFalseDetections)
{
  std::mt19937 generator(23);
  std::bernoulli_distribution lost(0.35);
  std::vector<bool> pattern(100);
  for (std::size_t i = 0; i < pattern.size(); ++i)
  {
    pattern[i] = !lost(generator);
  }
  Actor blinking{straightPath({-30, 0}, {6, 0.5})};
  blinking.seen = [&](int scan) { return pattern[static_cast<std::size_t>(scan)]; };
  std::uniform_real_distribution<double> place(-60, 60);
  std::vector<Actor> actors{blinking};
  for (int i = 0; i < 100; ++i)  // each false positive appears once
  {
    const Vector2d at(place(generator), 10 + std::abs(place(generator)));
    Actor false_positive{[at](double) { return at; }};
    false_positive.seen = [i](int scan) { return scan == i; };
    actors.push_back(false_positive);
  }
  const Outcome o = play(actors, 100, 0.05);
  EXPECT_EQ(o.changes.at(0), 0);
  EXPECT_EQ(o.all_ids.size(), 1u);  // no false positive is reported
}

/** Dense traffic without id switches. */
TEST(Tracker, keepsTheIdsOfTwoHundredObjects)
{
  std::vector<Actor> actors;
  for (int i = 0; i < 200; ++i)
  {
    const int lane = i % 10;
    const double direction = lane % 2 == 0 ? 1 : -1;
    actors.push_back(
        {straightPath({9.0 * (i / 10) - 90, 3.5 * lane}, {direction * (5.0 + lane), 0})});
  }
  const Outcome o = play(actors, 40, 0.08);
  EXPECT_EQ(o.all_ids.size(), 200u);
  for (int i = 0; i < 200; ++i)
  {
    EXPECT_EQ(o.changes.at(i), 0) << i;
  }
  EXPECT_LT(o.max_position_error, 0.5);
}

TEST(Tracker, everyMotionModelAndSolverFollowsACurve)
{
  const auto curve = [](double t) -> Vector2d {
    return {12 * std::sin(0.6 * t), 12 - 12 * std::cos(0.6 * t)};
  };
  for (const TrackMotion motion : {TrackMotion::adaptive, TrackMotion::polynomial,
                                   TrackMotion::constant_velocity, TrackMotion::kalman})
  {
    for (const AssociationMethod method :
         {AssociationMethod::shortest_paths, AssociationMethod::greedy})
    {
      TrackerOptions options;
      options.motion = motion;
      options.association = method;
      const Outcome o = play({{curve}, {straightPath({0, 30}, {5, 0})}}, 60, 0.05, options);
      EXPECT_EQ(o.all_ids.size(), 2u);
      EXPECT_EQ(o.changes.at(0) + o.changes.at(1), 0);
    }
  }
}

/** Greedy association takes the cheapest pair first and loses an object that the optimum keeps. */
TEST(Tracker, optimalAssociationKeepsTracksThatGreedyLoses)
{
  for (const AssociationMethod method :
       {AssociationMethod::shortest_paths, AssociationMethod::greedy})
  {
    TrackerOptions options;
    options.association = method;
    options.vehicle.gate_distance = 2.5;
    options.vehicle.gate_sigmas = 20;
    options.vehicle.overlap_weight = 0;
    options.vehicle.max_cost = 10;
    Tracker tracker(options);
    for (int scan = 0; scan < 5; ++scan)
    {
      (void)tracker.update(dt * scan, {carAt({0, 0}), carAt({2, 0})}, Pose::Identity());
    }
    // Both jump by 2 m: the first car to the second one's place, the second one further.
    const auto objects = tracker.update(0.5, {carAt({1.9, 0}), carAt({3.9, 0})}, Pose::Identity());
    const auto observed =
        std::count_if(objects.begin(), objects.end(),
                      [](const TrackedObject& o) { return o.observed && o.age > 1; });
    EXPECT_EQ(observed, method == AssociationMethod::greedy ? 1 : 2);
  }
}

TEST(Tracker, rejectsInvalidInput)
{
  Tracker tracker;
  EXPECT_TRUE(tracker.update(0, {}, Pose::Identity()).empty());
  std::vector<Detection> bad(4, carAt({1, 1}));
  bad[0].box.centre.x() = std::numeric_limits<double>::quiet_NaN();
  bad[1].box.size.y() = 0;
  bad[2].covariance(0, 0) = std::numeric_limits<double>::infinity();
  bad[3].score = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(tracker.update(0.1, bad, Pose::Identity()).empty());
  bad.push_back(carAt({5, 5}));
  const auto objects = tracker.update(0.2, bad, Pose::Identity());
  ASSERT_EQ(objects.size(), 1u);
  EXPECT_EQ(objects[0].detection, 4);  // index into all given detections
  EXPECT_THROW((void)tracker.update(0.2, {}, Pose::Identity()), std::invalid_argument);
  EXPECT_THROW((void)tracker.update(0.1, {}, Pose::Identity()), std::invalid_argument);
  EXPECT_THROW((void)tracker.update(std::numeric_limits<double>::quiet_NaN(), {}, Pose::Identity()),
               std::invalid_argument);
}

TEST(Tracker, startsAnewAfterALongGap)
{
  Tracker tracker;
  double stamp = 0;
  const auto next = [&](double interval)
  {
    stamp += interval;
    return tracker.update(stamp, {carAt({5, 5})}, Pose::Identity());
  };
  for (int scan = 0; scan < 20; ++scan)
  {
    (void)next(dt);
  }
  auto objects = next(4.9);
  ASSERT_EQ(objects.size(), 1u);
  EXPECT_EQ(objects[0].id, 0);
  objects = next(5.1);
  ASSERT_EQ(objects.size(), 1u);
  EXPECT_EQ(objects[0].id, 1);
  EXPECT_EQ(objects[0].age, 0);
  EXPECT_TRUE(objects[0].observed);
}

TEST(Tracker, speedsOfTheDecisionAreInOrder)
{
  TrackerOptions options;
  options.static_speed = options.dynamic_speed;
  EXPECT_NO_THROW(Tracker{options});
  options.static_speed += 0.1;
  EXPECT_THROW(Tracker{options}, UserError);
}

TEST(Tracker, optionsRoundTripThroughText)
{
  TrackerOptions options;
  options.motion = TrackMotion::polynomial;
  options.must_move = false;
  options.pedestrian.gate_distance = 1.25;
  Config config;
  save(options, config, "tracker");
  TrackerOptions loaded;
  load(loaded, Config::fromText(config.toIni(), "test"), "tracker");
  EXPECT_EQ(loaded.motion, TrackMotion::polynomial);
  EXPECT_FALSE(loaded.must_move);
  EXPECT_DOUBLE_EQ(loaded.pedestrian.gate_distance, 1.25);
  EXPECT_DOUBLE_EQ(loaded.vehicle.gate_distance, TrackerOptions().vehicle.gate_distance);
}
