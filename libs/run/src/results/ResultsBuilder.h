// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Options.h>
#include <dyslam/odometry/MotionSensors.h>
#include <dyslam/run/SlamRunSettings.h>
#include <dyslam/tracking/TrackSmoother.h>

#include <string>
#include <vector>

#include "RunHistory.h"
#include "RunResults.h"
#include "RunStatistics.h"
#include "RunTimes.h"

namespace dyslam
{
class Pipeline;

/** What a run has collected when its results are computed. */
struct RunData
{
  const Pipeline& pipeline;
  const RunHistory& history;
  const RunStatistics& statistics;
  const RunTimes& times;
};

/** Computes the results of a run, with its report. */
class ResultsBuilder
{
 public:
  /** Loads the options that the results depend on. \param settings outlive the object
   * \throws UserError for bad options. */
  ResultsBuilder(const SlamRunSettings& settings, ConfigLoader& config);

  /** Results after Pipeline::finish(), without waiting times.
   * \param source_warnings warnings about the recording */
  [[nodiscard]] RunResults atEnd(const RunData& run,
                                 const std::vector<std::string>& source_warnings) const;
  /** Results between two frames, while the front end may process later ones: without times,
   * smoothed objects and the warnings of the pipeline; without a map that would take seconds to
   * write. \param method Pipeline::summary() at the last frame, from the front end's thread */
  [[nodiscard]] RunResults soFar(const RunData& run, const std::string& method) const;

 private:
  /** Sets the objects of the graph, and others smoothed with earlier and later scans. */
  void setObjects(const RunData& run, RunResults& results) const;
  /** Sets all of the report that is computed from the other results, but for its method. */
  void fillReport(const RunData& run, RunResults& results) const;

  const SlamRunSettings& settings_;
  MotionSensorOptions motion_sensors_;
  TrackSmoothingOptions track_smoothing_;
  bool has_boxes_;       //!< boxes of another detector are used
  bool complete_boxes_;  //!< boxes are those of visible parts of objects, to be completed
  bool has_labels_;      //!< labels of an earlier run are used
};
}  // namespace dyslam
