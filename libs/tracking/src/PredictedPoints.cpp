// SPDX-License-Identifier: BSD-3-Clause
#include "PredictedPoints.h"

#include <algorithm>

#include "PointsInBox.h"

namespace dyslam
{
namespace
{
constexpr float probability = 0.9F;  // moving probability of a point in the box
}  // namespace

void markMissed(const Box& box, Frame& frame)
{
  const std::size_t count = frame.cloud.size();
  const std::vector<std::uint32_t> inside = pointsInside(box, frame.cloud.points);
  const auto moving = std::count_if(inside.begin(), inside.end(),
                                    [&](std::uint32_t i) { return frame.isMoving(i); });
  if (2 * static_cast<std::size_t>(moving) >= inside.size())
  {
    return;
  }
  frame.moving.resize(count, false);
  frame.moving_by_prediction.resize(count, false);
  frame.moving_probability.resize(count, 0);
  for (const std::uint32_t i : inside)
  {
    if (!frame.moving[i])
    {
      frame.moving[i] = true;
      frame.moving_by_prediction[i] = true;
      frame.moving_probability[i] = std::max(frame.moving_probability[i], probability);
    }
  }
}
}  // namespace dyslam
