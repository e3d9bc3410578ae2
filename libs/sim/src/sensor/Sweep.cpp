// SPDX-License-Identifier: BSD-3-Clause
#include "Sweep.h"

#include <optional>

#include "RayCaster.h"
#include "ReturnModel.h"
#include "SweepRays.h"

namespace dyslam::sim
{
namespace
{
constexpr std::size_t kColumnsPerChunk = 32;

/** Points and ground truth of one chunk of columns. */
struct ChunkOutput
{
  std::vector<Eigen::Vector3f> points, deskewed, flow;
  std::vector<float> intensity, time;
  std::vector<std::uint16_t> ring;
  std::vector<std::uint32_t> label;
  std::vector<std::uint8_t> moving;
  std::vector<BodyReturns> body_returns;
};

/** Motion of the sensor to the next scan. */
struct ScanMotion
{
  Pose T_next_map;
  Eigen::Isometry3f T_next_stamp;
};

/** Converts hits to returns with ground truth. */
class ReturnResolver
{
 public:
  ReturnResolver(const SensorModel& sensor,
                 const SweepScene& scene,
                 const SweepRays& rays,
                 const RayCaster& caster)
      : sensor_(sensor),
        scene_(scene),
        rays_(rays),
        caster_(caster),
        model_(sensor, scene, rays, caster)
  {
  }

  /** Adds the returns of the columns [begin, end). */
  void resolve(std::size_t begin, std::size_t end, ChunkOutput& out) const;

 private:
  void resolveHit(std::size_t column,
                  std::size_t b,
                  const ScanMotion& motion,
                  const Eigen::Isometry3f& T_stamp_column,
                  const Eigen::Vector3f& ray,
                  ChunkOutput& out) const;

  const SensorModel& sensor_;
  const SweepScene& scene_;
  const SweepRays& rays_;
  const RayCaster& caster_;
  ReturnModel model_;
};

void ReturnResolver::resolve(std::size_t begin, std::size_t end, ChunkOutput& out) const
{
  const Pose T_lidar_map = scene_.T_map_lidar.inverse();
  const Pose T_next_map = scene_.T_map_lidar_next.inverse();
  const ScanMotion motion{T_next_map, (T_next_map * scene_.T_map_lidar).cast<float>()};
  out.body_returns.assign(scene_.bodies->size(), {});
  for (std::size_t c = begin; c < end; ++c)
  {
    const Eigen::Isometry3f T_stamp_column =
        (T_lidar_map * scene_.T_map_lidar_column[c]).cast<float>();
    const SweepRays::Column column = rays_.columnAt(c);
    for (std::size_t b = 0; b < rays_.beamCount(); ++b)
    {
      if (caster_.hit(c, b).range > 0 && !rays_.isOccludedByCarrier(column, b))
      {
        resolveHit(c, b, motion, T_stamp_column, rays_.direction(column, b), out);
      }
    }
  }
}

void ReturnResolver::resolveHit(std::size_t column,
                                std::size_t b,
                                const ScanMotion& motion,
                                const Eigen::Isometry3f& T_stamp_column,
                                const Eigen::Vector3f& ray,
                                ChunkOutput& out) const
{
  const Hit& hit = caster_.hit(column, b);
  Surface surface = model_.surfaceOf(hit);
  const std::optional<float> range = scene_.noise ? model_.measuredRange(column, b, ray, surface)
                                                  : std::optional<float>(hit.range);
  if (!range)
  {
    return;
  }
  const Eigen::Vector3f point = *range * ray + Eigen::Vector3f(0, 0, rays_.beams().height[b]);
  const Eigen::Vector3f deskewed = T_stamp_column * point;
  const float time = scene_.motion_distortion
                         ? static_cast<float>(sensor_.columnTime(static_cast<double>(column))) +
                               rays_.beams().time[b]
                         : 0.0F;
  Eigen::Vector3f flow;
  std::uint32_t semantic =
      surface.material->semantic != 0 ? surface.material->semantic : surface.item->semantic;
  std::uint32_t instance = surface.item->instance;
  bool moving = false;
  if (surface.part != nullptr)
  {
    const BodyMotion& body = (*scene_.bodies)[static_cast<std::size_t>(surface.item->body)];
    moving = body.moving;
    semantic = body.semantic;
    instance = body.instance;
    const double fraction = static_cast<double>(rays_.sweepFraction(column));
    const Eigen::Vector3d local = surface.part->at(fraction).inverse() *
                                  (scene_.T_map_lidar_column[column] * point.cast<double>());
    const Eigen::Vector3d next = motion.T_next_map * (surface.part->nextAt(fraction) * local);
    flow = next.cast<float>() - deskewed;
    auto& returns = out.body_returns[static_cast<std::size_t>(surface.item->body)];
    ++returns.points;
    returns.time += static_cast<double>(time);
  }
  else
  {
    flow = motion.T_next_stamp * deskewed - deskewed;
  }
  out.points.push_back(point);
  out.deskewed.push_back(deskewed);
  out.flow.push_back(flow);
  out.intensity.push_back(model_.measuredIntensity(column, b, surface.reflectivity));
  out.time.push_back(time);
  if (sensor_.spins())
  {
    out.ring.push_back(static_cast<std::uint16_t>(b));
  }
  out.label.push_back(semantic | instance << 16);
  out.moving.push_back(moving ? 1 : 0);
}

template <typename T>
void append(std::vector<T>& to, const std::vector<T>& from)
{
  to.insert(to.end(), from.begin(), from.end());
}
}  // namespace

std::vector<BodyReturns> castSweep(const SensorModel& sensor,
                                   const SweepScene& scene,
                                   ThreadPool& pool,
                                   SimulatedScan& scan)
{
  const SweepRays rays(sensor, scene);
  RayCaster caster(sensor, scene, rays);
  const ReturnResolver resolver(sensor, scene, rays, caster);
  const auto columns = static_cast<std::size_t>(sensor.columns);
  pool.forChunks(columns, kColumnsPerChunk,
                 [&](std::size_t begin, std::size_t end, std::size_t)
                 { caster.trace(begin, end); });
  std::vector<ChunkOutput> chunks(ThreadPool::chunkCount(columns, kColumnsPerChunk));
  pool.forChunks(columns, kColumnsPerChunk,
                 [&](std::size_t begin, std::size_t end, std::size_t chunk)
                 { resolver.resolve(begin, end, chunks[chunk]); });

  std::size_t total = 0;
  for (const auto& c : chunks)
  {
    total += c.points.size();
  }
  std::vector<BodyReturns> body_returns(scene.bodies->size());
  scan.scan.points.reserve(total);
  scan.deskewed.reserve(total);
  scan.flow.reserve(total);
  for (const auto& c : chunks)
  {
    append(scan.scan.points, c.points);
    append(scan.scan.intensity, c.intensity);
    append(scan.scan.time, c.time);
    append(scan.scan.ring, c.ring);
    append(scan.deskewed, c.deskewed);
    append(scan.flow, c.flow);
    append(scan.label, c.label);
    append(scan.moving, c.moving);
    for (std::size_t i = 0; i < body_returns.size(); ++i)
    {
      body_returns[i].points += c.body_returns[i].points;
      body_returns[i].time += c.body_returns[i].time;
    }
  }
  return body_returns;
}
}  // namespace dyslam::sim
