// SPDX-License-Identifier: BSD-3-Clause
#include "objects/ObjectGraph.h"

#include <gtest/gtest.h>

namespace dyslam
{
namespace
{
/** Number of static objects that are released after a car was seen from 200 keyframes, alternately
 * to the left and to the right of its place.
 * \param sigmas distance from its place, in standard deviations that the graph assumes */
std::size_t releasedAfter(double sigmas)
{
  constexpr double sigma = 0.1;
  ObjectGraphOptions options;
  options.static_saturation = 50;
  options.moving_speed = 100;  // it is static whatever its observations are
  options.max_static_motion = 100;
  options.max_jump = 100;
  FactorGraph graph;
  ObjectGraph objects(options, true, graph);
  for (std::size_t i = 0; i < 200; ++i)
  {
    graph.addPose(Key::ego(i), Pose::Identity());
    graph.setFixed(Key::ego(i), true);
    Frame frame;
    frame.index = i;
    frame.scan.stamp = 0.1 * static_cast<double>(i);
    TrackedObject car;
    car.id = 3;
    car.object_class = ObjectClass::car;
    car.confirmed = true;
    car.observed = true;
    const double offset = sigmas * options.static_sigma_scale * sigma;
    car.observation.centre = Eigen::Vector3d(20, i % 2 == 0 ? offset : -offset, 0);
    car.observation_covariance = sigma * sigma * Eigen::Matrix4d::Identity();
    frame.objects.push_back(car);
    ObjectGraph::View view;
    view.keyframe = i;
    objects.add(frame, view);
  }
  objects.finish();
  const FactorGraphOptions solver;
  (void)graph.optimise(solver);
  EXPECT_NEAR(graph.pose(Key::staticObject(3)).translation().y(), 0, 0.01);
  return objects.releaseContradicted(solver);
}

/** The limit of the information of long sightings does not hide residuals. */
TEST(ObjectGraph, StaticObjectsThatDoNotFitTheirObservationsAreReleased)
{
  EXPECT_EQ(releasedAfter(2.5), 0U);
  EXPECT_EQ(releasedAfter(4.5), 1U);
}
}  // namespace
}  // namespace dyslam
