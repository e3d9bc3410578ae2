// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Fields.h>
#include <dyslam/base/StateArchive.h>
#include <dyslam/core/Frame.h>

#include <algorithm>
#include <tuple>
#include <utility>
#include <vector>

namespace dyslam
{
namespace
{
const std::vector<std::uint32_t> no_points;
}  // namespace

static_assert(std::tuple_size_v<decltype(std::declval<Frame&>().members())> ==
                  fields::count<Frame>(),
              "add the new field of Frame to members(), in the order of declaration");

const std::vector<std::uint32_t>& Frame::pointsOf(const TrackedObject& object) const
{
  return object.detection < 0 ? no_points
                              : detections[static_cast<std::size_t>(object.detection)].points;
}

void Frame::exchangeState(StateArchive& archive)
{
  std::apply(archive, members());
}

void decideMoving(Frame& frame, double moving_threshold)
{
  frame.moving.assign(frame.cloud.size(), false);
  if (frame.moving_probability.size() == frame.moving.size())
  {
    std::transform(frame.moving_probability.begin(), frame.moving_probability.end(),
                   frame.moving.begin(),
                   [&](float p) { return static_cast<double>(p) > moving_threshold; });
  }
}
}  // namespace dyslam
