// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/SharedFiles.h>
#include <dyslam/base/StateArchive.h>
#include <dyslam/dyseg/NetworkSegmenter.h>
#include <dyslam/nets/DysegModel.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>
#include <stdexcept>
#include <utility>

#include "MovingGroups.h"

namespace dyslam
{
namespace
{
// Uncertainty of a static flow beyond its own residuals: cells of 0.8 m are not independent, and
// height, roll and pitch are not observed.
constexpr double min_rmse = 0.05;  // least RMSE of the cells [m]
constexpr double cells_per_measurement = 20;
constexpr double min_margin = 0.1;           // least margin of the best motion over any other
constexpr double height_sigma = 0.1;         // sigma of z [m]
constexpr double tilt_sigma = 0.01;          // sigma of roll and pitch [rad]
constexpr double prior_search_radius = 0.2;  // search range around the prior [m]
constexpr double lever = 20;                 // typical distance of a cell [m]

MotionEstimate motionOf(const RigidFlowFit& fit, const Eigen::Vector3d& sensor)
{
  MotionEstimate m;
  // The network's frame has the axes of the vehicle and its origin at the sensor.
  const Pose to_vehicle = Pose(Eigen::Translation3d(sensor));
  m.T_previous_current = to_vehicle * fit.motion.pose() * to_vehicle.inverse();
  const bool distinct = fit.margin >= min_margin;
  m.status = fit.converged && distinct ? MotionStatus::converged : MotionStatus::not_found;
  m.reason = !fit.converged ? "too few cells with flow"
             : !distinct    ? "two motions explain the flow about equally well"
                            : "";
  m.rmse = fit.rmse;
  for (const float w : fit.inlier)
  {
    m.inliers += w > 0.5F ? 1 : 0;
  }
  const double sigma = std::max(fit.rmse, min_rmse);
  const double measurements = std::max(1.0, static_cast<double>(m.inliers) / cells_per_measurement);
  const double plane = measurements / (sigma * sigma);
  m.information.setZero();
  m.information.diagonal() << plane, plane, 1 / (height_sigma * height_sigma),
      1 / (tilt_sigma * tilt_sigma), 1 / (tilt_sigma * tilt_sigma), plane * lever * lever;
  return m;
}

float logOdds(float probability)
{
  const float p = std::clamp(probability, 1e-3F, 1 - 1e-3F);
  return std::log(p / (1 - p));
}

/** Shifts the log-odds so that `threshold` becomes 0.5; a probability of 0 is not changed. */
void calibrate(double threshold, std::vector<float>& probability)
{
  const float shift = logOdds(static_cast<float>(threshold));
  for (auto& p : probability)
  {
    p = p > 0 ? 1 / (1 + std::exp(shift - logOdds(p))) : p;
  }
}

struct EncodedPoints : EncodedCloud
{
  std::vector<Eigen::Vector3f> points;  //!< relative to the sensor, axes of the vehicle frame [m]
  std::shared_ptr<const DysegModel::Encoded> encoded;
};
}  // namespace

struct NetworkSegmenter::Impl
{
  struct Past
  {
    std::size_t index = 0;  //!< Frame::index; only in saved states
    std::shared_ptr<const EncodedPoints> scan;
    PlanarMotion from_current;  //!< static motion from the current scan to this one
    Pose T_odom_vehicle = Pose::Identity();
  };

  [[nodiscard]] std::shared_ptr<const EncodedPoints> encode(
      std::vector<Eigen::Vector3f> points) const;

  NetworkSegmenterOptions options;
  DysegModel model;
  std::deque<Past> past;                  //!< past scans, newest first
  std::optional<RigidFlowFit> last_step;  //!< static motion to the previous scan, if estimated
  std::optional<MotionEstimate> static_motion;  //!< motion to the compared scan
  std::vector<PastVisibility> seen;  //!< visibility of current points in the compared scan

  /** Whether the static motion is searched only around the prior. */
  [[nodiscard]] bool searchesAroundPrior(const Frame& frame) const
  {
    return frame.prior.reliable &&
           (options.search == "prior" || (options.search == "auto" && historyComplete()));
  }
  /** Whether there are enough past scans for the comparison over `first_gap` scans. */
  [[nodiscard]] bool historyComplete() const
  {
    return past.size() >= static_cast<std::size_t>(options.first_gap);
  }
  /** Sets Past::from_current of all past scans by the odometry. */
  void followOdometry(const Frame& frame, const Eigen::Vector3d& sensor);
  /** Updates Past::from_current of all past scans by the estimated static motion to the previous
   * scan; by the prior if too few cells determine it. */
  void followScans(const DysegModel::Encoded& current,
                   const Frame& frame,
                   const Eigen::Vector3d& sensor);
  /** Segments by comparison with the scan `back` scans ago; stores the static motion. */
  [[nodiscard]] std::vector<float> compareWith(const DysegModel::Encoded& current,
                                               const Frame& frame,
                                               std::size_t back,
                                               const Eigen::Vector3d& sensor);
};

NetworkSegmenter::NetworkSegmenter(const NetworkSegmenterOptions& options)
{
  validate(options, "dyseg_network");
  const char* setting = "dyseg_network.weights";
  const std::string file = findGivenOrShared(options.weights, "models", ".safetensors", setting);
  impl_ = std::make_unique<Impl>(
      Impl{options,
           namingSetting(setting, file,
                         [&] { return DysegModel(file, options.threads, options.device); }),
           {},
           {},
           {},
           {}});
}

NetworkSegmenter::~NetworkSegmenter() = default;

void NetworkSegmenter::exchangeState(StateArchive& archive)
{
  Impl& s = *impl_;
  std::size_t count = s.past.size();
  archive(count);
  if (archive.isLoading())
  {
    s.past.clear();
    s.static_motion.reset();
  }
  for (std::size_t i = 0; i < count; ++i)
  {
    Impl::Past past = archive.isLoading() ? Impl::Past() : s.past[i];
    std::vector<Eigen::Vector3f> points;
    if (!archive.isLoading())
    {
      points = past.scan->points;
    }
    archive(past.index, past.from_current, past.T_odom_vehicle, points);
    if (archive.isLoading())
    {
      past.scan = s.encode(std::move(points));
      s.past.push_back(std::move(past));
    }
  }
}

const std::optional<MotionEstimate>& NetworkSegmenter::motionToEarlier() const
{
  return impl_->static_motion;
}

void NetworkSegmenter::Impl::followOdometry(const Frame& frame, const Eigen::Vector3d& sensor)
{
  const Pose to_vehicle = Pose(Eigen::Translation3d(sensor));
  for (Past& p : past)
  {
    p.from_current = PlanarMotion::fromPose(to_vehicle.inverse() * p.T_odom_vehicle.inverse() *
                                            frame.T_odom_vehicle * to_vehicle);
  }
  last_step.reset();
}

void NetworkSegmenter::Impl::followScans(const DysegModel::Encoded& current,
                                         const Frame& frame,
                                         const Eigen::Vector3d& sensor)
{
  const Pose to_vehicle = Pose(Eigen::Translation3d(sensor));
  const PlanarPrior guess{
      PlanarMotion::fromPose(to_vehicle.inverse() * frame.prior.T_previous_current * to_vehicle),
      prior_search_radius};
  last_step = model.match(current, *past.front().scan->encoded,
                          searchesAroundPrior(frame) ? &guess : nullptr);
  const PlanarMotion& step = last_step->converged ? last_step->motion : guess.motion;
  for (Past& p : past)
  {
    p.from_current = PlanarMotion::fromPose(p.from_current.pose() * step.pose());
  }
}

std::vector<float> NetworkSegmenter::Impl::compareWith(const DysegModel::Encoded& current,
                                                       const Frame& frame,
                                                       std::size_t back,
                                                       const Eigen::Vector3d& sensor)
{
  const Past& earlier = past[back - 1];
  const PlanarPrior guess{earlier.from_current, searchesAroundPrior(frame)
                                                    ? prior_search_radius
                                                    : PlanarPrior().max_error};
  RigidFlowFit step =
      back == 1 && last_step ? *last_step : model.match(current, *earlier.scan->encoded, &guess);
  if (!step.converged)
  {
    step.motion = earlier.from_current;
  }
  auto result = model.segment(current, *earlier.scan->encoded, step, options.iterations);
  seen = std::move(result.past_visibility);
  static_motion = motionOf(step, sensor);
  return std::move(result.moving_probability);
}

std::shared_ptr<const EncodedPoints> NetworkSegmenter::Impl::encode(
    std::vector<Eigen::Vector3f> points) const
{
  auto scan = std::make_shared<EncodedPoints>();
  scan->points = std::move(points);
  scan->encoded = model.encode(scan->points);
  return scan;
}

bool NetworkSegmenter::encodesAhead() const
{
  return impl_->options.encode_ahead && impl_->historyComplete();
}

std::shared_ptr<const EncodedCloud> NetworkSegmenter::encode(const Cloud& cloud,
                                                             const Pose& T_vehicle_lidar) const
{
  const Eigen::Vector3f sensor = T_vehicle_lidar.translation().cast<float>();
  std::vector<Eigen::Vector3f> points(cloud.points);
  for (auto& p : points)
  {
    p -= sensor;
  }
  return impl_->encode(std::move(points));
}

void NetworkSegmenter::segment(Frame& frame)
{
  segmentEncoded(frame, encode(frame.cloud, frame.scan.T_vehicle_lidar));
}

void NetworkSegmenter::segmentEncoded(Frame& frame,
                                      const std::shared_ptr<const EncodedCloud>& encoded_cloud)
{
  Impl& s = *impl_;
  const auto scan = std::dynamic_pointer_cast<const EncodedPoints>(encoded_cloud);
  if (!scan || scan->points.size() != frame.cloud.size())
  {
    throw std::invalid_argument("NetworkSegmenter: not the encoding of the frame's cloud");
  }
  const Eigen::Vector3d sensor = frame.scan.T_vehicle_lidar.translation();
  const DysegModel::Encoded& encoded = *scan->encoded;
  frame.moving_probability.assign(scan->points.size(), 0.0F);
  s.static_motion.reset();
  frame.segmenter_motion.reset();
  frame.static_prior.clear();
  if (!s.historyComplete())
  {
    frame.static_prior = s.model.appearancePrior(encoded);
  }
  if (!s.past.empty())
  {
    // Since the last call the odometry has estimated the pose of the previous scan.
    s.past.front().T_odom_vehicle = frame.T_odom_vehicle * frame.prior.T_previous_current.inverse();
    if (s.historyComplete() && s.searchesAroundPrior(frame))
    {
      s.followOdometry(frame, sensor);
    }
    else
    {
      s.followScans(encoded, frame, sensor);
      MotionEstimate motion = motionOf(*s.last_step, sensor);
      if (motion.registered())
      {
        frame.segmenter_motion = std::move(motion);
      }
    }
    const auto back = std::min(s.past.size(), static_cast<std::size_t>(s.options.first_gap));
    frame.moving_probability = s.compareWith(encoded, frame, back, sensor);
    calibrate(s.options.threshold, frame.moving_probability);
    MovingGroupsOptions groups;
    groups.reach = static_cast<double>(s.model.grid().halfExtent());
    groups.min_points = s.options.min_points;
    keepMovingGroups(scan->points, s.seen, groups, frame.moving_probability);
  }
  s.past.push_front({frame.index, scan, PlanarMotion(), frame.T_odom_vehicle});
  if (s.past.size() > static_cast<std::size_t>(s.options.first_gap))
  {
    s.past.pop_back();
  }
}
}  // namespace dyslam
