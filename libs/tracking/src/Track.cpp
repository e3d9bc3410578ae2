// SPDX-License-Identifier: BSD-3-Clause
#include "Track.h"

#include <dyslam/core/BoxOverlap.h>
#include <dyslam/tracking/Detector.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace dyslam
{
namespace
{
/** Gains of height and climb; roads slope slowly. */
constexpr double height_gain = 0.5;
constexpr double climb_gain = 0.1;
/** Of a smaller sighting's size, when parts may be hidden. */
constexpr double shrink_gain = 0.005;

/** Width and height that hardly any object of a class falls short of [m]. Nothing is said of
 * lengths: the visible end may be either. */
Eigen::Vector3d usualSize(ObjectClass object_class)
{
  switch (object_class)
  {
    case ObjectClass::car:
    case ObjectClass::van:
      return {0, 1.7, 1.4};
    case ObjectClass::cyclist:
    case ObjectClass::motorcyclist:
      return {0, 0, 1.6};
    case ObjectClass::pedestrian:
      return {0, 0, 1.6};
    default:
      return Eigen::Vector3d::Zero();
  }
}

/** Thin and long: a strip of wall on which the edge of a shadow glides along, no body. */
bool isStrip(const Eigen::Vector3d& size)
{
  constexpr double thin = 0.25;  // [m]
  constexpr double slender = 2.5;
  const double width = std::min(size.x(), size.y());
  return width < thin && std::max(size.x(), size.y()) > slender * width;
}

constexpr double square(double x)
{
  return x * x;
}

/** a or a + pi, whichever is nearer to b. */
double sameAxis(double a, double b)
{
  return std::abs(wrapAngle(a - b)) > M_PI / 2 ? wrapAngle(a + M_PI) : a;
}
}  // namespace

const ClassTracking& kindOf(const TrackerOptions& options, ObjectClass object_class)
{
  switch (object_class)
  {
    case ObjectClass::pedestrian:
      return options.pedestrian;
    case ObjectClass::cyclist:
    case ObjectClass::motorcyclist:
      return options.cyclist;
    default:
      return options.vehicle;
  }
}

Track::Motion Track::makeMotion(const TrackerOptions& options)
{
  if (options.motion == TrackMotion::adaptive)
  {
    return AdaptivePredictor();
  }
  PolynomialOptions polynomial;
  polynomial.degree = options.degree;
  polynomial.window = options.window;
  polynomial.model = options.motion == TrackMotion::polynomial ? MotionModel::polynomial
                                                               : MotionModel::constant_velocity;
  return PolynomialTrajectory(polynomial);
}

Track::Track(int id, double stamp, const Sighting& sighting, const TrackerOptions& options)
    : options_(&options), id_(id), stamp_(stamp), motion_(makeMotion(options)), box_(sighting.box)
{
  position_covariance_ = sighting.covariance.topLeftCorner<2, 2>();
  velocity_covariance_ *= square(5);
  z_variance_ = sighting.covariance(2, 2);
  yaw_variance_ = sighting.covariance(3, 3);
  remember(sighting);
  confirm(sighting);
}

void Track::confirm(const Sighting& sighting)
{
  // Clusters that stay where they are, are edges of shadows and the like, not movers.
  const bool ripe = hits_ >= kind().confirm_hits || score_sum_ >= kind().confirm_score;
  const bool moves = has_moved_ || !sighting.from_points || !options_->must_move;
  confirmed_ = confirmed_ || (ripe && moves && !(sighting.from_points && isStrip(box_.size)));
}

void Track::remember(const Sighting& sighting)
{
  const TimedPosition where{stamp_, box_.center.head<2>()};
  const TimedPosition raw{
      stamp_, sighting.from_points ? where.position : sighting.box.center.head<2>().eval()};
  std::visit([&](auto& motion) { motion.add(raw); }, motion_);
  class_votes_[static_cast<std::size_t>(sighting.object_class)] +=
      sighting.object_class == ObjectClass::unknown ? 0.1 : 1.0;
  const auto most = std::max_element(class_votes_.begin(), class_votes_.end());
  object_class_ = static_cast<ObjectClass>(most - class_votes_.begin());
  if (sighting.from_points)
  {
    // The size gathered over time says more than what was seen of it each time.
    const ObjectClass by_size = guessClass(box_.size);
    object_class_ = refineClass(by_size == ObjectClass::unknown ? object_class_ : by_size,
                                box_.size, dynamic_ ? velocity_.norm() : 0.0);
  }
  score_sum_ += sighting.score;
  detection_ = sighting.index;
}

void Track::predict(double stamp)
{
  const double dt = stamp - stamp_;
  stamp_ = stamp;
  ++age_;
  const MotionPrediction ahead =
      std::visit([&](const auto& motion) { return motion.predict(stamp); }, motion_);
  box_.center.head<2>() = ahead.position;
  box_.center.z() += climb_ * dt;
  velocity_ = ahead.velocity;
  velocity_covariance_ = ahead.velocity_covariance;
  position_covariance_ = ahead.covariance + square(kind().min_sigma) * Eigen::Matrix2d::Identity();
  z_variance_ += square(0.5 * dt);
  yaw_variance_ += square(options_->yaw_rate * dt);
}

Box Track::seenAs(const Sighting& sighting) const
{
  Box seen = sighting.box;
  if (!sighting.from_points)
  {
    return seen;
  }
  // The longer visible side need not be the length: take the axis nearer to the track's.
  if (hits_ >= 3 && std::abs(wrapAngle(2 * (seen.yaw - box_.yaw))) > M_PI / 2)
  {
    seen.yaw = wrapAngle(seen.yaw + M_PI / 2);
    std::swap(seen.size.x(), seen.size.y());
  }
  if (options_->complete_boxes)
  {
    seen.center.head<2>() -= sighting.sensor;
    seen = completedBox(seen, box_.size);
    seen.center.head<2>() += sighting.sensor;
  }
  return seen;
}

void Track::match(const Sighting& sighting)
{
  ++hits_;
  misses_ = 0;
  const Eigen::Vector2d before = seenAs(sighting).center.head<2>();
  resize(sighting);
  const Box seen = seenAs(sighting);
  if (sighting.from_points)
  {
    // A body that turns out larger was centred elsewhere all along; it did not jump.
    const Eigen::Vector2d offset = seen.center.head<2>() - before;
    box_.center.head<2>() += offset;
    std::visit([&](auto& motion) { motion.shift(offset); }, motion_);
  }
  turnTo(sighting, seen.yaw);
  moveTo(sighting, seen);
  remember(sighting);
  const MotionPrediction now =
      std::visit([&](const auto& motion) { return motion.predict(stamp_); }, motion_);
  velocity_ = now.velocity;
  velocity_covariance_ = now.velocity_covariance;
  judgeMotion();
  has_moved_ = has_moved_ || dynamic_ || moves();
  turnAlongMotion(sighting);
  confirm(sighting);
}

void Track::moveTo(const Sighting& sighting, const Box& seen)
{
  // The prediction's covariance counts a sighting's noise too; what is left is the state's.
  const Eigen::Matrix2d noise = sighting.covariance.topLeftCorner<2, 2>();
  const Eigen::Matrix2d gain = position_covariance_ * (position_covariance_ + noise).inverse();
  const Eigen::Vector2d innovation = seen.center.head<2>() - box_.center.head<2>();
  if (sighting.from_points)
  {
    box_.center.head<2>() = seen.center.head<2>();
  }
  else
  {
    box_.center.head<2>() += gain * innovation;
  }
  position_covariance_ = (Eigen::Matrix2d::Identity() - gain) * position_covariance_;
  const double rise = seen.center.z() - box_.center.z();
  box_.center.z() += height_gain * rise;
  climb_ += climb_gain * rise;
  climb_ = std::clamp(climb_, -3.0, 3.0);
  z_variance_ = z_variance_ * sighting.covariance(2, 2) / (z_variance_ + sighting.covariance(2, 2));
}

void Track::turnTo(const Sighting& sighting, double seen_yaw)
{
  const double facing = sameAxis(seen_yaw, box_.yaw);
  turned_sightings_ = std::clamp(turned_sightings_ + (facing == seen_yaw ? -1 : 1), -3, 6);
  const double gain = yaw_variance_ / (yaw_variance_ + sighting.covariance(3, 3));
  box_.yaw = wrapAngle(box_.yaw + gain * wrapAngle(facing - box_.yaw));
  yaw_variance_ *= 1 - gain;
  if (turned_sightings_ > 3 && !sighting.from_points)
  {
    box_.yaw = wrapAngle(box_.yaw + M_PI);
    turned_sightings_ = 0;
  }
}

/** Length and width change places. */
void Track::swapAxes()
{
  box_.yaw = wrapAngle(box_.yaw + M_PI / 2);
  std::swap(box_.size.x(), box_.size.y());
}

/** What moves faces where it goes (people may walk sideways, cars reverse slowly). */
void Track::turnAlongMotion(const Sighting& sighting)
{
  const double speed = velocity_.norm();
  if (!dynamic_ || speed < (sighting.from_points ? 1 : 2) * options_->dynamic_speed)
  {
    return;
  }
  const double course = std::atan2(velocity_.y(), velocity_.x());
  const double variance = 0.01 + 0.5 * velocity_covariance_.trace() / square(speed);
  if (sighting.from_points && variance < 0.1 &&
      std::abs(wrapAngle(2 * (course - box_.yaw))) > M_PI / 2)
  {
    swapAxes();  // its longer visible side was its width
  }
  if (std::abs(wrapAngle(course - box_.yaw)) > 0.75 * M_PI)
  {
    box_.yaw = wrapAngle(box_.yaw + M_PI);
    turned_sightings_ = -turned_sightings_;
  }
  const double gain = yaw_variance_ / (yaw_variance_ + variance);
  if (sighting.from_points || object_class_ != ObjectClass::pedestrian)
  {
    box_.yaw = wrapAngle(box_.yaw + gain * wrapAngle(course - box_.yaw));
    yaw_variance_ *= 1 - gain;
  }
}

void Track::resize(const Sighting& sighting)
{
  if (!sighting.from_points)
  {
    box_.size += options_->size_gain * (sighting.box.size - box_.size);
    return;
  }
  // Clusters show at most what is there: grow readily, shrink hardly.
  Eigen::Vector3d seen = sighting.box.size;
  if (hits_ >= 3 && std::abs(wrapAngle(2 * (sighting.box.yaw - box_.yaw))) > M_PI / 2)
  {
    std::swap(seen.x(), seen.y());
  }
  for (int k = 0; k < 3; ++k)
  {
    const double gain = seen[k] > box_.size[k] ? options_->size_gain : shrink_gain;
    box_.size[k] += gain * (seen[k] - box_.size[k]);
  }
  if (has_moved_)
  {
    // Feet and wheels are lost with the ground, far sides are hidden.
    const Eigen::Vector3d missing = (usualSize(object_class_) - box_.size).cwiseMax(0);
    box_.size += options_->size_gain * missing;
  }
}

/** Whether a straight line through the last sightings goes somewhere, far beyond what their scatter
 * about it explains. Edges of shadows flicker to and fro instead. */
bool Track::moves() const
{
  constexpr double least_speed = 0.5;  // [m/s]
  constexpr double least_way = 0.4;    // [m]
  constexpr double sigmas = 8;
  constexpr std::size_t least = 4;
  constexpr double least_scatter = 0.05;  // of one sighting [m]
  constexpr std::size_t most = 12;
  const auto& history = std::visit([](const auto& motion) -> const std::deque<TimedPosition>&
                                   { return motion.history(); },
                                   motion_);
  const std::size_t count = std::min(most, history.size());
  if (count < least)
  {
    return false;
  }
  const auto first = history.end() - static_cast<std::ptrdiff_t>(count);
  const double n = static_cast<double>(count);
  double mean_time = 0;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (auto it = first; it != history.end(); ++it)
  {
    mean_time += it->stamp / n;
    mean += it->position / n;
  }
  double time_spread = 0;
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
  for (auto it = first; it != history.end(); ++it)
  {
    time_spread += square(it->stamp - mean_time);
    slope += (it->stamp - mean_time) * (it->position - mean);
  }
  slope /= time_spread;
  double scatter = 2 * square(least_scatter);
  for (auto it = first; it != history.end(); ++it)
  {
    scatter += (it->position - mean - (it->stamp - mean_time) * slope).squaredNorm();
  }
  const double sigma = std::sqrt(scatter / (2 * (n - 2) + 2) / time_spread);
  const double way = slope.norm() * (history.back().stamp - first->stamp);
  return slope.norm() > least_speed && way > least_way && slope.norm() > sigmas * sigma;
}

void Track::judgeMotion()
{
  const double speed = velocity_.norm();
  bool against = false;
  if (dynamic_)
  {
    against = speed < options_->static_speed;
  }
  else
  {
    const Eigen::Vector2d along =
        speed > 0 ? Eigen::Vector2d(velocity_ / speed) : Eigen::Vector2d::UnitX();
    const double sigma = std::sqrt(along.dot(velocity_covariance_ * along));
    against = speed > options_->dynamic_speed && speed > options_->dynamic_sigmas * sigma;
  }
  change_votes_ = against ? change_votes_ + 1 : 0;
  if (change_votes_ >= options_->dynamic_hits)
  {
    dynamic_ = !dynamic_;
    change_votes_ = 0;
  }
}

void Track::miss()
{
  ++misses_;
  ++all_misses_;
  detection_ = -1;
}

bool Track::dead() const
{
  return misses_ > (confirmed_ ? kind().max_misses : kind().max_tentative_misses);
}

TrackedObject Track::object() const
{
  TrackedObject object;
  object.id = id_;
  object.box = box_;
  object.object_class = object_class_;
  object.velocity << velocity_, 0;
  object.covariance.setZero();
  object.covariance.topLeftCorner<2, 2>() = position_covariance_;
  object.covariance(2, 2) = z_variance_;
  object.covariance(3, 3) = yaw_variance_;
  object.confirmed = confirmed_;
  object.dynamic = dynamic_;
  object.observed = detection_ >= 0;
  object.detection = detection_;
  object.age = age_;
  object.score = score_sum_ / (hits_ + options_->score_prior + options_->miss_prior * all_misses_);
  return object;
}
}  // namespace dyslam
