// SPDX-License-Identifier: BSD-3-Clause
#include "RayCaster.h"

#include <algorithm>
#include <cmath>

#include "Random.h"

namespace dyslam::sim
{
namespace
{
constexpr int packet_size = 8;
}  // namespace

RayCaster::RayCaster(const SensorModel& sensor, const SweepScene& scene, const SweepRays& rays)
    : sensor_(sensor), scene_(scene), rays_(rays)
{
  hits_.resize(rays.beamCount() * static_cast<std::size_t>(sensor.columns));
}

void RayCaster::trace(std::size_t begin, std::size_t end)
{
  for (std::size_t c = begin; c < end; c += packet_size)
  {
    const std::size_t count = std::min<std::size_t>(packet_size, end - c);
    for (std::size_t b = 0; b < rays_.beamCount(); ++b)
    {
      tracePacket(c, count, b);
    }
  }
}

void RayCaster::tracePacket(std::size_t column, std::size_t count, std::size_t b)
{
  alignas(32) RTCRayHit8 packet;
  alignas(32) int valid[packet_size];
  for (std::size_t k = 0; k < packet_size; ++k)
  {
    valid[k] = k < count ? -1 : 0;
    setRay(column + std::min(k, count - 1), b, k, packet);
  }
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcIntersect8(valid, scene_.static_scene->handle(), &context, &packet);
  // A hit in the moving scene replaces that in the static one, also at the same range.
  const RTCHit8 static_hit = packet.hit;
  std::fill_n(packet.hit.geomID, packet_size, RTC_INVALID_GEOMETRY_ID);
  if (!scene_.moving_scene->empty())
  {
    rtcIntersect8(valid, scene_.moving_scene->handle(), &context, &packet);
  }
  for (std::size_t k = 0; k < count; ++k)
  {
    const bool moved = packet.hit.geomID[k] != RTC_INVALID_GEOMETRY_ID;
    const RTCHit8& found = moved ? packet.hit : static_hit;
    if (found.geomID[k] != RTC_INVALID_GEOMETRY_ID)
    {
      hits_[(column + k) * rays_.beamCount() + b] = hitOf(packet.ray, found, moved, k);
    }
  }
}

/** Makes ray k of a packet that of a beam at a column. */
void RayCaster::setRay(std::size_t column, std::size_t b, std::size_t k, RTCRayHit8& packet) const
{
  Eigen::Vector3f d = rays_.direction(rays_.columnAt(column), b);
  if (scene_.noise)
  {
    // Random direction within the beam, which blurs edges. The spread is smaller in elevation,
    // because on the ground the echo averages over the footprint.
    const std::uint64_t h = rays_.hash(column, b, Draw::cone);
    const auto spread = static_cast<float>(sensor_.divergence) * 0.6F;
    const Eigen::Vector3f side(-d.y(), d.x(), 0);
    d += spread * (normal(h) * side + 0.2F * normal(splitmix64(h)) * Eigen::Vector3f::UnitZ());
    d.normalize();
  }
  const Pose& pose = scene_.T_map_lidar_column[column];
  const Eigen::Vector3f o =
      (pose * Eigen::Vector3d(0, 0, static_cast<double>(rays_.beams().height[b]))).cast<float>();
  const Eigen::Vector3f w = pose.linear().cast<float>() * d;
  packet.ray.org_x[k] = o.x();
  packet.ray.org_y[k] = o.y();
  packet.ray.org_z[k] = o.z();
  packet.ray.dir_x[k] = w.x();
  packet.ray.dir_y[k] = w.y();
  packet.ray.dir_z[k] = w.z();
  packet.ray.tnear[k] = static_cast<float>(sensor_.min_range);
  packet.ray.tfar[k] = static_cast<float>(sensor_.max_range);
  packet.ray.time[k] = rays_.sweepFraction(column);
  packet.ray.mask[k] = ~0U;
  packet.ray.id[k] = static_cast<unsigned>(k);
  packet.ray.flags[k] = 0;
  packet.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
  packet.hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;
}

/** What ray k of a packet hits. \param moved whether `found` is from the moving scene */
Hit RayCaster::hitOf(const RTCRay8& rays, const RTCHit8& found, bool moved, std::size_t k) const
{
  Hit hit;
  const unsigned instance = found.instID[0][k];
  const auto item =
      static_cast<std::int32_t>(instance != RTC_INVALID_GEOMETRY_ID ? instance : found.geomID[k]);
  hit.item = moved ? -1 - item : item;
  hit.quad = static_cast<std::int32_t>(found.primID[k]);
  hit.range = rays.tfar[k];
  Eigen::Vector3f normal_local(found.Ng_x[k], found.Ng_y[k], found.Ng_z[k]);
  const Eigen::Vector3f w(rays.dir_x[k], rays.dir_y[k], rays.dir_z[k]);
  if (instance != RTC_INVALID_GEOMETRY_ID)
  {
    // Embree returns an instance's normal in the instance's frame.
    const RayScene& scene = moved ? *scene_.moving_scene : *scene_.static_scene;
    normal_local = scene.items()[static_cast<std::size_t>(item)].turn * normal_local;
  }
  hit.cosine = std::abs(normal_local.normalized().dot(w));
  return hit;
}
}  // namespace dyslam::sim
