// SPDX-License-Identifier: BSD-3-Clause
#include "Recorder.h"

#include <dyslam/io/GroundTruth.h>
#include <dyslam/io/RawlogWriter.h>
#include <dyslam/sim/Simulator.h>

#include <cmath>
#include <set>

namespace dyslam::sim
{
namespace
{
/** A grid that floats hold exactly leaves zeros for gzip. */
void roundPoints(std::vector<Eigen::Vector3f>& points)
{
  for (auto& p : points)
  {
    p = (p * 256).array().round().matrix() / 256;
  }
}

LabelledBox labelledBox(const SimulatedObject& object, std::size_t frame)
{
  LabelledBox box;
  box.frame = static_cast<int>(frame);
  box.id = object.id;
  box.object_class = object.object_class;
  box.type = toString(object.object_class);
  box.box = object.box_seen;
  return box;
}
}  // namespace

RecordingResult record(const Recording& recording,
                       const std::function<void(double, std::size_t)>& progress)
{
  Simulator simulator(recording.simulator, recording.threads);
  RecordingResult result;
  result.loop_length = simulator.loopLength();
  result.ground_truth = groundTruthFolder(recording.output);
  RawlogWriter rawlog(recording.output);
  GroundTruthWriter truth(result.ground_truth);
  std::set<int> ids;
  const double period = simulator.sensor().period;
  const auto scans = static_cast<std::size_t>(std::llround(recording.seconds / period));
  const double wanted = result.loop_length + 30;
  Eigen::Vector3d last = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < scans; ++i)
  {
    SimulatedScan scan = simulator.next();
    // Flow as the sidecar has it starts at the recorded point.
    std::vector<Eigen::Vector3f> flow(scan.flow.size());
    if (recording.compact)
    {
      roundPoints(scan.scan.points);
    }
    for (std::size_t k = 0; k < flow.size(); ++k)
    {
      flow[k] = scan.deskewed[k] + scan.flow[k] - scan.scan.points[k];
      result.moving_points += scan.moving[k];
    }
    rawlog.write(scan.scan, scan.T_map_vehicle);
    truth.addPose(scan.scan.stamp, scan.T_map_vehicle);
    truth.addLabels(i, scan.label);
    if (recording.flow)
    {
      truth.addFlow(i, flow);
    }
    for (const auto& object : scan.objects)
    {
      if (object.points > 0)
      {
        truth.addBox(labelledBox(object, i));
        ids.insert(object.id);
      }
    }
    ++result.scans;
    result.points += scan.scan.size();
    result.distance += i == 0 ? 0.0 : (scan.T_map_vehicle.translation() - last).norm();
    last = scan.T_map_vehicle.translation();
    if (progress)
    {
      progress(recording.one_loop ? result.distance / wanted
                                  : static_cast<double>(i + 1) / static_cast<double>(scans),
               i + 1);
    }
    if (recording.one_loop && result.distance > wanted)
    {
      break;
    }
  }
  rawlog.close();
  truth.close();
  result.objects = ids.size();
  return result;
}
}  // namespace dyslam::sim
