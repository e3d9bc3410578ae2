// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Gravity.h>
#include <dyslam/core/PriorMapFit.h>
#include <dyslam/formats/PoseOrigin.h>

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
/** Fit of a run's satellite positions to its trajectory. */
struct GnssFit
{
  std::size_t positions = 0;   //!< number of positions used
  double horizontal_rmse = 0;  //!< horizontal RMSE of positions against the trajectory [m]
  double vertical_rmse = 0;    //!< vertical RMSE of positions against the trajectory [m]
  bool fused = false;          //!< the graph was optimised with the positions
};

/** The content of a run's `report.json`; doc/formats.md explains its keys.
 *
 * What the file does not state, as that of an earlier version, is nothing or empty here, and is not
 * written if it is nothing. */
struct RunReport
{
  std::string input;                       //!< path of the recording, see recordingOfRun()
  std::string sensor;                      //!< what the first scans show of the sensor
  std::optional<PoseOrigin> ground_truth;  //!< nothing if the recording has no true poses
  std::string method;                      //!< stages in use
  bool finished = true;     //!< whether all scans were processed; true where it is not stated
  std::string ended_early;  //!< why the run ended before the last scan; empty if it did not
  std::optional<std::size_t> frames;           //!< number of scans
  std::optional<std::size_t> unconverged;      //!< number of scans with a predicted motion
  std::optional<std::size_t> odometry_failed;  //!< number of scans without motion of the matcher
  std::optional<std::size_t> keyframes;
  std::optional<std::size_t> loops;           //!< number of loops in use
  std::optional<std::size_t> loops_left_out;  //!< number of loops that contradict the graph
  std::optional<GnssFit> gnss;
  std::optional<Gravity> gravity;
  std::optional<PriorMapFit> prior_map;  //!< nothing without a prior map; `keyframe` is not stated
  std::optional<std::size_t> tracks;     //!< number of confirmed moving objects
  std::optional<std::size_t> map_points;
  std::optional<double> path_length;        //!< length of the trajectory [m]
  std::optional<double> ms_per_scan;        //!< mean time of all stages [ms]; 0: no scan was timed
  std::map<std::string, double> stage_ms;   //!< mean time of each stage per scan [ms]
  std::map<std::string, double> wait_ms;    //!< mean waiting time of each thread per scan [ms]
  std::map<std::string, double> memory_mb;  //!< by part, at the end; in steps of 0.1 MB
  std::optional<double> recording_time;     //!< duration of the processed part [s]
  std::optional<double> run_time;           //!< from the start of the run to its last file [s]
  std::optional<double> realtime_factor;    //!< recording_time over run_time; 0: unknown
  std::string verdict;                      //!< usable, doubtful or unusable
  std::string failure;                      //!< why the result is unusable; empty if it is usable
  std::vector<std::string> warnings;
  std::vector<std::string> not_written;  //!< reasons why files could not be written
  std::vector<std::string> files;        //!< names of the files written, report.json the last
};

/** The text of report.json. Numbers have nine significant digits, more than the accuracy of any
 * figure. */
[[nodiscard]] std::string runReportText(const RunReport& report);

/** Reads the text of report.json. \param path of the file, for messages
 * \throws UserError "file: what is wrong; what to do" if it is no JSON object, or if a field is of
 * another type. A field that is null, as numbers that are not finite are written, counts as
 * missing. */
[[nodiscard]] RunReport parseRunReport(const std::string& text, const std::string& path);

/** Reads report.json of a run's folder; nothing if there is none, since the run did not finish.
 * \throws UserError as parseRunReport(), and if the file cannot be read. */
[[nodiscard]] std::optional<RunReport> readRunReport(const std::string& folder);

/** The same for those who can do without: an empty report if there is none or it is damaged. */
[[nodiscard]] RunReport runReportIfValid(const std::string& folder);

/** Path of the recording of a run, see recordingOfRun(). \param folder of the run
 * \throws UserError if the report does not name the recording. */
[[nodiscard]] std::string recordingOf(const RunReport& report, const std::string& folder);

/** Replaces `input` in report.json of a folder; all other bytes stay as they are, also where they
 * are of another version. \throws UserError if there is no valid report. */
void replaceInput(const std::string& folder, const std::string& input);
}  // namespace dyslam
