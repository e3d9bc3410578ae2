// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "Random.h"
#include "World.h"

namespace dyslam::sim
{
/** A body that may move. Its position in Crowd::actors never changes. */
struct Actor
{
  int model = 0;
  float paint = 0.3F;
  BodyState state;
  bool frozen = false;  //!< too far from the ego to matter
};

/** Where the carrier of the sensor is in the plane. */
struct EgoState
{
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  double yaw = 0;
  double speed = 0;
};

/** Everything that moves, stepped together in time. Deterministic; one thread. */
class Crowd
{
 public:
  Crowd(const World& world, const SimulatorOptions& options);
  ~Crowd();
  Crowd(const Crowd&) = delete;
  Crowd& operator=(const Crowd&) = delete;

  void step(double dt);
  /** Brings every body's height and lean up to date with the ground under its axles. */
  void settle();

  [[nodiscard]] const std::vector<Actor>& actors() const { return actors_; }
  [[nodiscard]] const EgoState& ego() const { return ego_; }
  [[nodiscard]] double time() const { return time_; }
  [[nodiscard]] const World& world() const { return world_; }
  [[nodiscard]] const SimulatorOptions& options() const { return options_; }

  // For the parts of the crowd
  int addActor(int model, float paint);
  [[nodiscard]] Actor& actor(int index) { return actors_[static_cast<std::size_t>(index)]; }
  [[nodiscard]] const BodyModel& model(int actor) const;
  EgoState& ego() { return ego_; }
  /** Beyond this from the ego nothing is simulated. */
  [[nodiscard]] bool active(const Eigen::Vector2d& position) const;
  /** Puts a body somewhere in the plane; settle() does the rest. */
  void stand(int actor, const Eigen::Vector2d& position, double yaw);

  /** A part of the crowd: vehicles on streets, people, ... */
  class Group
  {
   public:
    virtual ~Group() = default;
    virtual void step(double dt) = 0;
  };

 private:
  void lean(Actor& actor, const BodyModel& model) const;

  const World& world_;
  const SimulatorOptions& options_;
  std::vector<Actor> actors_;
  EgoState ego_;
  double time_ = 0;
  std::vector<std::unique_ptr<Group>> groups_;
};

/** Cruising speed of the ego by the options and the world [m/s]. */
[[nodiscard]] double egoCruise(const World& world, const SimulatorOptions& options);

// The groups; each adds its actors to the crowd. A group that carries the ego sets Crowd::ego().
[[nodiscard]] std::unique_ptr<Crowd::Group> makeStreetTraffic(Crowd& crowd, bool with_ego);
[[nodiscard]] std::unique_ptr<Crowd::Group> makeHighwayTraffic(Crowd& crowd);
[[nodiscard]] std::unique_ptr<Crowd::Group> makeWalkers(Crowd& crowd);
[[nodiscard]] std::unique_ptr<Crowd::Group> makeBicycles(Crowd& crowd);
/** The ego alone on World::ego_path, heeding people in its way. */
[[nodiscard]] std::unique_ptr<Crowd::Group> makePathEgo(Crowd& crowd);

/** Acceleration of the intelligent-driver model: speed v, wanted v0, gap to a leader of speed vl.
 */
[[nodiscard]] double driverAcceleration(
    double v, double v0, double gap, double v_leader, double headway);
}  // namespace dyslam::sim
