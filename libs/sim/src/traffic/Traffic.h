// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "Random.h"
#include "worlds/World.h"

namespace dyslam::sim
{
/** A body that may move. Its index in Crowd::actors() is constant. */
struct Actor
{
  int model = 0;       //!< index in World::bodies
  float paint = 0.3F;  //!< reflectivity of paint and cloth
  BodyState state;
  bool frozen = false;  //!< not simulated: too far from the ego
};

/** Planar state of the sensor's carrier. */
struct EgoState
{
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  //!< map frame [m]
  double yaw = 0;                                      //!< [rad]
  double speed = 0;                                    //!< [m/s]
};

/** All moving bodies, advanced in common time steps. Deterministic; single-threaded. */
class Crowd
{
 public:
  Crowd(const World& world, const SimulatorOptions& options);
  ~Crowd();
  Crowd(const Crowd&) = delete;
  Crowd& operator=(const Crowd&) = delete;

  void step(double dt);
  /** Updates height, pitch and roll of each body from the ground below it. */
  void alignWithGround();

  [[nodiscard]] const std::vector<Actor>& actors() const { return actors_; }
  [[nodiscard]] const EgoState& ego() const { return ego_; }
  [[nodiscard]] double time() const { return time_; }
  [[nodiscard]] const World& world() const { return world_; }
  [[nodiscard]] const SimulatorOptions& options() const { return options_; }

  // Interface for the groups
  int addActor(int model, float paint);
  [[nodiscard]] Actor& actor(int index) { return actors_[static_cast<std::size_t>(index)]; }
  [[nodiscard]] const BodyModel& model(int actor) const;
  EgoState& ego() { return ego_; }
  /** Whether a position is near enough to the ego to be simulated. */
  [[nodiscard]] bool active(const Eigen::Vector2d& position) const;
  /** Sets a body's planar pose; alignWithGround() sets the rest. */
  void setPosition(int actor, const Eigen::Vector2d& position, double yaw);

  /** A group of bodies with common behaviour: vehicles on streets, pedestrians, ... */
  class Group
  {
   public:
    virtual ~Group() = default;
    virtual void step(double dt) = 0;
  };

 private:
  void alignActor(Actor& actor, const BodyModel& model) const;

  const World& world_;
  const SimulatorOptions& options_;
  std::vector<Actor> actors_;
  EgoState ego_;
  double time_ = 0;
  std::vector<std::unique_ptr<Group>> groups_;
};

/** Cruising speed of the ego from the options and the world [m/s]. */
[[nodiscard]] double egoCruise(const World& world, const SimulatorOptions& options);

// Each group adds its actors to the crowd. A group that includes the ego sets Crowd::ego().
[[nodiscard]] std::unique_ptr<Crowd::Group> makeStreetTraffic(Crowd& crowd, bool with_ego);
[[nodiscard]] std::unique_ptr<Crowd::Group> makeHighwayTraffic(Crowd& crowd);
[[nodiscard]] std::unique_ptr<Crowd::Group> makeWalkers(Crowd& crowd);
[[nodiscard]] std::unique_ptr<Crowd::Group> makeBicycles(Crowd& crowd);
/** People and cleaning machines in a building. */
[[nodiscard]] std::unique_ptr<Crowd::Group> makeVisitors(Crowd& crowd);
/** The ego on World::ego_path; yields to pedestrians. */
[[nodiscard]] std::unique_ptr<Crowd::Group> makePathEgo(Crowd& crowd);

/** Distance to the nearest body that is within `half_width` of the line ahead and nearer than
 * `reach` [m]; nothing if there is none. \param self actor that is left out; -1 for the ego */
[[nodiscard]] std::optional<double> bodyAhead(const Crowd& crowd,
                                              int self,
                                              const Eigen::Vector2d& position,
                                              double yaw,
                                              double half_width,
                                              double reach);

/** Rate at which a cyclist turns the pedals [rad/s]. \param speed [m/s] */
[[nodiscard]] double pedalRate(double speed);

/** Acceleration of the intelligent driver model (Treiber et al., 2000) [m/s^2]. \param v speed
 * [m/s] \param v0 desired speed [m/s] \param gap distance to the leader [m] \param v_leader speed
 * of the leader [m/s] \param headway desired time gap [s] */
[[nodiscard]] double driverAcceleration(
    double v, double v0, double gap, double v_leader, double headway);
}  // namespace dyslam::sim
