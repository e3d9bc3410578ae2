// SPDX-License-Identifier: BSD-3-Clause
#include "PredictedPoints.h"

#include <algorithm>

#include "PointsInBox.h"

namespace dyslam
{
namespace
{
constexpr float probability = 0.9F;  // moving probability of a point in the box

/** Leaves out the points that labels with hindsight know to be static. Those near the ground with
 * nothing above them, whose probability is 0, are known to be static only where the box has other
 * points: of a distant object a sparse sensor may hit nothing else. */
void removeStatic(const Frame& frame, std::vector<std::uint32_t>& inside)
{
  constexpr float certainly_static = 0.003F;  // highest probability of what rays never passed
  const auto is_low = [&](std::uint32_t i) { return frame.moving_probability[i] == 0; };
  if (!std::all_of(inside.begin(), inside.end(), is_low))
  {
    inside.erase(std::remove_if(inside.begin(), inside.end(),
                                [&](std::uint32_t i)
                                { return frame.moving_probability[i] < certainly_static; }),
                 inside.end());
  }
}
}  // namespace

void markMissed(const Box& box, MovingLabels labels, Frame& frame)
{
  const std::size_t count = frame.cloud.size();
  std::vector<std::uint32_t> inside = pointsInside(box, frame.cloud.points);
  if (labels == MovingLabels::hindsight && frame.moving_probability.size() == count)
  {
    removeStatic(frame, inside);
  }
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
