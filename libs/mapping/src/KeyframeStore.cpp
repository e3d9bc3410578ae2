// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/mapping/KeyframeStore.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace dyslam
{
namespace
{
constexpr float steps = std::numeric_limits<std::int16_t>::max();
}  // namespace

KeyframeStore::KeyframeStore(double range_limit) : scale_(static_cast<float>(range_limit) / steps)
{
  if (!(range_limit > 0) || !std::isfinite(range_limit))
  {
    throw std::invalid_argument("KeyframeStore: the range limit must be positive");
  }
}

void KeyframeStore::add(const KeyframeInfo& info, const KeyframeCloud& cloud)
{
  if (cloud.intensity.size() != cloud.size() || cloud.is_static.size() != cloud.size())
  {
    throw std::invalid_argument("KeyframeStore: the cloud's arrays differ in length");
  }
  std::vector<PackedPoint> packed;
  packed.reserve(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i)
  {
    const Eigen::Vector3f p = cloud.points[i] / scale_;
    if (!p.allFinite() || p.cwiseAbs().maxCoeff() > steps)
    {
      continue;
    }
    const float intensity = std::isfinite(cloud.intensity[i]) ? cloud.intensity[i] : 0.0F;
    packed.push_back(
        {static_cast<std::int16_t>(std::lround(p.x())),
         static_cast<std::int16_t>(std::lround(p.y())),
         static_cast<std::int16_t>(std::lround(p.z())),
         static_cast<std::uint8_t>(std::lround(255.0F * std::clamp(intensity, 0.0F, 1.0F))),
         cloud.is_static[i]});
  }
  packed.shrink_to_fit();
  point_count_ += packed.size();
  infos_.push_back(info);
  points_.push_back(std::move(packed));
}

void KeyframeStore::thin(std::size_t i, const std::vector<bool>& keep)
{
  auto& points = points_.at(i);
  if (keep.size() != points.size())
  {
    throw std::invalid_argument("KeyframeStore: one flag per point is needed");
  }
  std::size_t kept = 0;
  for (std::size_t k = 0; k < points.size(); ++k)
  {
    if (keep[k])
    {
      points[kept++] = points[k];
    }
  }
  point_count_ -= points.size() - kept;
  points.resize(kept);
  points.shrink_to_fit();
}

KeyframeCloud KeyframeStore::cloud(std::size_t i) const
{
  const auto& packed = points_.at(i);
  KeyframeCloud cloud;
  cloud.points.reserve(packed.size());
  cloud.intensity.reserve(packed.size());
  cloud.is_static.reserve(packed.size());
  for (const PackedPoint& p : packed)
  {
    cloud.points.emplace_back(scale_ * static_cast<float>(p.x), scale_ * static_cast<float>(p.y),
                              scale_ * static_cast<float>(p.z));
    cloud.intensity.push_back(static_cast<float>(p.intensity) / 255.0F);
    cloud.is_static.push_back(p.is_static);
  }
  return cloud;
}
}  // namespace dyslam
