// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Options.h>

#include <Eigen/Core>
#include <vector>

namespace dyslam
{
struct TrackSmoothingOptions : Options
{
  double window = 1.5;  //!< half width of the window of observations [s]; 0: not smoothed
  int degree = 2;       //!< degree of the polynomials; 0: velocities are not changed
  /** Overlap, as a fraction of the smaller footprint, above which two tracks are of one object
   * (findMergedTracks()); 1: none are merged. */
  double merge_overlap = 0.3;

  void describe(OptionsVisitor& visitor) override;
};

/** State of an object at one time, in a fixed frame. */
struct TrackState
{
  double time = 0;                                     //!< Frame::time() [s]
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();    //!< centre of its box [m]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  //!< velocity of the centre [m/s]
  bool observed = true;  //!< false: predicted by the tracker, not used by the smoother
};

/** Smooths the path of one object with the observations before and after each time: robust locally
 * weighted regression with polynomials (Cleveland, 1979), a centred form of the sliding window of
 * the paper's Eqs. 2-5. The velocity is their derivative.
 *
 * Heights are fitted by straight lines: roads slope slowly, and the visible height of an object
 * varies. The degree is reduced where there are few observations. At degree 0 (one observation in
 * the window) a state keeps its velocity; without observations in the window it is not changed.
 * Deterministic. \param track states in order of time \throws std::invalid_argument unless the
 * times increase. */
[[nodiscard]] std::vector<TrackState> smoothTrack(const std::vector<TrackState>& track,
                                                  const TrackSmoothingOptions& options);
}  // namespace dyslam
