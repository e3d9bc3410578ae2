// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Fields.h>
#include <dyslam/base/StateArchive.h>
#include <dyslam/core/Frame.h>

#include <algorithm>
#include <tuple>
#include <utility>

namespace dyslam
{
static_assert(std::tuple_size_v<decltype(std::declval<Frame&>().members())> ==
                  fields::count<Frame>(),
              "add the new field of Frame to members(), in the order of declaration");

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
