// SPDX-License-Identifier: BSD-3-Clause
#include "ReturnModel.h"

#include <algorithm>
#include <cmath>

#include "Random.h"

namespace dyslam::sim
{
Surface ReturnModel::surfaceOf(const Hit& hit) const
{
  const bool moved = hit.item < 0;
  const SceneItem& item =
      moved ? scene_.moving_scene->items()[static_cast<std::size_t>(-1 - hit.item)]
            : scene_.static_scene->items()[static_cast<std::size_t>(hit.item)];
  const Material material = item.mesh->materials[static_cast<std::size_t>(hit.quad)];
  const MaterialProperties& m = properties(material);
  const bool coloured =
      item.reflectivity >= 0 && (material == Material::paint || material == Material::cloth);
  const PartMotion* part = moved ? &(*scene_.bodies)[static_cast<std::size_t>(item.body)]
                                        .parts[static_cast<std::size_t>(item.part)]
                                 : nullptr;
  return {&item, &m, part, coloured ? item.reflectivity : m.reflectivity};
}

std::optional<float> ReturnModel::measuredRange(std::size_t column,
                                                std::size_t b,
                                                const Eigen::Vector3f& ray,
                                                Surface& surface) const
{
  const Hit& hit = caster_.hit(column, b);
  const MaterialProperties& m = *surface.material;
  float range = hit.range;
  // Relief is fixed to the surface and moves with bodies.
  const Eigen::Vector3f origin(0, 0, rays_.beams().height[b]);
  Eigen::Vector3d on_surface =
      scene_.T_map_lidar_column[column] * (range * ray + origin).cast<double>();
  if (surface.part != nullptr)
  {
    on_surface =
        surface.part->at(static_cast<double>(rays_.sweepFraction(column))).inverse() * on_surface;
  }
  const Eigen::Vector3f p = m.relief_per_metre * on_surface.cast<float>();
  const float relief = latticeNoise(p.x(), p.y(), p.z());
  range += m.roughness * relief / std::max(hit.cosine, 0.12F);
  surface.reflectivity =
      std::max(0.02F, surface.reflectivity +
                          m.spread * latticeNoise(0.7F * p.x() + 31, 0.7F * p.y(), 0.7F * p.z()));

  const float gloss = 1 - m.gloss * (1 - hit.cosine) * (1 - hit.cosine);
  const float signal = surface.reflectivity * gloss * std::sqrt(hit.cosine) / 0.1F *
                       static_cast<float>(sensor_.reference_range * sensor_.reference_range) /
                       (range * range);
  const float detection_probability = signal * signal / (1 + signal * signal) * (1 - m.loss) *
                                      (1 - static_cast<float>(sensor_.random_loss));
  // Losses on glass are spatially correlated.
  const float patch = 0.5F + 0.5F * latticeNoise(1.3F * p.x() + 7, 1.3F * p.y(), 1.3F * p.z());
  const float draw = unit(rays_.hash(column, b, Draw::loss));
  if ((m.loss > 0.2F ? 0.25F * draw + 0.75F * patch : draw) > detection_probability)
  {
    return std::nullopt;
  }
  // Mixed pixel: the beam meets two surfaces.
  const std::uint64_t mixed = rays_.hash(column, b, Draw::mixed);
  const Hit& beside = caster_.hit((column + 1) % static_cast<std::size_t>(sensor_.columns), b);
  const float step = beside.range - hit.range;
  if (beside.range > 0 && std::abs(step) > 0.25F && std::abs(step) < 2.5F && unit(mixed) < 0.18F)
  {
    range += step * unit(splitmix64(mixed));
  }
  range += static_cast<float>(sensor_.range_noise) *
               (0.7F + 0.3F / std::sqrt(std::min(1.0F, signal) + 0.02F)) *
               normal(rays_.hash(column, b, Draw::range)) +
           rays_.beams().bias[b];
  if (sensor_.range_resolution > 0)
  {
    const auto grid = static_cast<float>(sensor_.range_resolution);
    range = grid * std::round(range / grid);
  }
  if (range < static_cast<float>(sensor_.min_range))
  {
    return std::nullopt;
  }
  return range;
}

float ReturnModel::measuredIntensity(std::size_t column, std::size_t b, float reflectivity) const
{
  const float shade = 0.35F + 0.65F * caster_.hit(column, b).cosine;
  const float brightness =
      reflectivity * shade *
      (scene_.noise ? 1 + 0.08F * normal(rays_.hash(column, b, Draw::intensity)) : 1.0F);
  return std::round(255 * std::clamp(brightness, 0.0F, 1.0F)) / 255;
}
}  // namespace dyslam::sim
