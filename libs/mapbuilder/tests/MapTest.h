// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/formats/ScanFiles.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/mapbuilder/MapRun.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <string>

#include "TestFolder.h"
#include "TestRun.h"

namespace dyslam
{
/** A recording along a straight drive, and what is needed to write its map. */
class MapTest : public testing::Test
{
 protected:
  void SetUp() override
  {
    recording.rawlog = folder.file("r.rawlog");
    recording.trajectory = folder.file("tum.txt");
    recording.scans = test::asRecorded();
    test::writeRecording(recording.rawlog, drive);
    writeTum(recording.trajectory, drive);
    options.threads = 1;
    options.hindsight.hindsight = false;
    outputs.settings.set("map.voxel_size=0.2");
  }
  MapReport build() { return buildMap(recording, options, outputs, listener); }

  TestFolder folder;
  Trajectory drive = test::straightDrive(8, 1);
  RecordingOnTrajectory recording;
  MapBuilderOptions options;
  MapOutputs outputs;
  test::RecordingListener listener;
};

/** Bounds of a map file. */
inline Eigen::AlignedBox3d boundsOf(const std::string& cloud)
{
  Eigen::AlignedBox3d bounds;
  for (const auto& point : readCloud(cloud).points)
  {
    bounds.extend(point.cast<double>());
  }
  return bounds;
}
}  // namespace dyslam
