// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Options.h>
#include <dyslam/core/FrameCopy.h>

#include <cstddef>
#include <functional>
#include <memory>

namespace dyslam
{
class StateArchive;

/** Ini section `[labels]`. */
struct HindsightOptions : Options
{
  bool hindsight = true;     //!< label moving points from earlier and later scans
  int window = 100;          //!< number of scans used before, and after, the labelled scan
  int history = 400;         //!< number of scans before the window of which every eighth is used
  double voxel_size = 0.2;   //!< side of the voxels that accumulate evidence [m]
  double segment_gap = 0.4;  //!< side of the cells that are clustered to segments [m]
  double margin = 0.5;       //!< a ray must end this far behind a voxel to observe it as free [m]
  double moving_threshold = 0.5;  //!< points with a higher probability are moving
  double ground_clearance = 0.2;  //!< height below which returns get the label of those above [m]

  void describe(OptionsVisitor& visitor) override;
};

/** Labels the moving points of each scan again, from the scans before and after it.
 *
 * The returns above the ground are clustered to segments. The rays of the scans before and after
 * show whether a voxel was free or occupied then: what was never free is static; what arrived or
 * will leave is moving, also while it is at rest in between. The causal decision (network or
 * residual) and the track that a point belongs to, from its first detection to its last, are the
 * prior. The idea of ray evidence follows Removert (Kim and Kim, 2020), ERASOR (Lim et al., 2021)
 * and DUFOMap (Duberg et al., 2024).
 *
 * Frames are output `window` scans after they were added, so that memory is bounded. The same bytes
 * for any number of threads. Not thread-safe.
 */
class HindsightLabels
{
 public:
  using Use = std::function<void(Frame)>;

  /** \param threads 0: as many as the machine has. \throws UserError for options out of range. */
  explicit HindsightLabels(const HindsightOptions& options, int threads = 0);
  ~HindsightLabels();

  /** Takes the next frame, in order of time: cloud, moving, moving_probability, poses, detections
   * and objects are read. Calls `use` with each frame that is decided now: `moving` is the new
   * decision and `moving_probability` its probability (one value per cloud point each; above
   * HindsightOptions::moving_threshold: moving), and an object that was reported later is
   * `reported`. Frames added with `kept` = `none` are used as evidence but never output. */
  void add(const Frame& frame, FrameParts kept, const Use& use);
  /** Decides the remaining frames. */
  void finish(const Use& use);

  /** Saves or restores the scans of the window and before it, and the evidence of voxels and
   * tracks. */
  void exchangeState(StateArchive& archive);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};
}  // namespace dyslam
