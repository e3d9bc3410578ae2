// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/sim/SimulatorOptions.h>

#include <cstddef>
#include <functional>
#include <string>

namespace dyslam::sim
{
/** A recording to simulate. */
struct Recording
{
  SimulatorOptions simulator;
  double seconds = 10;    //!< simulated time, one scan at least; upper limit for `one_loop` [s]
  bool one_loop = false;  //!< stop 30 m after the ego has closed its loop
  /** Continues after `seconds` until this distance is driven [m], for at most three times as
   * long. */
  double least_distance = 0;
  std::string output;  //!< rawlog; the ground truth is written next to it
  bool flow = true;    //!< write per-point scene flow
  /** Small files: coordinates in multiples of 1/128 m, times of 2^-14 s, points sorted by ring. */
  bool compact = false;
  bool gnss = false;          //!< write positions of a satellite receiver (GnssReceiver)
  int compression_level = 1;  //!< level of gzip
  int threads = 0;            //!< number of threads; 0: number of cores
};

struct RecordingResult
{
  std::size_t scans = 0;
  std::size_t points = 0;
  std::size_t moving_points = 0;
  double distance = 0;       //!< distance travelled by the ego [m]
  double loop_length = 0;    //!< length of the ego's loop [m]
  std::size_t objects = 0;   //!< number of observed bodies that may move
  std::string ground_truth;  //!< folder of the ground truth
};

/** Simulates and writes rawlog and ground truth. If `progress` or anything else throws, all that
 * was written is removed, and an earlier recording stays. \throws UserError if options or files are
 * invalid. */
RecordingResult record(const Recording& recording,
                       const std::function<void(double fraction, std::size_t scans)>& progress);
}  // namespace dyslam::sim
