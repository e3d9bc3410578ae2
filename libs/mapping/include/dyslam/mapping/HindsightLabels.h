// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>
#include <dyslam/core/Options.h>

#include <cstddef>
#include <functional>
#include <memory>

namespace dyslam
{
class StateArchive;

/** Ini section `[labels]`. */
struct HindsightOptions : Options
{
  bool hindsight = true;     //!< decide what moves from scans before and after
  int window = 100;          //!< scans looked at on each side
  int history = 400;         //!< scans before those looked at as well; one in eight is held
  double voxel_size = 0.2;   //!< points this near to each other share their evidence [m]
  double segment_gap = 0.4;  //!< side of the cells whose neighbours form one segment [m]
  double margin = 0.5;       //!< a ray must end this far behind a place to observe it as free [m]
  double ground_clearance = 0.3;  //!< what is lower above the ground stays as it is around it [m]

  void describe(OptionsVisitor& visitor) override;
};

/** Decides again what moves in each scan of a replay, which knows the scans after it as well.
 *
 * The returns above the ground are joined to segments. Of each place the rays of the scans before
 * and after tell whether it was free or occupied then: what was never free stands; what came or
 * will leave moves, even while it stands in between. The causal decision (network or residual) and
 * the track that a point belongs to, from its first detection to its last, are the prior. The idea
 * of ray evidence follows Removert (Kim and Kim, 2020), ERASOR (Lim et al., 2021) and DUFOMap
 * (Duberg et al., 2024).
 *
 * Frames leave it `window` scans after they came, so that memory is bounded. The same bytes for any
 * number of threads. Not thread-safe.
 */
class HindsightLabels
{
 public:
  using Use = std::function<void(Frame)>;

  /** \param threads 0: as many as the machine has. */
  explicit HindsightLabels(const HindsightOptions& options, int threads = 0);
  ~HindsightLabels();

  /** Takes the next frame, in order of time: cloud, moving, moving_probability, poses, detections
   * and objects are read. Calls `use` with each frame that is decided now: `moving` is the new
   * decision and `moving_probability` how sure it is (one value per cloud point each: what moves is
   * above 0.5), and an object that was reported later is `reported`.
   * \param wanted false: the frame is evidence for others only, and `use` never gets it. */
  void add(const Frame& frame, bool wanted, const Use& use);
  /** Decides the frames that are left. */
  void finish(const Use& use);

  /** The scans of the window. */
  void exchangeState(StateArchive& archive);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};
}  // namespace dyslam
