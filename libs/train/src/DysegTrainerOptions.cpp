// SPDX-License-Identifier: BSD-3-Clause
#include "DysegTrainerOptions.h"

#include <dyslam/train/TrainDyseg.h>

namespace dyslam
{
void DysegTrainerOptions::describe(OptionsVisitor& v)
{
  v.text("data", data, "folder with the real data; empty: simulated data only");
  v.text("splits", splits,
         "splits of the frames (training, validation, test): a file, or the name of a shipped one");
  v.text("boxed_run", boxed_run,
         "training run with boxes, a folder under data or an absolute path; empty: none");
  v.integer("boxed_last", boxed_last, 1, 1000000, "last training frame of boxed_run");
  v.degrees("boxed_start_azimuth_deg", boxed.drift.start_azimuth, -360, 360,
            "azimuth at which scan 0 of the runs with boxes begins and ends, from +x towards +y "
            "[deg]");
  v.degrees("boxed_azimuth_step_deg", boxed.drift.step, -180, 0,
            "drift of that azimuth per scan; 0: none, the scans are not deskewed [deg]");
  v.real("boxed_revolution", boxed.revolution, 0.001, 10,
         "time of a revolution of the sensor of the runs with boxes [s]");
  v.integer("boxed_standing_first", boxed.standing_first, -1, 2000000000,
            "first id of the objects of runs with boxes that are known to stand; their boxes are "
            "not used");
  v.integer("boxed_standing_last", boxed.standing_last, -1, 2000000000,
            "last id of those objects; below boxed_standing_first: none");
  v.text("labelled_runs", labelled_runs,
         "training runs with point labels, folder;poses;first;last[;deskew][;labels=folder]"
         "[;calib=calib.txt] each under data, separated by |; empty: none");
  v.real("labelled_period", labelled_period, 0.001, 10,
         "time between the scans of runs with point labels [s]");
  v.text("boxed_validation", boxed_validation,
         "validation run with boxes, a folder under data or an absolute path; empty: none");
  v.integer("boxed_validation_first", boxed_validation_first, 8, 1000000,
            "first frame of boxed_validation that is evaluated");
  v.integer("boxed_validation_last", boxed_validation_last, 8, 1000000,
            "last frame of boxed_validation that is evaluated");
  v.text("labelled_validation", labelled_validation,
         "validation run with point labels, a folder under data or an absolute path; empty: none");
  v.text("labelled_poses", labelled_poses,
         "name of the pose file in the folder of labelled_validation");
  v.text("labelled_calib", labelled_calib,
         "name of KITTI's calib.txt in that folder if its poses are of the camera; empty: of the "
         "lidar");
  v.flag("labelled_deskew", labelled_deskew,
         "deskew the scans of labelled_validation by azimuth, as deskew of labelled_runs");
  v.integer("labelled_validation_first", labelled_validation_first, 1, 1000000,
            "first frame of labelled_validation that is evaluated");
  v.integer("labelled_validation_last", labelled_validation_last, 1, 1000000,
            "last frame of labelled_validation that is evaluated");
  v.real(
      "validation_min_range", validation_min_range, 0, 10,
      "returns below this range are left out of both, as the application leaves out those of the "
      "own vehicle [m]");
  v.text("single_scans", single_scans,
         "folders of single scans under data or absolute, separated by commas");
  v.real("simulated_share", simulated_share, 0, 1, "share of pairs that are simulated");
  v.real("single_share", single_share, 0, 1, "share of real pairs that are made from single scans");
  v.real("same_scan_share", same_scan_share, 0, 1,
         "share of pairs of runs and clips that are made from one scan");
  v.integer("gap", gap, 1, 10, "gap between the scans that the application compares [scans]");
  v.real("gap_share", gap_share, 0, 1,
         "share of pairs of runs and clips that are gap scans apart; the others are 1 to 10");
  v.real("campus_share", campus_share, 0, 1,
         "share of simulated clips that are on a campus (many pedestrians)");
  v.real("highway_share", highway_share, 0, 1,
         "share of simulated clips that are on a highway, of those that are not on a campus");
  v.real("downtown_share", downtown_share, 0, 1,
         "share of simulated clips that are in a dense city centre, of those that are neither on a "
         "campus nor on a highway");
  v.real("few_beams_share", few_beams_share, 0, 1,
         "share of simulated clips that are scanned with 16 beams");
  v.real(
      "other_sensors_share", other_sensors_share, 0, 1,
      "share of simulated clips with more than 16 beams that are scanned with other_sensors; the "
      "others are with an HDL-64E");
  v.text("other_sensors", other_sensors,
         "lidars of the simulator, separated by commas, each as often as the others");
  v.integer("simulated_pool", simulated_pool, 1, 100000,
            "number of simulated clips kept in memory");
  v.integer("simulate_every", simulate_every, 1, 100000, "steps between new simulated clips");
  v.integer("crop", crop, 64, 2048,
            "cells along each side of the grid in training, a multiple of 16");
  requireMultipleOf16("[train] crop", crop);
  v.real("crop_reach", crop_reach, 0, 1000,
         "largest distance of the centre of a crop from the sensor, in x and in y [m]");
  v.integer("steps", steps, 1, 100000000, "number of optimiser steps");
  v.integer("batch", batch, 1, max_batch, "number of pairs per step");
  rate.describe(v);
  v.real("ema_decay", ema_decay, 0, 1,
         "decay per step of the exponential moving average of the weights, which is saved");
  v.real("weight_decay", weight_decay, 0, 1, "weight decay of AdamW");
  v.integer("checkpoint_every", checkpoint_every, 1, 1000000, "steps between checkpoints");
  v.integer("validate_every", validate_every, 0, 1000000,
            "steps between validations; 0: no validation");
  v.integer("threads", threads, 1, 256,
            "pairs computed at a time, each in a thread; in validation, threads of the network");
  v.integer("seed", seed, 0, 2000000000, "random seed of weights and data");
}

Config DysegTrainerSetup::load(const Config& config)
{
  return loadAll(config,
                 [this](ConfigLoader& loader)
                 {
                   train = loader.get<DysegTrainerOptions>("train");
                   network = loader.get<DysegNetworkOptions>("network");
                   grid = loader.get<BevOptions>("grid");
                   augmentation = loader.get<DysegAugmentOptions>("augmentation");
                   loss = loader.get<DysegLossOptions>("loss");
                 });
}

Config dysegTrainDefaults()
{
  return DysegTrainerSetup().load(Config());
}
}  // namespace dyslam
