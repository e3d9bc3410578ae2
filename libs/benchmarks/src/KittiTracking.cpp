// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/benchmarks/KittiTracking.h>
#include <dyslam/core/BoxOverlap.h>
#include <dyslam/formats/KittiTracks.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace dyslam
{
namespace
{
// Rounded time between scans [s]: positions predicted by a fit do not depend on it.
constexpr double frame_time = 0.1;

Eigen::Vector2d inWorld(const LabelledBox& box, const std::vector<Pose>& poses)
{
  return (poses[static_cast<std::size_t>(box.frame)] * box.box.centre).head<2>();
}

class PolynomialOneStep : public OneStepPredictor
{
 public:
  explicit PolynomialOneStep(const PolynomialOptions& options) : trajectory_(options) {}
  void observe(int frame, const Eigen::Vector2d& position) override
  {
    trajectory_.add({frame * frame_time, position});
  }
  std::optional<Eigen::Vector2d> predict(int frame) const override
  {
    const MotionPrediction p = trajectory_.predict(frame * frame_time);
    return trajectory_.full() ? std::optional<Eigen::Vector2d>(p.position) : std::nullopt;
  }

 private:
  PolynomialTrajectory trajectory_;
};

class AdaptiveOneStep : public OneStepPredictor
{
 public:
  explicit AdaptiveOneStep(const AdaptiveOptions& options) : predictor_(options) {}
  void observe(int frame, const Eigen::Vector2d& position) override
  {
    predictor_.add({frame * frame_time, position});
  }
  std::optional<Eigen::Vector2d> predict(int frame) const override
  {
    const MotionPrediction p = predictor_.predict(frame * frame_time);
    return p.valid ? std::optional<Eigen::Vector2d>(p.position) : std::nullopt;
  }

 private:
  AdaptivePredictor predictor_;
};

}  // namespace

std::vector<Pose> kittiLidarPoses(const std::string& oxts, const KittiCalib& calib)
{
  const std::vector<OxtsReading> readings = readOxts(oxts);
  std::vector<Pose> poses = oxtsPoses(readings);
  if (poses.empty())
  {
    throw UserError(oxts + ": has no readings");
  }
  const OxtsReading& first = readings.front();
  const Pose level = poseFromYpr(0, 0, 0, first.yaw, first.pitch, first.roll);
  const Pose T_imu_velo = calib.T_velo_imu.inverse();
  for (Pose& pose : poses)
  {
    pose = level * pose * T_imu_velo;
  }
  return poses;
}

KittiTarget readKittiTarget(const std::string& boxes,
                            const std::string& oxts,
                            const std::string& calib,
                            int track,
                            const std::string& detections)
{
  constexpr double max_distance = 2;  // largest distance of a detection from the label [m]
  const KittiCalib mounting = readKittiCalib(calib);
  const std::vector<Pose> poses = kittiLidarPoses(oxts, mounting);
  const auto known = [&](const LabelledBox& box)
  { return box.frame >= 0 && static_cast<std::size_t>(box.frame) < poses.size(); };
  KittiTarget target;
  std::map<int, Eigen::Vector2d> label_at;
  for (const LabelledBox& box : readKittiTracking(boxes, mounting.T_cam_velo))
  {
    if (box.id == track && known(box))
    {
      label_at[box.frame] = box.box.centre.head<2>();
      target.truth[box.frame] = inWorld(box, poses);
    }
  }
  if (target.truth.empty())
  {
    throw UserError(boxes + ": has no boxes of track " + std::to_string(track));
  }
  if (detections.empty())
  {
    target.observations = target.truth;
    return target;
  }
  std::map<int, double> nearest;
  for (const LabelledBox& box : readDetections(detections, mounting.T_cam_velo))
  {
    const auto label = label_at.find(box.frame);
    if (box.score < 0 || !known(box) || label == label_at.end())
    {
      continue;
    }
    const double distance = (box.box.centre.head<2>() - label->second).norm();
    const auto best = nearest.find(box.frame);
    if (distance < max_distance && (best == nearest.end() || distance < best->second))
    {
      nearest[box.frame] = distance;
      target.observations[box.frame] = inWorld(box, poses);
    }
  }
  return target;
}

std::vector<KittiTarget> readPaperTargets(const std::string& folder, bool from_detections)
{
  constexpr std::pair<const char*, int> targets[] = {{"0004", 2}, {"0008", 8}, {"0008", 13},
                                                     {"0010", 0}, {"0018", 2}, {"0018", 3}};
  std::vector<KittiTarget> result;
  for (const auto& [sequence, track] : targets)
  {
    const std::string file = std::string(sequence) + ".txt";
    result.push_back(readKittiTarget(folder + "/label_02/" + file, folder + "/oxts/" + file,
                                     folder + "/calib/" + file, track,
                                     from_detections ? folder + "/det_pointrcnn/Car/" + file : ""));
    result.back().name = std::string(sequence).substr(2) + "/" + std::to_string(track);
  }
  return result;
}

std::unique_ptr<OneStepPredictor> polynomialPredictor(int degree, int window)
{
  PolynomialOptions options;
  options.degree = degree;
  options.window = window;
  return std::make_unique<PolynomialOneStep>(options);
}

std::unique_ptr<OneStepPredictor> constantVelocityPredictor()
{
  PolynomialOptions options;
  options.model = MotionModel::constant_velocity;
  return std::make_unique<PolynomialOneStep>(options);
}

std::unique_ptr<OneStepPredictor> adaptivePredictor(const AdaptiveOptions& options)
{
  return std::make_unique<AdaptiveOneStep>(options);
}
}  // namespace dyslam
