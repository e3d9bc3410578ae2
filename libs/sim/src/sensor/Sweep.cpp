// SPDX-License-Identifier: BSD-3-Clause
#include "Sweep.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "Random.h"

namespace dyslam::sim
{
namespace
{
constexpr int kPacket = 8;
constexpr std::size_t kColumnsPerChunk = 32;

/** First intersection of a ray, before the sensor's errors. */
struct Hit
{
  float range = 0;  // range of the hit [m]; 0 for no hit
  float cosine = 1;
  std::int32_t item = 0;  // index in the static scene, or -1 - index in the moving scene
  std::int32_t quad = 0;
};

enum Draw : std::uint64_t
{
  kDrawCone,
  kDrawRange,
  kDrawLoss,
  kDrawMixed,
  kDrawIntensity,
  kDrawCount
};

struct BeamTable
{
  std::vector<float> cos_elevation, sin_elevation, cos_offset, sin_offset, time, bias, height;
};

BeamTable tabulate(const SensorModel& sensor)
{
  BeamTable t;
  for (std::size_t i = 0; i < sensor.beams.size(); ++i)
  {
    const Beam& b = sensor.beams[i];
    // A beam's range error is constant, as in a real sensor. Its elevation is exact: the ray is
    // cast and the point reported with the same value.
    const std::uint64_t h = combine(0x5E4504, i);
    const double elevation =
        b.elevation + sensor.beam_angle_error * static_cast<double>(normal(combine(h, 1)));
    const double offset = b.azimuth_offset - 2 * M_PI * b.fire_time / sensor.period;
    t.cos_elevation.push_back(static_cast<float>(std::cos(elevation)));
    t.sin_elevation.push_back(static_cast<float>(std::sin(elevation)));
    t.cos_offset.push_back(static_cast<float>(std::cos(offset)));
    t.sin_offset.push_back(static_cast<float>(std::sin(offset)));
    t.time.push_back(static_cast<float>(b.fire_time));
    t.bias.push_back(static_cast<float>(sensor.beam_range_bias) * normal(combine(h, 2)));
    t.height.push_back(static_cast<float>(b.height));
  }
  return t;
}

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

class Caster
{
 public:
  Caster(const SensorModel& sensor, const SweepScene& scene)
      : sensor_(sensor),
        scene_(scene),
        beams_(tabulate(sensor)),
        beam_count_(sensor.beams.size()),
        upright_(scene.R_vehicle_lidar.isIdentity())
  {
    hits_.resize(beam_count_ * static_cast<std::size_t>(sensor.columns));
  }

  void trace(std::size_t begin, std::size_t end)
  {
    for (std::size_t c = begin; c < end; c += kPacket)
    {
      const std::size_t count = std::min<std::size_t>(kPacket, end - c);
      for (std::size_t b = 0; b < beam_count_; ++b)
      {
        tracePacket(c, count, b);
      }
    }
  }

  void resolve(std::size_t begin, std::size_t end, ChunkOutput& out) const;

 private:
  std::uint64_t hash(std::size_t column, std::size_t beam, Draw draw) const
  {
    return splitmix64(scene_.seed +
                      ((column * beam_count_ + beam) * kDrawCount + draw) * splitmix_increment);
  }

  /** Direction of the head during a column of firings. */
  struct Column
  {
    std::size_t number = 0;
    float azimuth = 0;
    float cos_azimuth = 1;
    float sin_azimuth = 0;
  };
  Column columnAt(std::size_t c) const
  {
    const auto azimuth = static_cast<float>(sensor_.azimuth(static_cast<double>(c)));
    return {c, azimuth, std::cos(azimuth), std::sin(azimuth)};
  }

  /** Nominal direction of a beam in the lidar frame, as reported by the sensor. */
  Eigen::Vector3f direction(const Column& column, std::size_t b) const
  {
    if (!sensor_.spins())
    {
      return throughPrisms(column.number, b);
    }
    const float c =
        column.cos_azimuth * beams_.cos_offset[b] - column.sin_azimuth * beams_.sin_offset[b];
    const float s =
        column.sin_azimuth * beams_.cos_offset[b] + column.cos_azimuth * beams_.sin_offset[b];
    return {beams_.cos_elevation[b] * c, beams_.cos_elevation[b] * s, beams_.sin_elevation[b]};
  }

  Eigen::Vector3f throughPrisms(std::size_t column, std::size_t b) const
  {
    const Beam& beam = sensor_.beams[b];
    const double share = static_cast<double>(column) / sensor_.columns;
    const RayAngles a =
        sensor_.throughPrisms(scene_.start + sensor_.period * share + beam.fire_time, beam);
    return Eigen::Vector3d(std::cos(a.elevation) * std::cos(a.azimuth),
                           std::cos(a.elevation) * std::sin(a.azimuth), std::sin(a.elevation))
        .cast<float>();
  }

  /** Whether a ray ends on the roof of the car that carries the sensor. */
  bool isOccludedByCarrier(const Column& column, std::size_t b) const
  {
    if (!scene_.on_car)
    {
      return false;
    }
    float a = std::abs(column.azimuth);
    float sine = beams_.sin_elevation[b];
    if (!upright_ || !sensor_.spins())
    {
      const Eigen::Vector3f ray = scene_.R_vehicle_lidar * direction(column, b);
      a = std::abs(std::atan2(ray.y(), ray.x()));
      sine = ray.z();
    }
    const float limit = a > 2.55F   ? -0.315F + 0.10F * (3.1416F - a)
                        : a > 2.05F ? -0.40F
                        : a > 1.9F  ? -0.37F
                        : a < 0.4F  ? -0.395F - 0.08F * a
                                    : -1.0F;
    return sine < limit;
  }

  float sweepFraction(std::size_t column) const
  {
    return scene_.motion_distortion
               ? static_cast<float>(column) / static_cast<float>(sensor_.columns)
               : 0.5F;
  }

  /** The surface that a ray hit. */
  struct Surface
  {
    const SceneItem* item;
    const MaterialProperties* material;
    const PartMotion* part;  //!< motion of the body's part; null for the static scene
    float reflectivity;
  };
  /** Motion of the sensor to the next scan. */
  struct ScanMotion
  {
    Pose T_next_map;
    Eigen::Isometry3f T_next_stamp;
  };

  void tracePacket(std::size_t column, std::size_t count, std::size_t b);
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
  void resolveHit(std::size_t column,
                  std::size_t b,
                  const ScanMotion& motion,
                  const Eigen::Isometry3f& T_stamp_column,
                  const Eigen::Vector3f& ray,
                  ChunkOutput& out) const;

  const SensorModel& sensor_;
  const SweepScene& scene_;
  BeamTable beams_;
  std::size_t beam_count_;
  bool upright_;  //!< the sensor's axes are those of the vehicle
  std::vector<Hit> hits_;
};

void Caster::tracePacket(std::size_t column, std::size_t count, std::size_t b)
{
  alignas(32) RTCRayHit8 packet;
  alignas(32) int valid[kPacket];
  for (std::size_t k = 0; k < kPacket; ++k)
  {
    const std::size_t c = column + std::min(k, count - 1);
    valid[k] = k < count ? -1 : 0;
    Eigen::Vector3f d = direction(columnAt(c), b);
    if (scene_.noise)
    {
      // Random direction within the beam, which blurs edges. The spread is smaller in elevation,
      // because on the ground the echo averages over the footprint.
      const std::uint64_t h = hash(c, b, kDrawCone);
      const auto spread = static_cast<float>(sensor_.divergence) * 0.6F;
      const Eigen::Vector3f side(-d.y(), d.x(), 0);
      d += spread * (normal(h) * side + 0.2F * normal(splitmix64(h)) * Eigen::Vector3f::UnitZ());
      d.normalize();
    }
    const Pose& pose = scene_.T_map_lidar_column[c];
    const Eigen::Vector3f o =
        (pose * Eigen::Vector3d(0, 0, static_cast<double>(beams_.height[b]))).cast<float>();
    const Eigen::Vector3f w = pose.linear().cast<float>() * d;
    packet.ray.org_x[k] = o.x();
    packet.ray.org_y[k] = o.y();
    packet.ray.org_z[k] = o.z();
    packet.ray.dir_x[k] = w.x();
    packet.ray.dir_y[k] = w.y();
    packet.ray.dir_z[k] = w.z();
    packet.ray.tnear[k] = static_cast<float>(sensor_.min_range);
    packet.ray.tfar[k] = static_cast<float>(sensor_.max_range);
    packet.ray.time[k] = sweepFraction(c);
    packet.ray.mask[k] = ~0U;
    packet.ray.id[k] = static_cast<unsigned>(k);
    packet.ray.flags[k] = 0;
    packet.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
    packet.hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;
  }
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcIntersect8(valid, scene_.static_scene->handle(), &context, &packet);
  float static_range[kPacket];
  std::copy(packet.ray.tfar, packet.ray.tfar + kPacket, static_range);
  if (!scene_.moving_scene->empty())
  {
    rtcIntersect8(valid, scene_.moving_scene->handle(), &context, &packet);
  }
  for (std::size_t k = 0; k < count; ++k)
  {
    if (packet.hit.geomID[k] == RTC_INVALID_GEOMETRY_ID)
    {
      continue;
    }
    Hit& hit = hits_[(column + k) * beam_count_ + b];
    const bool moved = packet.ray.tfar[k] < static_range[k];
    const unsigned instance = packet.hit.instID[0][k];
    const auto item = static_cast<std::int32_t>(
        instance != RTC_INVALID_GEOMETRY_ID ? instance : packet.hit.geomID[k]);
    hit.item = moved ? -1 - item : item;
    hit.quad = static_cast<std::int32_t>(packet.hit.primID[k]);
    hit.range = packet.ray.tfar[k];
    Eigen::Vector3f normal_local(packet.hit.Ng_x[k], packet.hit.Ng_y[k], packet.hit.Ng_z[k]);
    const Eigen::Vector3f w(packet.ray.dir_x[k], packet.ray.dir_y[k], packet.ray.dir_z[k]);
    if (instance != RTC_INVALID_GEOMETRY_ID)
    {
      // Embree returns an instance's normal in the instance's frame.
      const RayScene& scene = moved ? *scene_.moving_scene : *scene_.static_scene;
      normal_local = scene.items()[static_cast<std::size_t>(item)].turn * normal_local;
    }
    hit.cosine = std::abs(normal_local.normalized().dot(w));
  }
}

void Caster::resolve(std::size_t begin, std::size_t end, ChunkOutput& out) const
{
  const Pose T_lidar_map = scene_.T_map_lidar.inverse();
  const Pose T_next_map = scene_.T_map_lidar_next.inverse();
  const ScanMotion motion{T_next_map, (T_next_map * scene_.T_map_lidar).cast<float>()};
  out.body_returns.assign(scene_.bodies->size(), {});
  for (std::size_t c = begin; c < end; ++c)
  {
    const Eigen::Isometry3f T_stamp_column =
        (T_lidar_map * scene_.T_map_lidar_column[c]).cast<float>();
    const Column column = columnAt(c);
    for (std::size_t b = 0; b < beam_count_; ++b)
    {
      if (hits_[c * beam_count_ + b].range > 0 && !isOccludedByCarrier(column, b))
      {
        resolveHit(c, b, motion, T_stamp_column, direction(column, b), out);
      }
    }
  }
}

Caster::Surface Caster::surfaceOf(const Hit& hit) const
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

std::optional<float> Caster::measuredRange(std::size_t column,
                                           std::size_t b,
                                           const Eigen::Vector3f& ray,
                                           Surface& surface) const
{
  const Hit& hit = hits_[column * beam_count_ + b];
  const MaterialProperties& m = *surface.material;
  float range = hit.range;
  // Relief is fixed to the surface and moves with bodies.
  const Eigen::Vector3f origin(0, 0, beams_.height[b]);
  Eigen::Vector3d on_surface =
      scene_.T_map_lidar_column[column] * (range * ray + origin).cast<double>();
  if (surface.part != nullptr)
  {
    on_surface =
        surface.part->at(static_cast<double>(sweepFraction(column))).inverse() * on_surface;
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
  const float draw = unit(hash(column, b, kDrawLoss));
  if ((m.loss > 0.2F ? 0.25F * draw + 0.75F * patch : draw) > detection_probability)
  {
    return std::nullopt;
  }
  // Mixed pixel: the beam meets two surfaces.
  const std::uint64_t mixed = hash(column, b, kDrawMixed);
  const Hit& beside =
      hits_[((column + 1) % static_cast<std::size_t>(sensor_.columns)) * beam_count_ + b];
  const float step = beside.range - hit.range;
  if (beside.range > 0 && std::abs(step) > 0.25F && std::abs(step) < 2.5F && unit(mixed) < 0.18F)
  {
    range += step * unit(splitmix64(mixed));
  }
  range += static_cast<float>(sensor_.range_noise) *
               (0.7F + 0.3F / std::sqrt(std::min(1.0F, signal) + 0.02F)) *
               normal(hash(column, b, kDrawRange)) +
           beams_.bias[b];
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

float Caster::measuredIntensity(std::size_t column, std::size_t b, float reflectivity) const
{
  const float shade = 0.35F + 0.65F * hits_[column * beam_count_ + b].cosine;
  const float brightness =
      reflectivity * shade *
      (scene_.noise ? 1 + 0.08F * normal(hash(column, b, kDrawIntensity)) : 1.0F);
  return std::round(255 * std::clamp(brightness, 0.0F, 1.0F)) / 255;
}

void Caster::resolveHit(std::size_t column,
                        std::size_t b,
                        const ScanMotion& motion,
                        const Eigen::Isometry3f& T_stamp_column,
                        const Eigen::Vector3f& ray,
                        ChunkOutput& out) const
{
  const Hit& hit = hits_[column * beam_count_ + b];
  Surface surface = surfaceOf(hit);
  const std::optional<float> range =
      scene_.noise ? measuredRange(column, b, ray, surface) : std::optional<float>(hit.range);
  if (!range)
  {
    return;
  }
  const Eigen::Vector3f point = *range * ray + Eigen::Vector3f(0, 0, beams_.height[b]);
  const Eigen::Vector3f deskewed = T_stamp_column * point;
  const float time =
      scene_.motion_distortion
          ? static_cast<float>(sensor_.columnTime(static_cast<double>(column))) + beams_.time[b]
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
    const double fraction = static_cast<double>(sweepFraction(column));
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
  out.intensity.push_back(measuredIntensity(column, b, surface.reflectivity));
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

Eigen::Affine3d blend(const Eigen::Affine3d& a, const Eigen::Affine3d& b, double fraction)
{
  Eigen::Affine3d m;
  m.matrix() = (1 - fraction) * a.matrix() + fraction * b.matrix();
  return m;
}
}  // namespace

Eigen::Affine3d PartMotion::at(double fraction) const
{
  return blend(start, end, fraction);
}

Eigen::Affine3d PartMotion::nextAt(double fraction) const
{
  return blend(end, next_end, fraction);
}

std::vector<BodyReturns> castSweep(const SensorModel& sensor,
                                   const SweepScene& scene,
                                   ThreadPool& pool,
                                   SimulatedScan& scan)
{
  Caster caster(sensor, scene);
  const auto columns = static_cast<std::size_t>(sensor.columns);
  pool.forChunks(columns, kColumnsPerChunk,
                 [&](std::size_t begin, std::size_t end, std::size_t)
                 { caster.trace(begin, end); });
  std::vector<ChunkOutput> chunks(ThreadPool::chunkCount(columns, kColumnsPerChunk));
  pool.forChunks(columns, kColumnsPerChunk,
                 [&](std::size_t begin, std::size_t end, std::size_t chunk)
                 { caster.resolve(begin, end, chunks[chunk]); });

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
