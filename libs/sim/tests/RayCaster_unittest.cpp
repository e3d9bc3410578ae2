// SPDX-License-Identifier: BSD-3-Clause
#include "sensor/RayCaster.h"

#include <gtest/gtest.h>

namespace
{
using namespace dyslam::sim;

/** A wall across the x axis. \param x [m] */
Mesh wallAt(float x)
{
  Mesh wall;
  wall.addQuad({x, -5, -5}, {x, 5, -5}, {x, 5, 5}, {x, -5, 5}, Material::plaster);
  return wall;
}

TEST(RayCaster, AMovingSurfaceInTheStaticOneIsAHitOfEither)
{
  const RayDevice device;
  const Mesh near = wallAt(10);
  const Mesh far = wallAt(30);
  RayScene still(device.handle());
  still.addMesh(near, {});
  still.commit(RTC_BUILD_QUALITY_MEDIUM);
  RayScene moving(device.handle());
  moving.addMesh(far, {});
  moving.addMesh(far, {});
  moving.addMesh(near, {});
  moving.commit(RTC_BUILD_QUALITY_MEDIUM);

  SensorModel sensor = sensorModel(SensorKind::vlp16);
  sensor.columns = 360;
  SweepScene scene;
  scene.static_scene = &still;
  scene.moving_scene = &moving;
  scene.noise = false;
  scene.motion_distortion = false;
  scene.T_map_lidar_column.assign(static_cast<std::size_t>(sensor.columns),
                                  dyslam::Pose::Identity());
  const SweepRays rays(sensor, scene);
  RayCaster caster(sensor, scene, rays);
  caster.trace(0, static_cast<std::size_t>(sensor.columns));
  int hits = 0;
  for (std::size_t column = 0; column < static_cast<std::size_t>(sensor.columns); ++column)
  {
    for (std::size_t beam = 0; beam < sensor.beams.size(); ++beam)
    {
      const Hit& hit = caster.hit(column, beam);
      if (hit.range > 0)
      {
        ++hits;
        EXPECT_LT(hit.range, 20);
        EXPECT_TRUE(hit.item == 0 || hit.item == -3) << hit.item;
      }
    }
  }
  EXPECT_GT(hits, 500);
}
}  // namespace
