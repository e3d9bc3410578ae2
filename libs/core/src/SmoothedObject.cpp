// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/SmoothedObject.h>

#include <algorithm>

namespace dyslam
{
const SmoothedObject* findSmoothed(const std::vector<SmoothedObject>& objects,
                                   std::size_t scan,
                                   int id)
{
  const auto found = std::lower_bound(
      objects.begin(), objects.end(), scan,
      [id](const SmoothedObject& object, std::size_t wanted)
      { return object.scan < wanted || (object.scan == wanted && object.id < id); });
  return found != objects.end() && found->scan == scan && found->id == id ? &*found : nullptr;
}
}  // namespace dyslam
