// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Scan.h>
#include <dyslam/nets/BevScan.h>
#include <dyslam/train/DysegBodies.h>
#include <dyslam/train/DysegData.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace dyslam
{
namespace
{
const Eigen::Vector2f no_flow = Eigen::Vector2f::Constant(std::numeric_limits<float>::quiet_NaN());

Eigen::Vector2f flowOf(const Eigen::Isometry3f& motion, const Eigen::Vector3f& p)
{
  return (motion * p - p).head<2>();
}

std::uint8_t labelBySpeed(const DysegClip::Object& object)
{
  return object.doubtful ? DysegSample::ignored_point
         : object.moving ? DysegSample::moving_point
                         : DysegSample::static_point;
}

/** Label and motion of an object's points in a pair. */
struct ObjectTruth
{
  std::uint8_t label = DysegSample::ignored_point;
  bool known = false;  //!< whether the motion is known
  Eigen::Isometry3f T_past_current = Eigen::Isometry3f::Identity();
};

/** Truth of an object's points. \param now object in the current frame \param then object in the
 * past frame; null if it is not there \param ego T_past_current of the sensor */
ObjectTruth truthOf(const DysegClip::Object& now, const DysegClip::Object* then, const Pose& ego)
{
  ObjectTruth truth{labelBySpeed(now), true, ego.cast<float>()};
  const bool stands = truth.label == DysegSample::static_point;
  if (then == nullptr)
  {
    truth.known = stands;
    return truth;
  }
  const double displacement =
      (then->T_sensor_object.translation() - ego * now.T_sensor_object.translation())
          .head<2>()
          .norm();
  if (stands && displacement < min_visible_displacement)
  {
    return truth;  // the ego-motion is more accurate than the poses of labelled boxes
  }
  truth.T_past_current = (then->T_sensor_object * now.T_sensor_object.inverse()).cast<float>();
  if (stands ? displacement > max_static_displacement : displacement < min_visible_displacement)
  {
    truth.label = DysegSample::ignored_point;
  }
  return truth;
}

/** Truth of all objects of a frame, and of points on no object. */
std::map<std::int32_t, ObjectTruth> truthOfObjects(const DysegClip::Frame& now,
                                                   const DysegClip::Frame& then,
                                                   const Pose& ego)
{
  std::map<std::int32_t, ObjectTruth> truths;
  for (const auto& [id, object] : now.objects)
  {
    const auto earlier = then.objects.find(id);
    truths[id] = truthOf(object, earlier == then.objects.end() ? nullptr : &earlier->second, ego);
  }
  truths[DysegClip::still] = {DysegSample::static_point, true, ego.cast<float>()};
  truths[DysegClip::unknown] = {};
  return truths;
}
}  // namespace

std::vector<std::uint8_t> labelsBySpeed(const DysegClip::Frame& frame)
{
  std::vector<std::uint8_t> labels;
  labels.reserve(frame.object.size());
  for (const std::int32_t id : frame.object)
  {
    const auto found = frame.objects.find(id);
    labels.push_back(id == DysegClip::still         ? DysegSample::static_point
                     : found == frame.objects.end() ? DysegSample::ignored_point
                                                    : labelBySpeed(found->second));
  }
  return labels;
}

DysegSample makeSample(const DysegClip& clip, std::size_t current, std::size_t past)
{
  return makeSample(
      clip.frames.at(current), clip.frames.at(past),
      clip.period * std::abs(static_cast<double>(current) - static_cast<double>(past)));
}

DysegSample makeSample(const DysegClip::Frame& now, const DysegClip::Frame& then, double elapsed)
{
  DysegSample sample;
  sample.current = now.points;
  sample.past = then.points;
  sample.T_past_current = then.T_world_sensor.inverse() * now.T_world_sensor;
  sample.elapsed = elapsed;
  sample.label.reserve(now.points.size());
  sample.flow.reserve(now.points.size());

  const auto truths = truthOfObjects(now, then, sample.T_past_current);
  std::map<std::int32_t, std::size_t> moving_points;
  for (std::size_t i = 0; i < now.points.size(); ++i)
  {
    const auto found = truths.find(now.object[i]);
    const ObjectTruth& truth =
        found == truths.end() ? truths.at(DysegClip::unknown) : found->second;
    sample.label.push_back(truth.label);
    sample.flow.push_back(truth.known ? flowOf(truth.T_past_current, now.points[i]) : no_flow);
    if (truth.label == DysegSample::moving_point)
    {
      ++moving_points[now.object[i]];
    }
  }
  for (const auto& [id, points] : moving_points)
  {
    if (points >= min_mover_points)
    {
      sample.movers.emplace_back(
          now.objects.at(id).T_sensor_object.translation().head<2>().cast<float>());
    }
  }
  return sample;
}

DysegSample doubleScan(const std::vector<Eigen::Vector3f>& points,
                       const Pose& T_past_current,
                       RandomDraws& draws)
{
  DysegSample sample;
  sample.current = points;
  sample.T_past_current = T_past_current;
  const Eigen::Isometry3f motion = T_past_current.cast<float>();
  sample.label.assign(points.size(), DysegSample::static_point);
  sample.flow.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    const auto& p = points[i];
    sample.flow[i] = flowOf(motion, p);
    if (isReturn(p))
    {
      const Eigen::Vector3f moved = motion * p;
      const auto noise = static_cast<float>(draws.normal(0.02));
      sample.past.emplace_back(moved * (1 + noise / std::max(1.0F, moved.norm())));
    }
  }
  return sample;
}

void DysegAugmentOptions::describe(OptionsVisitor& v)
{
  v.integer("bodies", bodies, 0, 100, "most bodies cast into a pair");
  v.real("moving_share", moving_share, 0, 1, "share of the cast bodies that move");
  v.real("beside_share", beside_share, 0, 1,
         "share of the cast bodies that are close beside the sensor");
  v.real("convoy_share", convoy_share, 0, 1,
         "share of pairs with twice the bodies, most moving with the ego-vehicle");
  v.real("max_body_distance", max_body_distance, 5, 100,
         "largest distance of a cast body from the sensor [m]");
  v.real("dropout", dropout, 0, 0.9, "largest share of points left out of a scan");
  v.real("range_noise", range_noise, 0, 0.5,
         "standard deviation of the range noise of cast bodies [m]");
}

namespace
{
BodyKind drawKind(bool beside, RandomDraws& draws)
{
  // Large bodies right beside the sensor fill the view and show mostly one side.
  constexpr BodyKind large[] = {BodyKind::truck, BodyKind::truck, BodyKind::truck, BodyKind::van,
                                BodyKind::van,   BodyKind::car,   BodyKind::random};
  if (beside && draws.chance(0.7))
  {
    return large[draws.below(std::size(large))];
  }
  constexpr BodyKind kinds[] = {BodyKind::car,        BodyKind::car,        BodyKind::van,
                                BodyKind::truck,      BodyKind::pedestrian, BodyKind::pedestrian,
                                BodyKind::pedestrian, BodyKind::cyclist,    BodyKind::random,
                                BodyKind::random,     BodyKind::random};
  return kinds[draws.below(std::size(kinds))];
}

double drawSpeed(const CastBody& body, RandomDraws& draws)
{
  if (body.kind == BodyKind::pedestrian)
  {
    return draws.uniform(0.6, 2.2);
  }
  if (body.kind == BodyKind::random && draws.chance(0.5))
  {
    return draws.uniform(0.6, 4);
  }
  return std::exp(draws.uniform(std::log(0.6), std::log(18.0)));
}

/** True if the place of a body is occupied by points or by the sensor. */
bool taken(const std::vector<Eigen::Vector3f>& points,
           const Pose& T_sensor_body,
           const CastBody& body)
{
  constexpr float sensor_clearance = 1.4F;  // more than half the width of the sensor's vehicle [m]
  constexpr float clearance = 0.2F;         // margin around the body [m]
  const Eigen::Isometry3f T_body_sensor = T_sensor_body.inverse().cast<float>();
  if (body.covers(T_body_sensor.translation().head<2>(), sensor_clearance))
  {
    return true;
  }
  const Eigen::Vector3f centre = T_sensor_body.translation().cast<float>();
  const float reach = body.radius + 0.3F;
  const float top = std::max(1.0F, body.bounds.max().z());
  int inside = 0;
  for (const auto& p : points)
  {
    if ((p - centre).head<2>().squaredNorm() < reach * reach && p.z() > centre.z() + 0.3F &&
        p.z() < centre.z() + top && body.covers((T_body_sensor * p).head<2>(), clearance))
    {
      ++inside;
    }
  }
  return inside > 4;
}

/** Draws the upright pose of a body in the current sensor frame, z = 0. */
Pose drawPlace(const CastBody& body, bool beside, double farthest, RandomDraws& draws)
{
  if (beside)
  {
    // Right beside the sensor, roughly parallel to the road.
    const double side = draws.chance(0.5) ? 1 : -1;
    const double width = body.bounds.max().y();
    const double along = draws.chance(0.5) ? M_PI : 0;
    const double yaw = along + draws.normal(0.08);
    const double y = side * (width + draws.uniform(1.5, 6));
    return poseFromYpr(draws.uniform(-8, 8), y, 0, yaw, 0, 0);
  }
  // Small distances are more frequent, since most points are there.
  constexpr double nearest = 4;
  const double distance = nearest + (farthest - nearest) * std::pow(draws.uniform(), 1.3);
  const double bearing = draws.uniform(-M_PI, M_PI);
  return poseFromYpr(distance * std::cos(bearing), distance * std::sin(bearing), 0,
                     draws.uniform(-M_PI, M_PI), 0, 0);
}

/** Motion of a body, from the current to the past scan, both poses in the current sensor frame. */
struct BodyMotion
{
  bool moving = false;
  double speed = 0;                    //!< speed over ground [m/s]
  Pose T_now_then = Pose::Identity();  //!< past pose of the body in its current frame
};

BodyMotion drawMotion(const CastBody& body, double moving_share, double elapsed, RandomDraws& draws)
{
  BodyMotion m;
  m.moving = draws.chance(moving_share);
  if (m.moving)
  {
    // The past pose lies behind the current one along the heading, with a turn.
    m.speed = drawSpeed(body, draws);
    const double length = m.speed * elapsed * (draws.chance(0.1) ? -1 : 1);
    m.T_now_then = poseFromYpr(-length, 0, 0, -draws.normal(0.3) * elapsed, 0, 0);
  }
  return m;
}

/** Motion of a body that moves along with the sensor, with a small deviation. */
BodyMotion alongMotion(const DysegSample& sample, const Pose& T_now, RandomDraws& draws)
{
  BodyMotion m;
  const double drift = draws.normal(0.4) * sample.elapsed;
  const Pose T_then_in_now =
      sample.T_past_current.inverse() * poseFromYpr(drift, 0, 0, 0, 0, 0) * T_now;
  m.T_now_then = T_now.inverse() * T_then_in_now;
  m.speed = m.T_now_then.translation().norm() / std::max(sample.elapsed, 1e-3);
  m.moving = true;
  return m;
}

void castOne(const DysegAugmentOptions& options,
             const BevGround& ground_now,
             const BevGround& ground_then,
             bool convoy,
             RandomDraws& draws,
             DysegSample& sample)
{
  const bool beside = draws.chance(convoy ? 0.4 : options.beside_share);
  const CastBody body = makeBody(drawKind(beside, draws), draws);
  Pose T_now = drawPlace(body, beside, options.max_body_distance, draws);
  const bool along = convoy && draws.chance(0.7);
  const BodyMotion motion =
      along ? alongMotion(sample, T_now, draws)
            : drawMotion(body, (beside ? 0.5 : 1) * options.moving_share, sample.elapsed, draws);
  Pose T_then = sample.T_past_current * T_now * motion.T_now_then;
  const auto settle = [](const BevGround& ground, Pose& pose)
  {
    pose.translation().z() = ground.heightAt(static_cast<float>(pose.translation().x()),
                                             static_cast<float>(pose.translation().y()));
    const double yaw = yawPitchRoll(pose).x();
    pose.linear() = expSO3(Eigen::Vector3d(0, 0, yaw));
  };
  settle(ground_now, T_now);
  settle(ground_then, T_then);
  if (taken(sample.current, T_now, body) || taken(sample.past, T_then, body))
  {
    return;
  }
  const auto noise = static_cast<float>(options.range_noise);
  const auto on_body = castBody(body, T_now, noise, draws, sample.current);
  castBody(body, T_then, noise, draws, sample.past);
  const Eigen::Isometry3f flow =
      (motion.moving ? T_then * T_now.inverse() : sample.T_past_current).cast<float>();
  const double displacement =
      (T_then.translation() - sample.T_past_current * T_now.translation()).head<2>().norm();
  const bool shown =
      motion.speed >= min_cast_moving_speed && displacement >= min_visible_displacement;
  const auto label = !motion.moving ? DysegSample::static_point
                     : shown        ? DysegSample::moving_point
                                    : DysegSample::ignored_point;
  for (const auto i : on_body)
  {
    sample.label[i] = label;
    sample.flow[i] = flowOf(flow, sample.current[i]);
  }
  if (label == DysegSample::moving_point && on_body.size() >= min_mover_points)
  {
    sample.movers.push_back(T_now.translation().head<2>().cast<float>());
  }
}

void turnAndMirror(RandomDraws& draws, DysegSample& sample)
{
  const Eigen::Rotation2Dd turn(draws.uniform(-M_PI, M_PI));
  Eigen::Matrix3d full = Eigen::Matrix3d::Identity();
  full.topLeftCorner<2, 2>() = turn.toRotationMatrix();
  if (draws.chance(0.5))
  {
    full.col(1) *= -1;
  }
  const Eigen::Matrix2f change = full.topLeftCorner<2, 2>().cast<float>();
  const auto apply = [&](std::vector<Eigen::Vector3f>& points)
  {
    for (auto& p : points)
    {
      p.head<2>() = (change * p.head<2>()).eval();
    }
  };
  apply(sample.current);
  apply(sample.past);
  for (auto& f : sample.flow)
  {
    f = (change * f).eval();
  }
  for (auto& m : sample.movers)
  {
    m = (change * m).eval();
  }
  sample.T_past_current.linear() = full * sample.T_past_current.linear() * full.transpose();
  sample.T_past_current.translation() = full * sample.T_past_current.translation();
}

void thin(double share, RandomDraws& draws, std::vector<Eigen::Vector3f>& points)
{
  for (auto& p : points)
  {
    if (draws.chance(share))
    {
      p.setZero();
    }
  }
}
}  // namespace

void augment(const DysegAugmentOptions& options, RandomDraws& draws, DysegSample& sample)
{
  if (options.bodies > 0)
  {
    const BevGround ground_now(sample.current);
    const BevGround ground_then(sample.past);
    const bool convoy = draws.chance(options.convoy_share);
    const std::size_t bodies =
        (convoy ? 2 : 1) * draws.below(static_cast<std::size_t>(options.bodies) + 1);
    for (std::size_t i = 0; i < bodies; ++i)
    {
      castOne(options, ground_now, ground_then, convoy, draws, sample);
    }
  }
  turnAndMirror(draws, sample);
  thin(draws.uniform(0, options.dropout), draws, sample.current);
  thin(draws.uniform(0, options.dropout), draws, sample.past);
}
}  // namespace dyslam
