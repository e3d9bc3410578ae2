// SPDX-License-Identifier: BSD-3-Clause
#include "KittiTracking.h"

#include <dyslam/core/BoxOverlap.h>
#include <dyslam/core/Error.h>
#include <dyslam/formats/KittiFiles.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

namespace dyslam
{
namespace
{
constexpr double frame_time = 0.1;  // between scans [s]

/** T_world_velo of each frame; world: x east, y north, z up, origin at the first position. */
std::vector<Pose> lidarPoses(const std::string& oxts, const KittiCalib& calib)
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

Eigen::Vector2d inWorld(const LabelledBox& box, const std::vector<Pose>& poses)
{
  return (poses[static_cast<std::size_t>(box.frame)] * box.box.center).head<2>();
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

/** Projection of a box in the lidar frame, clipped to the image [px]. */
Eigen::Vector4d inImage(const Box& box, const KittiCalib& calib)
{
  constexpr double image_width = 1242;
  constexpr double image_height = 375;
  constexpr double nearest = 0.1;  // [m]
  Eigen::Vector4d image(image_width, image_height, 0, 0);
  for (int corner = 0; corner < 8; ++corner)
  {
    const Eigen::Vector3d half(corner & 1 ? 0.5 : -0.5, corner & 2 ? 0.5 : -0.5,
                               corner & 4 ? 0.5 : -0.5);
    Eigen::Vector3d p =
        calib.T_cam_velo * (box.center + Eigen::AngleAxisd(box.yaw, Eigen::Vector3d::UnitZ()) *
                                             half.cwiseProduct(box.size));
    p.z() = std::max(p.z(), nearest);
    const Eigen::Vector3d pixel = calib.P2 * p.homogeneous();
    const double x = std::clamp(pixel.x() / pixel.z(), 0.0, image_width);
    const double y = std::clamp(pixel.y() / pixel.z(), 0.0, image_height);
    image << std::min(image[0], x), std::min(image[1], y), std::max(image[2], x),
        std::max(image[3], y);
  }
  return image;
}

Detection detectionOf(const LabelledBox& box)
{
  Detection detection;
  detection.box = box.box;
  detection.object_class = box.object_class;
  detection.score = box.score;
  detection.covariance = Eigen::Vector4d(0.04, 0.04, 0.02, 0.03).asDiagonal();
  return detection;
}

/** Tracks of one sequence in the lidar frame. Predicted tracks that left the image are not
 * reported because there are no labels there. */
void trackSequence(const std::vector<LabelledBox>& boxes,
                   const std::vector<Pose>& poses,
                   const KittiCalib& calib,
                   const TrackerOptions& options,
                   TrackSequence& sequence,
                   double& seconds)
{
  std::vector<std::vector<Detection>> detections(poses.size());
  std::vector<std::vector<Eigen::Vector4d>> image_boxes(poses.size());
  for (const LabelledBox& box : boxes)
  {
    if (box.frame >= 0 && static_cast<std::size_t>(box.frame) < poses.size())
    {
      detections[static_cast<std::size_t>(box.frame)].push_back(detectionOf(box));
      image_boxes[static_cast<std::size_t>(box.frame)].push_back(box.image_box);
    }
  }
  Tracker tracker(options);
  for (std::size_t f = 0; f < poses.size(); ++f)
  {
    const auto start = std::chrono::steady_clock::now();
    const std::vector<TrackedObject> objects =
        tracker.update(static_cast<double>(f) * frame_time, detections[f], poses[f]);
    seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const Pose T_velo_world = poses[f].inverse();
    for (const TrackedObject& object : objects)
    {
      if (!object.reported)
      {
        continue;
      }
      LabelledBox box;
      box.frame = static_cast<int>(f);
      box.id = object.id;
      box.object_class = object.object_class;
      box.type = toString(object.object_class);
      box.box = transformed(object.box, T_velo_world);
      box.score = object.score;
      box.image_box = object.detection >= 0
                          ? image_boxes[f][static_cast<std::size_t>(object.detection)]
                          : inImage(box.box, calib);
      const bool in_view = box.box.center.x() > 0.5 && box.image_box[2] - box.image_box[0] > 2;
      if (object.detection >= 0 || in_view)
      {
        sequence.estimate.push_back(box);
      }
    }
  }
}
}  // namespace

KittiTarget readKittiTarget(const std::string& boxes,
                            const std::string& oxts,
                            const std::string& calib,
                            int track,
                            const std::string& detections)
{
  constexpr double max_distance = 2;  // of a detection from the label [m]
  const KittiCalib mounting = readKittiCalib(calib);
  const std::vector<Pose> poses = lidarPoses(oxts, mounting);
  const auto known = [&](const LabelledBox& box)
  { return box.frame >= 0 && static_cast<std::size_t>(box.frame) < poses.size(); };
  KittiTarget target;
  std::map<int, Eigen::Vector2d> label_at;
  for (const LabelledBox& box : readKittiTracking(boxes, mounting.T_cam_velo))
  {
    if (box.id == track && known(box))
    {
      label_at[box.frame] = box.box.center.head<2>();
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
  for (const LabelledBox& box : readDetectionsCsv(detections, mounting.T_cam_velo))
  {
    const auto label = label_at.find(box.frame);
    if (box.score < 0 || !known(box) || label == label_at.end())
    {
      continue;
    }
    const double distance = (box.box.center.head<2>() - label->second).norm();
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

KittiMotRun runKittiMot(const std::string& folder,
                        const std::vector<std::string>& names,
                        const std::string& type,
                        const TrackerOptions& options)
{
  KittiMotRun run;
  for (const std::string& name : names)
  {
    const KittiCalib calib = readKittiCalib(folder + "/calib/" + name + ".txt");
    const std::vector<Pose> poses = lidarPoses(folder + "/oxts/" + name + ".txt", calib);
    TrackSequence sequence;
    sequence.frames = static_cast<int>(poses.size());
    sequence.reference =
        readKittiTracking(folder + "/label_02/" + name + ".txt", calib.T_cam_velo, true);
    trackSequence(readDetectionsCsv(folder + "/det_pointrcnn/" + type + "/" + name + ".txt",
                                    calib.T_cam_velo),
                  poses, calib, options, sequence, run.seconds);
    run.frames += sequence.frames;
    run.sequences.push_back(std::move(sequence));
  }
  return run;
}

std::vector<std::string> kittiMotValidation()
{
  return {"0001", "0006", "0008", "0010", "0012", "0013", "0014", "0015", "0016", "0018", "0019"};
}

std::vector<std::string> kittiMotTraining()
{
  return {"0000", "0002", "0003", "0004", "0005", "0007", "0009", "0011", "0017", "0020"};
}
}  // namespace dyslam
