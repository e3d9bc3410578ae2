// SPDX-License-Identifier: BSD-3-Clause
// Open field with a closed track.
#include <cmath>

#include "OpenGround.h"
#include "Random.h"
#include "World.h"
#include "shapes/Shapes.h"

namespace dyslam::sim
{
namespace
{
using P = Eigen::Vector2d;
}  // namespace

void buildField(World& world, const SimulatorOptions& options)
{
  Rng rng(combine(world.seed, 0xF1E1D));
  auto ground = std::make_unique<OpenGround>(world.seed, 0.07, 2.0, 2.0);
  const double radius = options.loop_length / 6.2832;
  std::vector<P> track;
  const double p2 = rng.uniform(0, 6.28), p3 = rng.uniform(0, 6.28);
  for (int i = 0; i < 90; ++i)
  {
    const double t = 6.283185307 * i / 90;
    const double r = radius * (1 + 0.22 * std::sin(2 * t + p2) + 0.1 * std::sin(3 * t + p3));
    track.emplace_back(r * std::cos(t), r * std::sin(t));
  }
  ground->add(track, 2.6, Material::soil, true);
  world.ego_path = Path(track, true);
  world.loop_length = world.ego_path.length();
  const OpenGround& field = *ground;
  world.ground = std::move(ground);
  const double half = 1.35 * radius + 90;
  world.meshes.push_back(field.mesh(-half, -half, half, half, 1.2, Material::lawn));
  const OpenGroundPlants plants(world, rng);
  std::vector<int> tufts;
  for (int i = 0; i < 3; ++i)
  {
    tufts.push_back(
        world.addShape(makeGrassTuft(rng, 0.4F, static_cast<float>(rng.uniform(0.25, 0.6)))));
  }
  const auto scatter = [&](const std::vector<int>& shapes, int count, double inner, double outer)
  {
    for (int i = 0; i < count; ++i)
    {
      const double t = rng.uniform(0, 6.2832),
                   r = std::sqrt(rng.uniform(inner * inner, outer * outer));
      const P where(r * std::cos(t), r * std::sin(t));
      if (field.nearestStrip(where).first > 1.2)
      {
        const auto scale = static_cast<float>(rng.uniform(0.7, 1.3));
        const double yaw = rng.uniform(0, 6.28);
        world.placeOnGround(rng.pick(shapes), where, yaw, scale);
      }
    }
  };
  scatter(tufts, static_cast<int>(radius * radius * 0.05) + 200, 0, 1.3 * radius + 30);
  scatter(plants.bushes, 6 + static_cast<int>(radius / 8), 0, half);
  scatter(plants.trees, 10, 1.2 * radius + 25, half);
  // Pedestrians walk on a wide ring.
  int first = -1, previous = -1;
  for (int i = 0; i < 12; ++i)
  {
    const double t = 6.2832 * i / 12;
    const double y = rng.uniform(-6, 6), x = rng.uniform(-6, 6);
    const int node = world.walks.addNode(1.25 * radius * P(std::cos(t), std::sin(t)) + P(x, y));
    if (previous >= 0)
    {
      world.walks.addLink(previous, node, false, 2);
    }
    first = first < 0 ? node : first;
    previous = node;
  }
  world.walks.addLink(previous, first, false, 2);
}
}  // namespace dyslam::sim
