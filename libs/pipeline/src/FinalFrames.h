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

/** The last stage: makes causal frames, as the back end leaves them, final. A frame passes through
 * these steps, each in the order of the scans:
 *
 * 1. The first frame waits for the second one, whose motion deskews it.
 * 2. With `labels.hindsight` the moving points are decided again once `labels.window` later frames
 *    are there, or at the end. Until then HindsightLabels holds a copy of the parts of the frame
 *    that the next steps need. Without it this step is left out.
 * 3. The second tracking, if there is one, finds the objects again.
 * 4. A keyframe is added to the static map.
 * 5. The receiver gets the frame.
 *
 * Between two frames nothing is held but the first frame and the copies of step 2. */
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
  void onFinal(std::function<void(Frame)> receive, FrameParts parts);
  /** Whether moving points are decided again with hindsight; if not, the causal labels are final.
   */
  [[nodiscard]] bool hasHindsightLabels() const { return hindsight_labels_.has_value(); }
  /** See Pipeline::hasSecondTracking(). */
  [[nodiscard]] bool hasSecondTracking() const { return second_tracking_.has_value(); }

  /** Takes the next causal frame, in the order of the scans, and makes those frames final that this
   * one completes. It is read until add() returns. */
  void add(const Frame& causal);
  /** Called after the last frame: makes the frames final that still wait, and corrects the map.
   * Steps 3 to 5 run in another thread meanwhile, which has ended when this returns. */
  void finish();
  /** Saves or loads the state between frames. */
  void exchangeState(StateArchive& archive);

  /** The static map; null if mapping is off. */
  [[nodiscard]] const StaticMap* map() const { return options_.mapping ? &map_ : nullptr; }

 private:
  /** End of step 1: passes the first frame on, if it still waits. */
  void releaseFirst();
  /** Step 2, and the later steps for the frames whose moving points are final now. */
  void label(const Frame& causal);
  /** Steps 3 to 5. \param labelled a frame with its final moving points */
  void complete(Frame labelled);
  /** Step 3. */
  void trackAgain(Frame& labelled);
  /** Step 4. */
  void insertInMap(const Frame& final_frame);
  /** Parts of a frame that steps 3 to 5 need. */
  [[nodiscard]] FrameParts neededParts(const Frame& frame) const;

  PipelineOptions options_;
  ThreadPool& pool_;
  mrpt::system::CTimeLogger& times_;
  StaticMap map_;
  std::optional<HindsightLabels> hindsight_labels_;
  std::optional<ObjectTracking> second_tracking_;  //!< only with hindsight_labels_
  bool has_begun_ = false;                         //!< there was a frame
  std::optional<Frame> first_;           //!< first frame, until the second one's motion deskews it
  std::function<void(Frame)> receiver_;  //!< empty: nobody receives final frames
  FrameParts receiver_parts_ = FrameParts::none;  //!< parts of a frame that receiver_ needs
};
}  // namespace dyslam
