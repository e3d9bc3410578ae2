// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Options.h>
#include <dyslam/core/Frame.h>
#include <dyslam/core/FrameCopy.h>
#include <dyslam/core/KeyframeStore.h>
#include <dyslam/mapping/HindsightLabels.h>
#include <dyslam/mapping/StaticMap.h>
#include <dyslam/pipeline/Pipeline.h>

#include <functional>
#include <optional>

#include "ObjectTracking.h"

namespace mrpt::system
{
class CTimeLogger;
}

namespace dyslam
{
class StateArchive;
class ThreadPool;

/** Frames whose moving points and objects are final: labels and tracks with hindsight, the static
 * map, and the receiver of these frames. */
class FinalFrames
{
 public:
  /** Loads [map], [labels], and what it needs of [pipeline] and [backend]. \param has_given_boxes
   * objects are boxes of another program, which are not tracked again \param keyframes, pool, times
   * outlive the object \throws UserError for bad options. */
  FinalFrames(ConfigLoader& config,
              bool has_given_boxes,
              KeyframeStore& keyframes,
              ThreadPool& pool,
              mrpt::system::CTimeLogger& times);

  /** See Pipeline::onFinal(). */
  void onFinal(std::function<void(Frame)> use, FrameParts parts);
  /** Whether labels are decided with hindsight; if not, those of each frame are final. */
  [[nodiscard]] bool hasHindsight() const { return hindsight_.has_value(); }
  /** See Pipeline::tracksWithHindsight(). */
  [[nodiscard]] bool tracksAgain() const { return tracking_again_.has_value(); }

  /** See Pipeline::finaliseFrames(). */
  void add(const Frame& frame);
  /** Called after the last frame: finalises the frames that still wait, and corrects the map. */
  void finish();
  /** Saves or loads the state between frames. */
  void exchangeState(StateArchive& archive);

  /** The static map; null if mapping is off. */
  [[nodiscard]] const StaticMap* map() const { return options_.mapping ? &map_ : nullptr; }

 private:
  /** Takes the next frame, and finalises frames whose moving points are final now. */
  void finalise(const Frame& frame);
  void finaliseFirst();
  /** Parts of a frame that are kept until it is final. */
  [[nodiscard]] FrameParts keptOf(const Frame& frame) const;
  /** Tracks the objects of a final frame again, if this is on; passes it to map and on_final_. */
  void handOn(Frame final_frame);
  void insertInMap(const Frame& final_frame);

  PipelineOptions options_;
  ThreadPool& pool_;
  mrpt::system::CTimeLogger& times_;
  StaticMap map_;
  std::optional<HindsightLabels> hindsight_;
  std::optional<ObjectTracking> tracking_again_;  //!< of final frames
  std::optional<Frame> first_;  //!< first frame, until the second one's motion deskews it
  std::function<void(Frame)> on_final_;
  FrameParts final_parts_ = FrameParts::points;  //!< parts of final frames for on_final_
};
}  // namespace dyslam
