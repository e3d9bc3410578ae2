// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/sim/SimulatorOptions.h>

#include <cstddef>
#include <functional>
#include <string>

namespace dyslam::sim
{
/** What to simulate, how long, and where to. */
struct Recording
{
  SimulatorOptions simulator;
  double seconds = 10;    //!< of simulated time; the longest time if `one_loop`
  bool one_loop = false;  //!< stop when the ego is 30 m past its start again
  std::string output;     //!< the rawlog; its truth goes beside it
  bool flow = true;       //!< write per-point scene flow
  /** Small files: coordinates on a grid of 1/128 m, times on one of 2^-14 s, ring by ring. */
  bool compact = false;
  int compression_level = 1;  //!< of gzip
  int threads = 0;            //!< 0 takes the machine's number
};

struct RecordingResult
{
  std::size_t scans = 0;
  std::size_t points = 0;
  std::size_t moving_points = 0;
  double distance = 0;       //!< driven by the ego [m]
  double loop_length = 0;    //!< [m]
  std::size_t objects = 0;   //!< different bodies seen
  std::string ground_truth;  //!< folder of the truth
};

/** Simulates and writes rawlog and truth. \throws UserError. */
RecordingResult record(const Recording& recording,
                       const std::function<void(double fraction, std::size_t scans)>& progress);
}  // namespace dyslam::sim
