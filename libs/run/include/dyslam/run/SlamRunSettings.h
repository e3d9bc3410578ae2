// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Config.h>

#include <functional>
#include <string>
#include <vector>

namespace dyslam
{
struct Frame;
class Levelling;

/** Settings of one run that are not in the config. */
struct SlamRunSettings
{
  std::string rawlog;         //!< path of the input
  std::string output_folder;  //!< created if missing; files of an earlier run are replaced
  Config config;
  std::string ini;     //!< path of the ini that was given, which is never replaced; empty: none
  std::string sensor;  //!< description of the sensor, for the report
  std::vector<std::string> warnings;  //!< on conversion and settings, for the report
  bool force = false;                 //!< replace also files that no run wrote
  bool probabilities = false;         //!< write the moving probability of each point, .bin files
  bool static_scans = false;   //!< write the scans without moving points: .bin files and a rawlog
  bool labels = false;         //!< write labels/NNNNNN.label, one entry per point of the input scan
  std::string profile_csv;     //!< times of every stage, if not empty
  double first_pass_time = 0;  //!< time of an earlier pass, part of the run's time [s]
  /** Receives every frame of the causal pipeline after its last stage, in order; called from the
   * thread of the run, which waits for it. */
  std::function<void(const Frame&)> show;
  /** Receives the levelling of these frames, before the first one. */
  std::function<void(const Levelling&)> levelled;
  /** Called before the output folder is opened (true: the folder is not changed) and after every
   * scan (true: the run ends after the few scans that are being processed). */
  std::function<bool()> stop;
  /** Receives warnings immediately that the report has, too, and which outputs have failed; called
   * from any thread. */
  std::function<void(const std::string&)> warn;
  /** Called after the last scan, in the thread of the run: returns warnings about the recording
   * that are known only then, for the report. */
  std::function<std::vector<std::string>()> end_of_scans;
  /** Receives what the run does after the last scan, which may take a while, such as "writing the
   * results"; called from the thread of the run. */
  std::function<void(const std::string&)> after_scans;
};
}  // namespace dyslam
