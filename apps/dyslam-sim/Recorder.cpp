// SPDX-License-Identifier: BSD-3-Clause
#include "Recorder.h"

#include <dyslam/core/ScanParts.h>
#include <dyslam/formats/GroundTruth.h>
#include <dyslam/io/RawlogWriter.h>
#include <dyslam/sim/Simulator.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <numeric>
#include <optional>
#include <set>
#include <string>
#include <system_error>

#include "GnssReceiver.h"

namespace dyslam::sim
{
namespace
{
/** Sorts the first values; those after them stay. */
template <typename T>
void reorder(std::vector<T>& values, const std::vector<std::size_t>& order)
{
  std::vector<T> sorted;
  sorted.reserve(values.size());
  for (const std::size_t i : order)
  {
    sorted.push_back(values[i]);
  }
  std::move(sorted.begin(), sorted.end(), values.begin());
}

void roundValues(Scan& scan)
{
  for (auto& p : scan.points)
  {
    p = (p * 128).array().round().matrix() / 128;
  }
  for (auto& t : scan.time)
  {
    t = std::round(t * 16384) / 16384;
  }
}

/** Rounds to exactly representable values and sorts the first sensor's points by ring, for better
 * compression. */
void makeCompact(SimulatedScan& s)
{
  roundValues(s.scan);
  std::for_each(s.further.begin(), s.further.end(), roundValues);
  if (s.scan.ring.empty())
  {
    return;
  }
  std::vector<std::size_t> order(s.scan.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return s.scan.ring[a] < s.scan.ring[b]; });
  reorder(s.scan.points, order);
  reorder(s.scan.intensity, order);
  reorder(s.scan.time, order);
  reorder(s.scan.ring, order);
  reorder(s.deskewed, order);
  reorder(s.flow, order);
  reorder(s.label, order);
  reorder(s.moving, order);
}

/** The scan, after the samples since the scan before in order of time. \param fix at the scan's
 * stamp, if any */
void writeScan(const SimulatedScan& scan, const std::optional<GnssFix>& fix, RawlogWriter& rawlog)
{
  auto wheels = scan.wheels.begin();
  for (const ImuSample& imu : scan.imu)
  {
    for (; wheels != scan.wheels.end() && wheels->stamp < imu.stamp; ++wheels)
    {
      rawlog.write(*wheels);
    }
    rawlog.write(imu);
  }
  for (; wheels != scan.wheels.end(); ++wheels)
  {
    rawlog.write(*wheels);
  }
  if (fix)
  {
    rawlog.write(*fix);
  }
  rawlog.write(scan.scan, scan.T_map_vehicle);
  for (const Scan& further : scan.further)
  {
    rawlog.write(further);
  }
}

/** The scan with those of further sensors, as RawlogSource merges them. */
Scan mergedScan(const SimulatedScan& scan)
{
  Scan merged = scan.scan;
  for (std::size_t k = 0; k < scan.further.size(); ++k)
  {
    appendScan(scan.further[k], k + 1, merged);
  }
  return merged;
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

/** Flow from the recorded points, not from the deskewed ones: to the position of the same surface
 * point one period later, in the lidar frame at the next stamp. */
std::vector<Eigen::Vector3f> flowOfRecorded(const SimulatedScan& scan)
{
  std::vector<Eigen::Vector3f> flow(scan.flow.size());
  const Scan merged = mergedScan(scan);
  for (std::size_t i = 0; i < flow.size(); ++i)
  {
    flow[i] = scan.deskewed[i] + scan.flow[i] - merged.points[i];
  }
  return flow;
}

/** Writes the ground truth of a scan. \param ids gets those of the observed objects */
void writeTruth(const SimulatedScan& scan,
                std::size_t number,
                bool with_flow,
                GroundTruthWriter& truth,
                std::set<int>& ids)
{
  truth.addPose(scan.scan.stamp, scan.T_map_vehicle);
  truth.addLabels(number, scan.label);
  if (with_flow)
  {
    truth.addFlow(number, flowOfRecorded(scan));
  }
  for (const SimulatedObject& object : scan.objects)
  {
    if (object.points > 0)
    {
      truth.addBox(labelledBox(object, number));
      ids.insert(object.id);
    }
  }
}

/** A rawlog and its ground truth. Both get their names by close(); without it all that was written
 * is removed, and an earlier recording of the name stays as it is. */
class RecordingOutput
{
 public:
  RecordingOutput(const std::string& path, const RawlogWriterOptions& options)
      : folder_(groundTruthFolder(path)), rawlog_(path, options)
  {
    requireNoLinks(folder_);
    std::filesystem::remove_all(pending());  // of a killed program
    truth_ = std::make_unique<GroundTruthWriter>(pending());
  }
  ~RecordingOutput()
  {
    rawlog_.abandon();
    truth_.reset();
    std::error_code ignored;
    std::filesystem::remove_all(pending(), ignored);
  }
  RecordingOutput(const RecordingOutput&) = delete;
  RecordingOutput& operator=(const RecordingOutput&) = delete;

  [[nodiscard]] const std::string& truthFolder() const { return folder_; }
  RawlogWriter& rawlog() { return rawlog_; }
  GroundTruthWriter& truth() { return *truth_; }
  /** \throws UserError. */
  void close()
  {
    truth_->close();
    rawlog_.finish();
    removeGroundTruth(folder_);
    rawlog_.close();
    installGroundTruth(pending(), folder_);
  }

 private:
  [[nodiscard]] std::string pending() const { return folder_ + ".tmp"; }

  std::string folder_;  //!< folder of the ground truth
  RawlogWriter rawlog_;
  std::unique_ptr<GroundTruthWriter> truth_;  //!< in a temporary folder
};
}  // namespace

RecordingResult record(const Recording& recording,
                       const std::function<void(double, std::size_t)>& progress)
{
  Simulator simulator(recording.simulator, recording.threads);
  RecordingResult result;
  result.loop_length = simulator.loopLength();
  RawlogWriterOptions writing;
  writing.compression_level = recording.compression_level;
  RecordingOutput out(recording.output, writing);
  result.ground_truth = out.truthFolder();
  GnssReceiver receiver(recording.simulator.trafficSeed());
  std::set<int> ids;
  const double period = simulator.sensor().period;
  constexpr double limit = 1e9;  // of scans; seconds may be infinite
  const auto scans =
      static_cast<std::size_t>(std::clamp(std::round(recording.seconds / period), 1.0, limit));
  const std::size_t most = recording.least_distance > 0 ? 3 * scans : scans;
  const double wanted = result.loop_length + 30;
  Eigen::Vector3d last = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < most; ++i)
  {
    SimulatedScan scan = simulator.next();
    if (recording.compact)
    {
      makeCompact(scan);
    }
    const auto fix =
        recording.gnss ? receiver.fixAt(scan.scan.stamp, scan.T_map_vehicle) : std::nullopt;
    writeScan(scan, fix, out.rawlog());
    writeTruth(scan, i, recording.flow, out.truth(), ids);
    result.moving_points += static_cast<std::size_t>(
        std::accumulate(scan.moving.begin(), scan.moving.end(), std::size_t{0}));
    ++result.scans;
    result.points += scan.label.size();
    result.distance += i == 0 ? 0.0 : (scan.T_map_vehicle.translation() - last).norm();
    last = scan.T_map_vehicle.translation();
    if (progress)
    {
      progress(recording.one_loop
                   ? result.distance / wanted
                   : std::min(1.0, static_cast<double>(i + 1) / static_cast<double>(scans)),
               i + 1);
    }
    const bool has_length = i + 1 >= scans && result.distance >= recording.least_distance;
    if (has_length || (recording.one_loop && result.distance > wanted))
    {
      break;
    }
  }
  out.truth().addSimulator(recording.simulator);
  out.close();
  result.objects = ids.size();
  return result;
}
}  // namespace dyslam::sim
