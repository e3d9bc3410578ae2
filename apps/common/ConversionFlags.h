// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/formats/PoseOrigin.h>
#include <dyslam/io/RecordingOptions.h>
#include <dyslam/io/ScanRange.h>

#include <CLI/CLI.hpp>
#include <string>

namespace dyslam
{
/** Which scans of a recording a converter takes. */
void declareRange(CLI::App& app, ScanRange& range);

/** The same with a part of these scans. */
void declareRange(CLI::App& app, ScanRange& range, int& every_n);

/** Further lidars of a bag: --further-topic. */
void declareFurtherTopics(CLI::App& app, RecordingOptions& options);

/** Which lidar a recording is of: --sensor and --calibration. */
void declareLidar(CLI::App& app, RecordingOptions& options);

/** The pose of the lidar on the vehicle: --sensor-pose. */
void declareSensorPose(CLI::App& app, std::string& pose);

/** The same, or the frame of the vehicle in a bag: --base-frame. */
void declareMounting(CLI::App& app, RecordingOptions& options);

/** The options of a program that converts an input that is no rawlog by itself. */
void declareConversion(CLI::App& app, RecordingOptions& options);

/** Whether the errors of the true poses are known to be zero. */
void declarePoseSource(CLI::App& app, PoseSource& source, const std::string& what);
}  // namespace dyslam
