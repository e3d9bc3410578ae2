// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Fields.h>
#include <dyslam/base/StateArchive.h>
#include <dyslam/core/Frame.h>

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
}  // namespace dyslam
