// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/FrameCopy.h>

#include <vector>

namespace dyslam
{
/** The two frames of a scan, see Pipeline::onFinal(). */
enum class FrameKind
{
  causal,  //!< by this scan and those before it; right after the scan is processed
  final    //!< by later scans as well; some seconds later, but for the same scans in the same order
};

/** What an output asks for. Each value asks for more of final frames than the one before. */
enum class WantedFrames
{
  causal,         //!< causal frames in every run
  final_objects,  //!< the objects of final frames; where they are the causal ones, causal frames
  /** Moving points and objects of final frames, and intensities. Causal frames do where the objects
   * are the same and no other output asks for `final_scans`: holding final frames needs memory. */
  final_points,
  final_scans  //!< final frames in every run, with all points of the scan
};

/** Which outputs of a run get causal frames, and which get final ones. An output gets frames of one
 * kind only, from the first scan to the last. */
class FrameRouting
{
 public:
  /** \param wanted what the outputs of the run ask for \param objects the frames that have the
   * objects of the results: final ones with a second tracking, else causal ones */
  FrameRouting(const std::vector<WantedFrames>& wanted, FrameKind objects);

  /** The frames of an output that asks for `wanted`, one of those of the constructor. */
  [[nodiscard]] FrameKind kindFor(WantedFrames wanted) const;
  /** The parts of final frames that the outputs need; `none` if no output gets final frames. */
  [[nodiscard]] FrameParts finalParts() const { return final_parts_; }

 private:
  WantedFrames least_for_final_;  //!< outputs that ask for this or more get final frames
  FrameParts final_parts_ = FrameParts::none;
};
}  // namespace dyslam
