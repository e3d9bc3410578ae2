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
  /** Odd number of labels in the centred quadratic whose slope is the true speed. */
  int truth_window = 11;
  /** Names and CSV files of further speeds, with the columns time [s since the first scan] and
   * speed [m/s]. */
  std::vector<std::pair<std::string, std::string>> series;
};

/** Speeds from the detections by several methods, the further ones, and last, named "labels", those
 * from the labels. \throws UserError for files that cannot be read. */
[[nodiscard]] std::vector<NamedSpeeds> kittiSpeeds(const KittiSpeedSources& sources);

struct SpeedReport
{
  Table table;
  std::string json;
};

/** RMSE of each against the last ones. \param speeds as of kittiSpeeds() */
[[nodiscard]] SpeedReport speedReport(const KittiSpeedSources& sources,
                                      const std::vector<NamedSpeeds>& speeds);
}  // namespace dyslam
