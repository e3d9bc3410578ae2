// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/sim/Sensor.h>

#include <Eigen/Core>
#include <cstddef>
#include <optional>

#include "RayCaster.h"
#include "SweepRays.h"
#include "SweepScene.h"
#include "shapes/Material.h"

namespace dyslam::sim
{
/** The surface that a ray hit. */
struct Surface
{
  const SceneItem* item;
  const MaterialProperties* material;
  const PartMotion* part;  //!< motion of the body's part; null for the static scene
  float reflectivity;
};

/** What the sensor measures of the surfaces that its rays hit: range and intensity, with the errors
 * of the sensor and the properties of the materials. */
class ReturnModel
{
 public:
  /** All outlive the object. */
  ReturnModel(const SensorModel& sensor,
              const SweepScene& scene,
              const SweepRays& rays,
              const RayCaster& caster)
      : sensor_(sensor), scene_(scene), rays_(rays), caster_(caster)
  {
  }

  [[nodiscard]] Surface surfaceOf(const Hit& hit) const;
  /** Measured range of a hit [m]: true range, relief of the surface and errors of the sensor;
   * nothing if the return is lost. Varies the surface's reflectivity over its relief. */
  [[nodiscard]] std::optional<float> measuredRange(std::size_t column,
                                                   std::size_t b,
                                                   const Eigen::Vector3f& ray,
                                                   Surface& surface) const;
  /** Intensity in [0, 1], in steps of 1/255. */
  [[nodiscard]] float measuredIntensity(std::size_t column,
                                        std::size_t b,
                                        float reflectivity) const;

 private:
  const SensorModel& sensor_;
  const SweepScene& scene_;
  const SweepRays& rays_;
  const RayCaster& caster_;
};
}  // namespace dyslam::sim
