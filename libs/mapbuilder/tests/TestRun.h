// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/FactorGraphFile.h>
#include <dyslam/backend/factors/OdometryFactor.h>
#include <dyslam/formats/MotionFiles.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/mapbuilder/RunFolder.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "TestRecording.h"

namespace dyslam::test
{
/** A list of runs, which cannot be copied. */
template <typename... Runs>
std::vector<RunFolder> listOf(Runs&&... runs)
{
  std::vector<RunFolder> list;
  (list.push_back(std::forward<Runs>(runs)), ...);
  return list;
}

/** Graph of a run whose every `every`-th scan is a keyframe. */
inline FactorGraph graphOf(const Trajectory& trajectory, std::size_t every)
{
  FactorGraph graph;
  for (std::size_t i = 0; i < trajectory.size(); i += every)
  {
    const std::size_t k = i / every;
    graph.addPose(Key::ego(k), trajectory[i].pose);
    if (k > 0)
    {
      graph.add(std::make_unique<OdometryFactor>(
          k - 1, k, trajectory[i - every].pose.inverse() * trajectory[i].pose,
          1e4 * Matrix6::Identity()));
    }
  }
  return graph;
}

/** The output folder of a run along a trajectory, as far as it is read for merging. */
inline void writeRunFolder(const std::string& folder,
                           const std::string& rawlog,
                           const Trajectory& trajectory,
                           std::size_t every)
{
  namespace fs = std::filesystem;
  fs::create_directories(folder);
  writeTum(folder + "/trajectory_tum.txt", trajectory);
  writeFactorGraph(graphOf(trajectory, every), folder + "/factor_graph.txt");
  std::ofstream motions(folder + "/motions.csv");
  motions << motionFileHeader();
  for (std::size_t i = 0; i < trajectory.size(); ++i)
  {
    MotionCovariance motion;
    motion.stamp = trajectory[i].stamp;
    motion.is_keyframe = i % every == 0;
    motions << motionFileRow(motion);
  }
  std::ofstream(folder + "/report.json") << "{\"input\": \"" << rawlog << "\"}\n";
  std::ofstream(folder + "/effective.ini")
      << "[input]\nskip_first_n = 0\n[preprocess]\ndeskew = none\n";
}
}  // namespace dyslam::test
