// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/Backend.h>
#include <dyslam/base/StateArchive.h>

#include <cstddef>
#include <vector>

namespace dyslam::test
{
/** A backend that is saved in the middle of a run, loaded and continued to the end, as by a
 * checkpoint and --resume. */
struct ResumedRun
{
  KeyframeStore keyframes;
  Backend backend;

  ResumedRun(const BackendConfig& config,
             std::vector<Frame>& frames,
             const std::vector<Eigen::Vector3f>& prior_map = {})
      : backend(config, keyframes, prior_map)
  {
    const std::size_t half = frames.size() / 2;
    KeyframeStore first_keyframes;
    Backend first(config, first_keyframes, prior_map);
    for (std::size_t i = 0; i < half; ++i)
    {
      first.addFrame(frames[i]);
    }
    StateArchive saved;
    first_keyframes.exchangeState(saved);
    first.exchangeState(saved);
    StateArchive loaded(saved.bytes());
    keyframes.exchangeState(loaded);
    backend.exchangeState(loaded);
    for (std::size_t i = half; i < frames.size(); ++i)
    {
      backend.addFrame(frames[i]);
    }
    backend.finish();
  }
};
}  // namespace dyslam::test
