// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Options.h>
#include <dyslam/nets/BevScan.h>
#include <dyslam/nets/DysegOptions.h>
#include <dyslam/train/DysegData.h>
#include <dyslam/train/DysegLossOptions.h>
#include <dyslam/train/LabelledRun.h>
#include <dyslam/train/LearningRate.h>

#include <string>

namespace dyslam
{
/** Ini section `[train]` of DySeg's training. */
struct DysegTrainerOptions : Options
{
  std::string data;               //!< folder with the real data; empty: simulated data only
  std::string splits = "splits";  //!< file of the training, validation and test frames
  std::string boxed_run = "vls128_run88";  //!< training run with boxes, under `data`; empty: none
  int boxed_last = 47;                     //!< last training frame of `boxed_run`
  BoxedRunOptions boxed;                   //!< of all runs with boxes
  /** Training runs with labels per point, in the format of parseRecording() with paths relative to
   * `data`, separated by '|'. With any, a run is drawn by its number of scans, else all runs are
   * drawn equally often. */
  std::string labelled_runs;
  double labelled_period = hdl64e_period;  //!< time between scans of all runs with labels [s]
  /** Frames of a run with boxes and of a run with labels that are evaluated and never trained on.
   * They are compared with up to 8 frames before, which may be trained on. Empty: none. */
  std::string boxed_validation = "vls128_run88";
  int boxed_validation_first = 48;
  int boxed_validation_last = 63;
  std::string labelled_validation = "kitti_raw_2011_09_26_drive_0005";
  std::string labelled_poses = "poses_icp_raw_velo.txt";  //!< file in that run's folder
  std::string labelled_calib;  //!< KITTI's calib.txt in that folder for poses of a camera, or empty
  bool labelled_deskew = false;  //!< deskew those scans, as `deskew` of labelled_runs
  int labelled_validation_first = 80;
  int labelled_validation_last = 109;
  double validation_min_range = 1.5;  //!< nearer returns of these frames are left out, as those of
                                      //!< the own vehicle are in the application [m]
  std::string single_scans = "hdl64_singles_sceneflow,hdl64_singles_object/velodyne";
  double simulated_share = 0.5;  //!< share of simulated pairs, if there are real data
  double single_share = 0.3;     //!< share of real pairs from single scans
  double same_scan_share = 0.1;  //!< share of the pairs of runs and clips that are doubleScan()s
  int gap = 8;                   //!< distance of the scans that the application compares [scans]
  double gap_share = 0;  //!< share of the pairs of runs and clips `gap` apart; others: 1 to 10
  double campus_share = 0.25;      //!< share of simulated clips on a campus
  double highway_share = 0.2;      //!< share on a highway of the clips that are not on a campus;
                                   //!< the others are on streets
  double downtown_share = 0;       //!< share in a dense city centre of those on neither
  double few_beams_share = 0.2;    //!< share of simulated clips with 16 beams
  double other_sensors_share = 0;  //!< share of the other clips with one of `other_sensors` instead
                                   //!< of an HDL-64E
  std::string other_sensors = "OS1-64, OS1-128, PANDAR64";  //!< names as in sim::sensorNames()
  int simulated_pool = 80;  //!< number of clips kept; the oldest is replaced
  int simulate_every = 16;  //!< steps between new clips
  int crop = 256;           //!< cells along each side in training
  double crop_reach = 26;   //!< largest distance of a crop's centre, in x and in y [m]
  int steps = 100000;
  /** Largest batch. It determines the random draws of a pair: number of the pair = step * max_batch
   * + index in the batch. */
  static constexpr int max_batch = 64;
  int batch = 2;  //!< pairs in a step
  LearningRateOptions rate;
  double ema_decay = 0.998;  //!< decay of the exponential moving average of the weights
  double weight_decay = 1e-4;
  int checkpoint_every = 100;  //!< steps between checkpoints
  int validate_every = 1500;   //!< steps between validations; 0: none
  int threads = 1;             //!< pairs computed at a time
  int seed = 1;

  void describe(OptionsVisitor& visitor) override;
};

struct DysegTrainerSetup
{
  DysegTrainerOptions train;
  DysegNetworkOptions network;
  BevOptions grid;
  DysegAugmentOptions augmentation;
  DysegLossOptions loss;
  std::string device = "cpu";  //!< cpu or cuda; the data are prepared on the CPU

  /** Loads the options. \return the effective config \throws UserError. */
  Config load(const Config& config);
};
}  // namespace dyslam
