// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/mapping/StaticMap.h>

#include <cstddef>
#include <memory>
#include <vector>

namespace dyslam::test
{
/** A map with its keyframes; every frame becomes a keyframe. */
struct TestMap
{
  explicit TestMap(const StaticMapOptions& options = {}, const MemoryLimit& memory = {})
      : keyframes(std::make_unique<KeyframeStore>(memory)), map(options, *keyframes)
  {
  }

  void insert(const Frame& frame)
  {
    keyframes->add(keyframeOf(frame));
    map.insert(frame);
  }
  /** Corrects the keyframes' poses and then the map, as after a loop closure. */
  void correct(const std::vector<Pose>& poses)
  {
    keyframes->correct(poses);
    map.correct();
  }
  /** Number of map points kept in all keyframes. */
  [[nodiscard]] std::size_t pointCount() const
  {
    std::size_t count = 0;
    for (std::size_t k = 0; k < keyframes->size(); ++k)
    {
      count += keyframes->mapCloud(k).size();
    }
    return count;
  }

  std::unique_ptr<KeyframeStore> keyframes;
  StaticMap map;
};
}  // namespace dyslam::test
