// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/formats/PoseOrigin.h>
#include <dyslam/io/Conversion.h>
#include <dyslam/io/RecordingOptions.h>

#include <CLI/CLI.hpp>
#include <string>

namespace dyslam
{
/** Those of declareRange() with --every and --external-storage, for a converter to rawlogs. */
void declareRawlog(CLI::App& app, ConversionOptions& options);

/** Flag of further lidars of a bag: --further-topic. */
void declareFurtherTopics(CLI::App& app, RecordingOptions& options);

/** Flags of the lidar of a recording: --sensor and --calibration. */
void declareLidar(CLI::App& app, RecordingOptions& options);

/** Flag of the IMU in the lidar of a capture: --imu. */
void declareImu(CLI::App& app, RecordingOptions& options);

/** Flags of the files in a folder of scans: --bin-layout and --scale. */
void declareClouds(CLI::App& app, RecordingOptions& options);

/** Flag of the scans of KITTI: --deskewed. */
void declareDeskewed(CLI::App& app, ScansDeskewed& deskewed);

/** Flag of the elevation of KITTI's scans: --kitti-vertical-angle-correction. */
void declareVerticalAngles(CLI::App& app, bool& correct);

/** Flag of the pose of the lidar on the vehicle: --sensor-pose. */
void declareSensorPose(CLI::App& app, std::string& pose);

/** --sensor-pose, or the frame of the vehicle in a bag: --base-frame. */
void declareMounting(CLI::App& app, RecordingOptions& options);

/** Flags of a program that converts an input that is no rawlog by itself. */
void declareConversion(CLI::App& app, RecordingOptions& options);

/** Whether the errors of the true poses are known to be zero. */
void declarePoseSource(CLI::App& app, PoseSource& source, const std::string& what);
}  // namespace dyslam
