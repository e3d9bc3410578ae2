// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/benchmarks/KittiSlam.h>
#include <dyslam/eval/Table.h>
#include <dyslam/eval/TrajectoryMetrics.h>

#include <string>
#include <vector>

namespace dyslam
{
/** What is evaluated: the factor graph of ego and objects on KITTI tracking, with given detections
 * and odometries that are drawn, or the visual one of the data. */
struct KittiSlamSetup
{
  std::string data;      //!< folder with label_02, oxts, calib, orbslam3_cam0, det_<detector>
  std::string detector;  //!< as readKittiDrive()
  double min_score = 0;  //!< of detections
  std::vector<std::string> sequences;
  std::vector<std::string> odometries;  //!< drawn: "poor", "middle", "good"; "visual"
  /** Of the backend: "odometry", "ego", "segmot", "full"; ratios are to the first. */
  std::vector<std::string> modes;
  int seeds = 10;  //!< drawn odometries per sequence
  Alignment alignment = Alignment::se3;
  std::string speeds;  //!< folder for the speeds of vehicles; empty: not written
  TrackerOptions tracker;
  DetectionNoiseOptions noise;
  BackendConfig backend;  //!< the mode is that of `modes`
};

struct KittiSlamReport
{
  Table table;    //!< errors of the ego-motion, with the paper's Table 6
  Table objects;  //!< errors of the vehicles; without rows if no mode estimates them
  std::string json;
};

/** \throws UserError for files that cannot be read or written. */
[[nodiscard]] KittiSlamReport evaluateKittiSlam(const KittiSlamSetup& setup);

/** Sequences of the paper's Table 6. */
[[nodiscard]] std::vector<std::string> kittiSlamPaperSequences();
}  // namespace dyslam
