// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/MovingPoints.h>

#include <algorithm>

namespace dyslam
{
std::vector<bool> likelyMoving(const Frame& frame, double threshold)
{
  std::vector<bool> moving(frame.cloud.size(), false);
  if (frame.moving_probability.size() == moving.size())
  {
    std::transform(frame.moving_probability.begin(), frame.moving_probability.end(), moving.begin(),
                   [&](float p) { return static_cast<double>(p) > threshold; });
  }
  return moving;
}

std::vector<bool> movingPoints(const Frame& frame, double threshold)
{
  std::vector<bool> moving = likelyMoving(frame, threshold);
  for (const auto& object : frame.objects)
  {
    const bool has_points = object.dynamic && object.detection >= 0 &&
                            static_cast<std::size_t>(object.detection) < frame.detections.size();
    if (!has_points)
    {
      continue;
    }
    for (const auto i : frame.detections[static_cast<std::size_t>(object.detection)].points)
    {
      if (i < moving.size())
      {
        moving[i] = true;
      }
    }
  }
  return moving;
}
}  // namespace dyslam
