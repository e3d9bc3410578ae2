// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Objects.h>
#include <dyslam/core/Scan.h>
#include <dyslam/sim/SimulatorOptions.h>

#include <cstdint>
#include <memory>
#include <vector>

namespace dyslam::sim
{
/** One body that may move (parked vehicles are part of the static world and not listed). */
struct SimulatedObject
{
  int id = 0;  //!< same body, same id in every scan
  ObjectClass object_class = ObjectClass::unknown;
  Box box;               //!< lidar frame at the stamp
  Box box_seen;          //!< where the beam met it, in the lidar frame at the stamp
  double seen_time = 0;  //!< mean time of its points after the stamp [s]
  Eigen::Vector3d velocity =
      Eigen::Vector3d::Zero();  //!< over ground, in axes of the lidar at the stamp [m/s]
  bool moving = false;          //!< faster than SimulatorOptions::moving_speed
  std::size_t points = 0;       //!< returns on it in this scan
};

/** A scan and the truth about each of its points. The arrays are as long as `scan.points`. */
struct SimulatedScan
{
  std::size_t index = 0;
  Scan scan;  //!< as the sensor gives it: returns only, each in the lidar frame at its own time
  /** The points in the lidar frame at the stamp: the sensor's own motion taken out, and that alone.
   */
  std::vector<Eigen::Vector3f> deskewed;
  /** From `deskewed` to where the same piece of surface is one period later, in the lidar frame at
   * the next scan's stamp. For a static point: T_next_this * p - p. */
  std::vector<Eigen::Vector3f> flow;
  std::vector<std::uint32_t> label;  //!< SemanticKITTI: class (moving ones 252-259), instance << 16
  std::vector<std::uint8_t> moving;  //!< 1 on bodies that move
  Pose T_map_vehicle = Pose::Identity();       //!< at the stamp
  Pose T_map_vehicle_next = Pose::Identity();  //!< at the next scan's stamp
  std::vector<SimulatedObject> objects;        //!< within range
};

class World;

/** A drive through a generated world, scan after scan.
 *
 * A value of its own: two simulators never share changing state, so each thread may have one.
 */
class Simulator
{
 public:
  /** \param threads 0 takes the machine's number. \throws UserError for options out of range. */
  explicit Simulator(const SimulatorOptions& options, int threads = 1);
  /** In a world made before, which costs more than a few scans. `world` must be of the same kind.
   */
  Simulator(std::shared_ptr<const World> world, const SimulatorOptions& options, int threads = 1);
  ~Simulator();
  Simulator(Simulator&&) noexcept;
  Simulator& operator=(Simulator&&) noexcept;

  [[nodiscard]] SimulatedScan next();

  [[nodiscard]] const SensorModel& sensor() const;
  [[nodiscard]] const SimulatorOptions& options() const;
  /** Length of the ego's closed loop [m]. */
  [[nodiscard]] double loopLength() const;
  [[nodiscard]] std::shared_ptr<const World> world() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/** The static world of some options: immutable, shared by any number of simulators and threads. */
[[nodiscard]] std::shared_ptr<const World> makeWorld(const SimulatorOptions& options);
}  // namespace dyslam::sim
