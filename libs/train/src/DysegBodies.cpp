// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Scan.h>
#include <dyslam/train/DysegBodies.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace dyslam
{
namespace
{
constexpr float nothing = std::numeric_limits<float>::max();

class Builder
{
 public:
  explicit Builder(RandomDraws& draws) : draws_(draws) {}
  /** Sizes varied by up to 12 %. */
  Builder& add(bool round, float x, float y, float z, float length, float width, float height)
  {
    height *= vary();
    width *= vary();
    length *= vary();
    parts_.push_back({{x, y, z}, 0.5F * Eigen::Vector3f(length, width, height), round});
    return *this;
  }
  float vary() { return static_cast<float>(draws_.uniform(0.88, 1.12)); }
  [[nodiscard]] const std::vector<BodyPart>& parts() const { return parts_; }

 private:
  RandomDraws& draws_;
  std::vector<BodyPart> parts_;
};

void makePerson(Builder& b, float z, float length)
{
  b.add(true, 0, 0, z + 1.15F, 0.35F, 0.5F, 0.75F).add(true, 0, 0, z + 1.65F, 0.22F, 0.2F, 0.26F);
  b.add(false, 0.5F * length, 0.1F, z + 0.42F, 0.15F, 0.15F, 0.8F);
  b.add(false, -0.5F * length, -0.1F, z + 0.42F, 0.15F, 0.15F, 0.8F);
}

void makeRandom(Builder& b, RandomDraws& draws)
{
  const auto size = static_cast<float>(std::exp(draws.uniform(std::log(0.5), std::log(6.0))));
  const auto height = static_cast<float>(draws.uniform(0.7, std::min(3.5, 1.0 + size)));
  const std::size_t parts = 2 + draws.below(4);
  for (std::size_t i = 0; i < parts; ++i)
  {
    const auto within = [&](double share)
    { return static_cast<float>(draws.uniform(-share, share)); };
    const auto part = [&] { return static_cast<float>(draws.uniform(0.25, 0.8)); };
    const float h = height * part();
    const float width = 0.6F * size * part();
    const float length = size * part();
    const float z = 0.5F * h + static_cast<float>(draws.uniform()) * (height - h);
    const float y = size * within(0.2);
    const float x = size * within(0.3);
    b.add(draws.chance(0.5), x, y, z, length, width, h);
  }
}

/** Distance along a unit ray from `origin` (body frame) to a part; `nothing` if it misses. */
float hit(const BodyPart& part, const Eigen::Vector3f& origin, const Eigen::Vector3f& ray)
{
  const Eigen::Vector3f from = origin - part.centre;
  if (part.round)
  {
    const Eigen::Vector3f o = from.cwiseQuotient(part.half);
    const Eigen::Vector3f d = ray.cwiseQuotient(part.half);
    const float a = d.squaredNorm();
    const float b = o.dot(d);
    const float root = b * b - a * (o.squaredNorm() - 1);
    return root > 0 && b < 0 ? (-b - std::sqrt(root)) / a : nothing;
  }
  float enter = 0;
  float leave = nothing;
  for (int axis = 0; axis < 3; ++axis)
  {
    const float d = std::abs(ray[axis]) > 1e-6F ? ray[axis] : 1e-6F;
    const float one = (-part.half[axis] - from[axis]) / d;
    const float two = (part.half[axis] - from[axis]) / d;
    enter = std::max(enter, std::min(one, two));
    leave = std::min(leave, std::max(one, two));
  }
  return enter < leave && enter > 0 ? enter : nothing;
}
}  // namespace

bool CastBody::covers(const Eigen::Vector2f& p, float margin) const
{
  const Eigen::Array2f low = bounds.min().head<2>().array() - margin;
  const Eigen::Array2f high = bounds.max().head<2>().array() + margin;
  return (p.array() > low).all() && (p.array() < high).all();
}

CastBody assembleBody(BodyKind kind, std::vector<BodyPart> parts)
{
  CastBody body;
  body.kind = kind;
  body.parts = std::move(parts);
  for (const auto& part : body.parts)
  {
    body.radius = std::max(body.radius, part.centre.head<2>().norm() + part.half.head<2>().norm());
    body.bounds.extend(part.centre - part.half);
    body.bounds.extend(part.centre + part.half);
  }
  return body;
}

CastBody makeBody(BodyKind kind, RandomDraws& draws)
{
  Builder b(draws);
  switch (kind)
  {
    case BodyKind::car:
    {
      b.add(false, 0, 0, 0.62F, 4.2F, 1.75F, 0.7F);
      const auto x = static_cast<float>(draws.uniform(-0.5, 0.1));
      b.add(draws.chance(0.4), x, 0, 1.2F, 2.4F, 1.55F, 0.65F);
      break;
    }
    case BodyKind::van:
      b.add(false, 0, 0, 1.2F, 4.8F, 1.9F, 1.8F);
      break;
    case BodyKind::truck:
    {
      const auto length = static_cast<float>(draws.uniform(4, 10));
      b.add(false, -0.5F, 0, 2.1F, length, 2.4F, 2.6F);
      b.add(false, 0.5F * length + 0.7F, 0, 1.5F, 2.0F, 2.3F, 2.4F);
      b.add(false, -0.3F * length, 0, 0.55F, 1.2F, 2.2F, 0.9F);
      break;
    }
    case BodyKind::pedestrian:
      makePerson(b, 0, static_cast<float>(draws.uniform(0, 0.7)));
      break;
    case BodyKind::cyclist:
      makePerson(b, 0.15F, 0.3F);
      b.add(false, 0, 0, 0.5F, 1.7F, 0.12F, 0.7F);
      break;
    case BodyKind::random:
      makeRandom(b, draws);
      break;
  }
  return assembleBody(kind, b.parts());
}

std::vector<std::uint32_t> castBody(const CastBody& body,
                                    const Pose& T_sensor_body,
                                    float range_noise,
                                    RandomDraws& draws,
                                    std::vector<Eigen::Vector3f>& points)
{
  std::vector<std::uint32_t> on_body;
  const Eigen::Isometry3f T_body_sensor = T_sensor_body.inverse().cast<float>();
  const Eigen::Vector3f origin = T_body_sensor.translation();
  const Eigen::Vector2f centre = T_sensor_body.translation().head<2>().cast<float>();
  const float distance = centre.norm();
  if (body.covers(origin.head<2>(), 0.5F))
  {
    return on_body;
  }
  // Seen from above a ray can only hit within a narrow sector.
  const bool around = distance <= body.radius;
  const Eigen::Vector2f ahead = centre / std::max(distance, 1e-3F);
  const float sine = body.radius / distance;
  const float cosine2 = 1 - sine * sine;
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    const Eigen::Vector3f p = points[i];
    const float forward = ahead.dot(p.head<2>());
    if (!around && (!(forward > 0) || forward * forward < cosine2 * p.head<2>().squaredNorm() ||
                    forward < distance - body.radius))
    {
      continue;
    }
    const float range = p.norm();
    if (!(range > 0))
    {
      continue;
    }
    const Eigen::Vector3f ray = T_body_sensor.linear() * (p / range);
    float nearest = nothing;
    for (const auto& part : body.parts)
    {
      nearest = std::min(nearest, hit(part, origin, ray));
    }
    if (nearest < range - 0.05F)
    {
      const float seen = nearest + static_cast<float>(draws.normal(range_noise));
      points[i] = p * (seen / range);
      on_body.push_back(static_cast<std::uint32_t>(i));
    }
  }
  return on_body;
}
}  // namespace dyslam
