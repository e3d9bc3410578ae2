// SPDX-License-Identifier: BSD-3-Clause
#include "Track.h"

#include <dyslam/base/Angle.h>
#include <dyslam/base/Squared.h>
#include <dyslam/base/StateArchive.h>
#include <dyslam/tracking/BoxFitting.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <type_traits>

#include "SignificantMotion.h"

namespace dyslam
{
namespace
{
/** Alpha-beta filter of the height. Roads slope slowly. */
constexpr double height_gain = 0.5;
constexpr double vertical_velocity_gain = 0.1;

/** Gain of observed sizes below the track's size: low, as parts may be occluded. Of complete
 * clusters it is higher at first: the first ones may be of two things together, such as a
 * pedestrian who passes a post; for persons it stays higher, as they come and go together.
 * \param hits number of observations */
double shrinkGain(int hits, bool complete, bool person)
{
  constexpr double lasting = 0.005;
  constexpr double of_persons = 0.1;
  constexpr double of_first = 0.3;
  return complete ? std::max(person ? of_persons : lasting, of_first / hits) : lasting;
}

/** Lower bounds of a vehicle's width and of the height of all classes [m]. None for the length: the
 * visible part may be either end. */
Eigen::Vector3d minimumSize(ObjectClass object_class)
{
  Eigen::Vector3d size = leastSize(object_class);
  size.x() = 0;
  size.y() = isVehicle(object_class) ? size.y() : 0;
  return size;
}

/** Whether a box is thin and long: the occlusion boundary of a wall rather than an object. */
bool isStrip(const Eigen::Vector3d& size)
{
  constexpr double max_width = 0.25;  // largest width of an occlusion boundary [m]
  constexpr double min_aspect_ratio = 2.5;
  const double width = std::min(size.x(), size.y());
  return width < max_width && std::max(size.x(), size.y()) > min_aspect_ratio * width;
}

/** Of a and a + pi, the angle nearer to b [rad]. */
double nearestAxis(double a, double b)
{
  return std::abs(wrapAngle(a - b)) > M_PI / 2 ? wrapAngle(a + M_PI) : a;
}
}  // namespace

Track::Motion Track::makeMotion(const TrackerOptions& options, ObjectClass object_class)
{
  const ClassTracking& class_options = optionsFor(options, object_class);
  if (options.motion == TrackMotion::adaptive)
  {
    AdaptiveOptions adaptive;
    adaptive.initial_speed_sigma = class_options.speed_sigma;
    return AdaptivePredictor(adaptive);
  }
  if (options.motion == TrackMotion::kalman)
  {
    return KalmanMotion({class_options.speed_sigma, class_options.velocity_walk});
  }
  PolynomialOptions polynomial;
  polynomial.initial_speed_sigma = class_options.speed_sigma;
  polynomial.degree = options.degree;
  polynomial.window = options.window;
  polynomial.model = options.motion == TrackMotion::polynomial ? MotionModel::polynomial
                                                               : MotionModel::constant_velocity;
  return PolynomialTrajectory(polynomial);
}

Track::Track(int id, double stamp, const Observation& observation, const TrackerOptions& options)
    : options_(&options),
      id_(id),
      stamp_(stamp),
      motion_(makeMotion(options, observation.object_class)),
      box_(observation.box)
{
  position_covariance_ = observation.covariance.topLeftCorner<2, 2>();
  velocity_covariance_ *= squared(optionsFor(options, observation.object_class).speed_sigma);
  z_variance_ = observation.covariance(2, 2);
  yaw_variance_ = observation.covariance(3, 3);
  addToHistory(observation);
  confirm(observation);
  keepObservation(observation);
}

void Track::confirm(const Observation& observation)
{
  // Clusters that do not move are mostly occlusion boundaries.
  const bool mature = hits_ >= classOptions().confirm_hits;
  const bool moved = has_moved_ || !observation.from_points || !options_->must_move;
  confirmed_ = confirmed_ || (mature && moved && !(observation.from_points && isStrip(box_.size)));
}

void Track::addToHistory(const Observation& observation)
{
  const TimedPosition where{stamp_, box_.centre.head<2>()};
  const TimedPosition raw{
      stamp_, observation.from_points ? where.position : observation.box.centre.head<2>().eval()};
  const auto add = [&](auto& motion)
  {
    if constexpr (std::is_same_v<std::decay_t<decltype(motion)>, KalmanMotion>)
    {
      motion.add(raw, observation.covariance.topLeftCorner<2, 2>());
    }
    else
    {
      motion.add(raw);
    }
  };
  std::visit(add, motion_);
  class_votes_[static_cast<std::size_t>(observation.object_class)] +=
      observation.object_class == ObjectClass::unknown ? 0.1 : 1.0;
  const auto most = std::max_element(class_votes_.begin(), class_votes_.end());
  object_class_ = static_cast<ObjectClass>(most - class_votes_.begin());
  if (observation.from_points)
  {
    // The size accumulated over time is more informative than the size of one observation.
    const ObjectClass by_size = classifyBySize(box_.size);
    object_class_ = refineClass(by_size == ObjectClass::unknown ? object_class_ : by_size,
                                box_.size, dynamic_ ? velocity_.norm() : 0.0);
  }
  recent_scores_ = classOptions().score_memory * recent_scores_ + observation.score;
  score_weight_ = classOptions().score_memory * score_weight_ + 1;
  detection_ = observation.index;
}

void Track::predict(double stamp)
{
  const double dt = stamp - stamp_;
  stamp_ = stamp;
  ++age_;
  const MotionPrediction predicted =
      std::visit([&](const auto& motion) { return motion.predict(stamp); }, motion_);
  box_.centre.head<2>() = predicted.position;
  box_.centre.z() += vertical_velocity_ * dt;
  velocity_ = predicted.velocity;
  velocity_covariance_ = predicted.velocity_covariance;
  position_covariance_ =
      predicted.covariance + squared(classOptions().min_sigma) * Eigen::Matrix2d::Identity();
  z_variance_ += squared(0.5 * dt);
  yaw_variance_ += squared(options_->yaw_rate_sigma * dt);
}

Box Track::alignedBox(const Observation& observation) const
{
  Box observed = observation.box;
  if (!observation.from_points)
  {
    return observed;
  }
  // The longer visible side may be the width: choose the axis nearer to the track's.
  if (hits_ >= 3 && std::abs(wrapAngle(2 * (observed.yaw - box_.yaw))) > M_PI / 2)
  {
    observed.yaw = wrapAngle(observed.yaw + M_PI / 2);
    std::swap(observed.size.x(), observed.size.y());
  }
  if (options_->complete_boxes)
  {
    observed.centre.head<2>() -= observation.sensor;
    observed = completeBox(observed, box_.size);
    observed.centre.head<2>() += observation.sensor;
  }
  return observed;
}

void Track::match(const Observation& observation)
{
  ++hits_;
  misses_ = 0;
  predicted_hits_ = observation.predicted ? predicted_hits_ + 1 : 0;
  const Eigen::Vector2d before = alignedBox(observation).centre.head<2>();
  updateSize(observation);
  const Box observed = alignedBox(observation);
  if (observation.from_points)
  {
    // A larger size moves the estimated centre, which is a correction of the history, no motion.
    const Eigen::Vector2d offset = observed.centre.head<2>() - before;
    box_.centre.head<2>() += offset;
    std::visit([&](auto& motion) { motion.shift(offset); }, motion_);
  }
  updateHeading(observation, observed.yaw);
  updatePosition(observation, observed);
  addToHistory(observation);
  const MotionPrediction now =
      std::visit([&](const auto& motion) { return motion.predict(stamp_); }, motion_);
  velocity_ = now.velocity;
  velocity_covariance_ = now.velocity_covariance;
  if (const auto* filter = std::get_if<KalmanMotion>(&motion_))
  {
    box_.centre.head<2>() = now.position;
    position_covariance_ = filter->positionCovariance();
  }
  updateDynamicState();
  has_moved_ = has_moved_ || dynamic_ || hasSignificantMotion(history());
  alignHeadingWithMotion(observation);
  confirm(observation);
  keepObservation(observation);
}

void Track::updatePosition(const Observation& observation, const Box& observed)
{
  // The predicted covariance contains the observation's noise already; the update is approximate.
  const Eigen::Matrix2d noise = observation.covariance.topLeftCorner<2, 2>();
  const Eigen::Matrix2d gain = position_covariance_ * (position_covariance_ + noise).inverse();
  const Eigen::Vector2d innovation = observed.centre.head<2>() - box_.centre.head<2>();
  if (observation.from_points)
  {
    box_.centre.head<2>() = observed.centre.head<2>();
  }
  else
  {
    box_.centre.head<2>() += gain * innovation;
  }
  position_covariance_ = (Eigen::Matrix2d::Identity() - gain) * position_covariance_;
  const double rise = observed.centre.z() - box_.centre.z();
  box_.centre.z() += height_gain * rise;
  vertical_velocity_ += vertical_velocity_gain * rise;
  vertical_velocity_ = std::clamp(vertical_velocity_, -3.0, 3.0);
  z_variance_ =
      z_variance_ * observation.covariance(2, 2) / (z_variance_ + observation.covariance(2, 2));
}

void Track::updateHeading(const Observation& observation, double observed_yaw)
{
  const double heading = nearestAxis(observed_yaw, box_.yaw);
  reversed_observations_ =
      std::clamp(reversed_observations_ + (heading == observed_yaw ? -1 : 1), -3, 6);
  const double gain = yaw_variance_ / (yaw_variance_ + observation.covariance(3, 3));
  box_.yaw = wrapAngle(box_.yaw + gain * wrapAngle(heading - box_.yaw));
  yaw_variance_ *= 1 - gain;
  if (reversed_observations_ > 3 && !observation.from_points)
  {
    box_.yaw = wrapAngle(box_.yaw + M_PI);
    reversed_observations_ = 0;
  }
}

/** Exchanges length and width. */
void Track::swapAxes()
{
  box_.yaw = wrapAngle(box_.yaw + M_PI / 2);
  std::swap(box_.size.x(), box_.size.y());
}

/** Aligns the heading with the velocity (people may walk sideways, cars reverse slowly). */
void Track::alignHeadingWithMotion(const Observation& observation)
{
  const double speed = velocity_.norm();
  if (!dynamic_ || speed < (observation.from_points ? 1 : 2) * options_->dynamic_speed)
  {
    return;
  }
  const double course = std::atan2(velocity_.y(), velocity_.x());
  const double variance = 0.01 + 0.5 * velocity_covariance_.trace() / squared(speed);
  if (observation.from_points && variance < 0.1 &&
      std::abs(wrapAngle(2 * (course - box_.yaw))) > M_PI / 2)
  {
    swapAxes();  // the longer visible side was the width
  }
  if (std::abs(wrapAngle(course - box_.yaw)) > 0.75 * M_PI)
  {
    box_.yaw = wrapAngle(box_.yaw + M_PI);
    reversed_observations_ = -reversed_observations_;
  }
  const double gain = yaw_variance_ / (yaw_variance_ + variance);
  if (observation.from_points || object_class_ != ObjectClass::pedestrian)
  {
    box_.yaw = wrapAngle(box_.yaw + gain * wrapAngle(course - box_.yaw));
    yaw_variance_ *= 1 - gain;
  }
}

void Track::updateSize(const Observation& observation)
{
  if (!observation.from_points)
  {
    box_.size += options_->size_gain * (observation.box.size - box_.size);
    return;
  }
  // Clusters show at most the whole object: fast growth, slow shrinking.
  Eigen::Vector3d observed = observation.box.size;
  if (hits_ >= 3 && std::abs(wrapAngle(2 * (observation.box.yaw - box_.yaw))) > M_PI / 2)
  {
    std::swap(observed.x(), observed.y());
  }
  const double shrink_gain = shrinkGain(hits_, observation.complete, isOftenPerson());
  for (int k = 0; k < 3; ++k)
  {
    const double gain = observed[k] > box_.size[k] ? options_->size_gain : shrink_gain;
    box_.size[k] += gain * (observed[k] - box_.size[k]);
  }
  if (has_moved_)
  {
    // Feet and wheels are removed with the ground, far sides are occluded.
    const Eigen::Vector3d missing = (minimumSize(object_class_) - box_.size).cwiseMax(0);
    box_.size += options_->size_gain * missing;
  }
}

bool Track::isOftenPerson() const
{
  constexpr double one_of = 3;  // observations with the size of some class
  std::array<double, 8> votes = class_votes_;
  votes[static_cast<std::size_t>(ObjectClass::unknown)] = 0;
  const double persons = votes[static_cast<std::size_t>(ObjectClass::pedestrian)];
  return persons > 0 && one_of * persons >= std::accumulate(votes.begin(), votes.end(), 0.0);
}

const std::deque<TimedPosition>& Track::history() const
{
  return std::visit([](const auto& motion) -> const PositionHistory& { return motion.history(); },
                    motion_);
}

void Track::updateDynamicState()
{
  const double speed = velocity_.norm();
  bool contradicts = false;
  if (dynamic_)
  {
    contradicts = speed < options_->static_speed;
  }
  else
  {
    const Eigen::Vector2d along =
        speed > 0 ? Eigen::Vector2d(velocity_ / speed) : Eigen::Vector2d::UnitX();
    const double sigma = std::sqrt(along.dot(velocity_covariance_ * along));
    contradicts = speed > options_->dynamic_speed && speed > options_->dynamic_sigmas * sigma;
  }
  change_count_ = contradicts ? change_count_ + 1 : 0;
  if (change_count_ >= options_->dynamic_hits)
  {
    dynamic_ = !dynamic_;
    change_count_ = 0;
  }
}

void Track::keepObservation(const Observation& observation)
{
  observed_ = alignedBox(observation);
  observed_.yaw = nearestAxis(observed_.yaw, box_.yaw);
  observed_covariance_ = observation.covariance;
}

void Track::miss()
{
  ++misses_;
  ++total_misses_;
  detection_ = -1;
}

bool Track::isAliased(const std::vector<Observation>& observations) const
{
  constexpr std::size_t places = 2;  // last places; a follower of the object may reach earlier ones
  constexpr double clear_distance = 2;  // distance of the object from a place that it left [m]
  constexpr double same_place = 1;      // largest distance of an observation at a place [m]
  if (confirmed_ || hits_ == 1)
  {
    return false;
  }
  const auto is_taken = [&](const TimedPosition& place)
  {
    return (box_.centre.head<2>() - place.position).norm() > clear_distance &&
           std::any_of(observations.begin(), observations.end(),
                       [&](const Observation& o)
                       { return (o.box.centre.head<2>() - place.position).norm() < same_place; });
  };
  const std::deque<TimedPosition>& past = history();
  const auto count = static_cast<std::ptrdiff_t>(std::min(places, past.size()));
  return std::any_of(past.end() - count, past.end(), is_taken);
}

double Track::gateDistance() const
{
  const double reach = isNew() ? classOptions().max_speed * (stamp_ - history().back().stamp) : 0;
  return std::max(classOptions().gate_distance, reach);
}

bool Track::movesByPrediction() const
{
  constexpr int most_misses = 2;  // after more misses the position is too uncertain
  return confirmed_ && dynamic_ && misses_ <= most_misses &&
         predicted_hits_ < options_->predicted_scans;
}

bool Track::dead() const
{
  return misses_ > (confirmed_ ? classOptions().max_misses : classOptions().max_tentative_misses);
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
  object.observation = observed_;
  object.observation_covariance = observed_covariance_;
  object.age = age_;
  const double zeros = classOptions().score_prior + classOptions().miss_prior * total_misses_;
  object.score = recent_scores_ * (hits_ / score_weight_) / (hits_ + zeros);
  return object;
}

Track::Track(const TrackerOptions& options)
    : options_(&options), id_(-1), stamp_(0), motion_(makeMotion(options, ObjectClass::unknown))
{
}

void Track::exchangeState(StateArchive& archive)
{
  std::visit([&](auto& motion) { archive(motion); }, motion_);
  archive(id_, stamp_, box_, velocity_, velocity_covariance_, position_covariance_,
          vertical_velocity_, z_variance_, yaw_variance_, reversed_observations_, class_votes_,
          object_class_, recent_scores_, score_weight_, hits_, misses_, total_misses_, age_,
          predicted_hits_, confirmed_, dynamic_, has_moved_, change_count_, detection_, observed_,
          observed_covariance_);
}
}  // namespace dyslam
