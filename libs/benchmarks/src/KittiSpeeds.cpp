// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/benchmarks/JsonText.h>
#include <dyslam/benchmarks/KittiSpeeds.h>
#include <dyslam/benchmarks/KittiTracking.h>
#include <dyslam/formats/TextFile.h>

#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>

namespace dyslam
{
namespace
{
/** Speed at each frame by a quadratic fitted to the `window` positions around it; frames in gaps
 * are left out. A fit is needed because positions by OXTS jump by up to 0.1 m from frame to frame.
 */
FrameSpeeds centredSpeeds(const PlanarTrack& track, int window)
{
  FrameSpeeds speeds;
  for (const auto& [frame, position] : track)
  {
    PolynomialOptions options;
    options.degree = 2;
    options.window = window;
    PolynomialTrajectory fit(options);
    const int half = window / 2;
    for (auto at = track.lower_bound(frame - half); at != track.end() && at->first <= frame + half;
         ++at)
    {
      fit.add({at->first * kitti_scan_period, at->second});
    }
    if (static_cast<int>(fit.size()) == window)
    {
      speeds[frame] = fit.predict(frame * kitti_scan_period).velocity.norm();
    }
  }
  return speeds;
}

/** Distance to the previous position over the time between. */
FrameSpeeds rawSpeeds(const PlanarTrack& track)
{
  FrameSpeeds speeds;
  for (auto at = track.begin(); at != track.end(); ++at)
  {
    if (at != track.begin())
    {
      const auto before = std::prev(at);
      speeds[at->first] =
          (at->second - before->second).norm() / ((at->first - before->first) * kitti_scan_period);
    }
  }
  return speeds;
}

/** Speed of a causal motion model after each observation. */
template <typename Model>
FrameSpeeds causalSpeeds(const PlanarTrack& track, Model model)
{
  FrameSpeeds speeds;
  for (const auto& [frame, position] : track)
  {
    model.add({frame * kitti_scan_period, position});
    const MotionPrediction now = model.predict(frame * kitti_scan_period);
    if (now.samples > 2)
    {
      speeds[frame] = now.velocity.norm();
    }
  }
  return speeds;
}

/** Reads a CSV file with a header and the columns time [s since the first scan] and speed [m/s]. */
FrameSpeeds readSpeeds(const std::string& path)
{
  TextFile file(path, ",\r");
  if (!file.next() || file.fields().size() != 2 || file.fields()[0] != "time" ||
      file.fields()[1] != "speed")
  {
    throw UserError(path + ": the first line must be time,speed");
  }
  FrameSpeeds speeds;
  while (file.next())
  {
    file.requireFields(2, "time,speed");
    speeds[static_cast<int>(std::lround(file.number(0) / kitti_scan_period))] = file.number(1);
  }
  return speeds;
}

struct SpeedError
{
  double rmse = 0;  //!< RMSE of the speed [m/s]; NaN without a frame
  int frames = 0;   //!< number of frames with both speeds
};

SpeedError speedError(const FrameSpeeds& speeds, const FrameSpeeds& truth)
{
  double sum = 0;
  int count = 0;
  for (const auto& [frame, speed] : speeds)
  {
    if (const auto at = truth.find(frame); at != truth.end())
    {
      sum += (speed - at->second) * (speed - at->second);
      ++count;
    }
  }
  return {count > 0 ? std::sqrt(sum / count) : std::nan(""), count};
}
}  // namespace

std::vector<NamedSpeeds> kittiSpeeds(const KittiSpeedSources& sources)
{
  const std::string file = "/" + sources.sequence + ".txt";
  const auto target = [&](const std::string& detections)
  {
    return readKittiTarget(sources.data + "/label_02" + file, sources.data + "/oxts" + file,
                           sources.data + "/calib" + file, sources.track, detections);
  };
  const FrameSpeeds truth = centredSpeeds(target("").truth, sources.truth_window);
  const PlanarTrack observations = target(sources.data + "/det_pointrcnn/Car" + file).observations;
  PolynomialOptions quadratic;  // the paper's degree and window
  std::vector<NamedSpeeds> all{
      {"raw differences", rawSpeeds(observations)},
      {"causal quadratic, 30 detections",
       causalSpeeds(observations, PolynomialTrajectory(quadratic))},
      {"causal, adaptive", causalSpeeds(observations, AdaptivePredictor())}};
  for (const auto& [name, path] : sources.series)
  {
    all.push_back({name, readSpeeds(path)});
  }
  all.push_back({"labels", truth});
  return all;
}

SpeedReport speedReport(const KittiSpeedSources& sources, const std::vector<NamedSpeeds>& speeds)
{
  Table table({"speed from", "RMSE [m/s]", "frames"},
              "sequence " + sources.sequence + ", track " + std::to_string(sources.track));
  nlohmann::ordered_json json;
  const FrameSpeeds& truth = speeds.back().speeds;
  for (std::size_t i = 0; i + 1 < speeds.size(); ++i)
  {
    const SpeedError error = speedError(speeds[i].speeds, truth);
    table.addRow({speeds[i].name, TableCell(error.rmse, 3), TableCell(error.frames, 0)});
    json[speeds[i].name] = error.rmse;
  }
  return {table, textOf(json)};
}
}  // namespace dyslam
