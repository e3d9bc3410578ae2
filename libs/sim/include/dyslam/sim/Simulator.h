// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/MotionSamples.h>
#include <dyslam/core/Objects.h>
#include <dyslam/core/Scan.h>
#include <dyslam/sim/SimulatorOptions.h>

#include <cstdint>
#include <memory>
#include <vector>

namespace dyslam::sim
{
/** A body that may move (parked vehicles belong to the static world and are not listed). */
struct SimulatedObject
{
  int id = 0;  //!< constant over time
  ObjectClass object_class = ObjectClass::unknown;
  Box box;               //!< box at the stamp, lidar frame at the stamp
  Box box_seen;          //!< box at seen_time, lidar frame at the stamp
  double seen_time = 0;  //!< mean time of the object's points relative to the stamp [s]
  Eigen::Vector3d velocity =
      Eigen::Vector3d::Zero();  //!< over ground, axes of the lidar at the stamp [m/s]
  bool moving = false;          //!< faster than SimulatorOptions::moving_speed
  std::size_t points = 0;       //!< number of returns on the object in this scan, of all sensors
};

/** A scan with the ground truth of each point. The arrays have one value per point of `scan`,
 * followed by one per point of each scan in `further`; their coordinates are in the frame of the
 * first sensor. */
struct SimulatedScan
{
  std::size_t index = 0;
  Scan scan;                  //!< raw: returns only, each in the lidar frame at its own time
  std::vector<Scan> further;  //!< raw scans of the further sensors, each in its own frame
  /** The points in the lidar frame at the stamp, compensated for the sensor's motion only (not for
   * that of objects).
   */
  std::vector<Eigen::Vector3f> deskewed;
  /** Scene flow: from `deskewed` to the position of that surface point one period later, in the
   * lidar frame at the next scan's stamp. For a static point: T_next_this * p - p. */
  std::vector<Eigen::Vector3f> flow;
  std::vector<std::uint32_t> label;  //!< SemanticKITTI: class (252-259: moving) | instance << 16
  std::vector<std::uint8_t> moving;  //!< 1 for points on moving bodies
  Pose T_map_vehicle = Pose::Identity();       //!< vehicle pose at the stamp
  Pose T_map_vehicle_next = Pose::Identity();  //!< vehicle pose at the next scan's stamp
  std::vector<SimulatedObject> objects;        //!< objects within the range of a sensor
  // Samples after the stamp of the previous scan up to that of this one; none in the first scan.
  std::vector<ImuSample> imu;       //!< 100 Hz, if SimulatorOptions::imu
  std::vector<WheelSample> wheels;  //!< 50 Hz, if SimulatorOptions::wheels
};

class World;

/** Simulates a drive through a generated world, scan by scan.
 *
 * Simulators share no mutable state, so each thread may have its own.
 */
class Simulator
{
 public:
  /** \param threads 0 for the number of cores. \throws UserError for options out of range, and for
   * wheels of a hand-held sensor. */
  explicit Simulator(const SimulatorOptions& options, int threads = 1);
  /** Simulates in an existing world (generating one takes longer than a few scans). Its seed and
   * loop, and the direction of an urban loop, are those that it was made with. \throws UserError as
   * the constructor above. \throws std::logic_error if `world` is of another kind than in the
   * options. */
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

/** Generates a static world: immutable, may be shared by simulators and threads. */
[[nodiscard]] std::shared_ptr<const World> makeWorld(const SimulatorOptions& options);
}  // namespace dyslam::sim
