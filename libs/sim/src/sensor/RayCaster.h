// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/sim/Sensor.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "SweepRays.h"
#include "SweepScene.h"

namespace dyslam::sim
{
/** First intersection of a ray, before the sensor's errors. */
struct Hit
{
  float range = 0;  // range of the hit [m]; 0 for no hit
  float cosine = 1;
  std::int32_t item = 0;  // index in the static scene, or -1 - index in the moving scene
  std::int32_t quad = 0;
};

/** Casts the rays of a sweep with Embree, in packets of eight columns. */
class RayCaster
{
 public:
  /** All outlive the object. */
  RayCaster(const SensorModel& sensor, const SweepScene& scene, const SweepRays& rays);

  /** Casts all rays of the columns [begin, end). Other columns may be cast at the same time in
   * other threads. */
  void trace(std::size_t begin, std::size_t end);
  /** First intersection of a ray that was cast. */
  [[nodiscard]] const Hit& hit(std::size_t column, std::size_t b) const
  {
    return hits_[column * rays_.beamCount() + b];
  }

 private:
  void tracePacket(std::size_t column, std::size_t count, std::size_t b);
  void setRay(std::size_t column, std::size_t b, std::size_t k, RTCRayHit8& packet) const;
  [[nodiscard]] Hit hitOf(const RTCRay8& rays,
                          const RTCHit8& found,
                          bool moved,
                          std::size_t k) const;

  const SensorModel& sensor_;
  const SweepScene& scene_;
  const SweepRays& rays_;
  std::vector<Hit> hits_;  //!< by column, then beam
};
}  // namespace dyslam::sim
