// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/eval/Table.h>

#include <map>
#include <string>
#include <utility>
#include <vector>

namespace dyslam
{
/** Speeds of one object of KITTI tracking by frame [m/s]. */
using FrameSpeeds = std::map<int, double>;

struct NamedSpeeds
{
  std::string name;
  FrameSpeeds speeds;
};

struct KittiSpeedSources
{
  std::string data;      //!< folder with label_02, oxts, calib and det_pointrcnn
  std::string sequence;  //!< "0008"
  int track = -1;        //!< id of the object in the labels
  /** Number of labels (odd) of the centred quadratic fit whose slope is the true speed. */
  int truth_window = 11;
  /** Names and CSV files of further speeds to compare, with the columns time [s since the first
   * scan] and speed [m/s]. */
  std::vector<std::pair<std::string, std::string>> series;
};

/** Speeds from the detections by several methods, then the speeds of `series`, and last the speeds
 * from the labels, named "labels". \throws UserError for files that cannot be read. */
[[nodiscard]] std::vector<NamedSpeeds> kittiSpeeds(const KittiSpeedSources& sources);

struct SpeedReport
{
  Table table;
  std::string json;
};

/** RMSE of all other speeds against the last entry (labels). \param speeds result of kittiSpeeds()
 */
[[nodiscard]] SpeedReport speedReport(const KittiSpeedSources& sources,
                                      const std::vector<NamedSpeeds>& speeds);
}  // namespace dyslam
