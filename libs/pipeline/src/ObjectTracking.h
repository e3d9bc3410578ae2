// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Options.h>
#include <dyslam/core/Frame.h>
#include <dyslam/tracking/Detector.h>
#include <dyslam/tracking/Tracker.h>

#include <optional>
#include <string>
#include <vector>

#include "GivenBoxes.h"

namespace dyslam
{
class StateArchive;

/** Objects of frames: found by Detector, or given as boxes of another program, and tracked. */
class ObjectTracking
{
 public:
  /** Loads [detector], [boxes], [detection_noise] and [tracker]. \throws UserError for bad options,
   * and for boxes that cannot be read. */
  ObjectTracking(ConfigLoader& config, MovingLabels labels);

  /** Whether boxes of another program are used instead of the detector's. */
  [[nodiscard]] bool hasGivenBoxes() const { return boxes_.has_value(); }
  /** GivenBoxes::warnings(); none without boxes of another program. */
  [[nodiscard]] std::vector<std::string> warnings() const
  {
    return boxes_ ? boxes_->warnings() : std::vector<std::string>();
  }

  /** Sets detections and objects of the frame. Frames come in order of time. */
  void update(Frame& frame);
  /** Saves or loads the state between frames. */
  void exchangeState(StateArchive& archive);

 private:
  Detector detector_;
  std::optional<GivenBoxes> boxes_;
  Tracker tracker_;
};
}  // namespace dyslam
