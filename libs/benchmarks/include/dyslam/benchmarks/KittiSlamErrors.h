// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/benchmarks/KittiSlam.h>
#include <dyslam/eval/Table.h>
#include <dyslam/eval/TrajectoryMetrics.h>

#include <string>
#include <vector>

namespace dyslam
{
/** Setup of the evaluation of the factor graph of ego and objects on KITTI tracking, with given
 * detections and either randomly drawn odometries or the visual odometry in the data. */
struct KittiSlamSetup
{
  std::string data;      //!< folder with label_02, oxts, calib, orbslam3_cam0, det_<detector>
  std::string detector;  //!< as readKittiDrive()
  double min_score = 0;  //!< least score of detections
  std::vector<std::string> sequences;
  std::vector<std::string> odometries;  //!< "poor", "middle", "good" (drawn), or "visual"
  /** Modes of the backend: "odometry", "ego", "segmot", "full"; ratios are relative to the first.
   */
  std::vector<std::string> modes;
  int seeds = 10;  //!< number of drawn odometries per sequence
  Alignment alignment = Alignment::se3;
  std::string speeds;  //!< folder for the speeds of vehicles; empty: not written
  TrackerOptions tracker;
  DetectionNoiseOptions noise;
  BackendConfig backend;  //!< its mode is replaced by each of `modes`
};

struct KittiSlamReport
{
  Table table;    //!< errors of the ego-motion, next to the paper's Table 6
  Table objects;  //!< errors of the vehicles; without rows if no mode estimates them
  std::string json;
};

/** Runs and evaluates all sequences, odometries and modes. \throws UserError for files that cannot
 * be read or written. */
[[nodiscard]] KittiSlamReport evaluateKittiSlam(const KittiSlamSetup& setup);

/** Sequences of the paper's Table 6. */
[[nodiscard]] std::vector<std::string> kittiSlamPaperSequences();
}  // namespace dyslam
