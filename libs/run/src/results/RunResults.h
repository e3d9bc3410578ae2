// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/SmoothedObject.h>
#include <dyslam/core/Trajectory.h>
#include <dyslam/mapping/StaticMap.h>
#include <dyslam/run/SlamRunReport.h>

#include <chrono>
#include <map>
#include <string>
#include <vector>

namespace dyslam
{
class Backend;
class RunHistory;

/** Results of a run, complete after its last frame. */
struct RunResults
{
  const Backend* backend = nullptr;
  const StaticMap* map = nullptr;       //!< null if mapping is off
  const RunHistory* history = nullptr;  //!< all scans and objects
  MapPoints map_points;                 //!< points of the map; evenly thinned to a few millions
  Trajectory trajectory;                //!< T_map_vehicle of every frame
  std::vector<SmoothedObject> objects;  //!< of the graph, or smoothed tracks; by scan, then id
  std::map<int, int> merged_tracks;     //!< id of the object of each track that was merged
  Trajectory reference;  //!< ground truth in the map frame, where the recording has it
  std::map<std::string, double> stage_ms;   //!< mean time of each stage per frame [ms]
  std::map<std::string, double> wait_ms;    //!< mean waiting time of each thread per frame [ms]
  std::map<std::string, double> memory_mb;  //!< by part, at the end; `largest`: peak of the process
  std::chrono::steady_clock::time_point begin = std::chrono::steady_clock::now();
  SlamRunReport report;               //!< its `files` are the ones written so far
  std::vector<std::string> failures;  //!< reasons why outputs could not be written

  [[nodiscard]] double runTime() const  //!< time since `begin` [s]
  {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  }
};
}  // namespace dyslam
