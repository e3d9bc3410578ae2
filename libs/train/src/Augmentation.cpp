// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/formats/LabelFiles.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/nets/PreparedScan.h>
#include <dyslam/train/Augmentation.h>
#include <dyslam/train/ScanFiles.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>

namespace dyslam
{
namespace
{
/** Nearest range of a body by direction, widened by a cell, to hide what lies behind. */
class Shadow
{
 public:
  explicit Shadow(const std::vector<Eigen::Vector3f>& body)
      : range_(static_cast<std::size_t>(rows * cols), std::numeric_limits<float>::max())
  {
    for (const Eigen::Vector3f& p : body)
    {
      const auto [row, col] = cell(p);
      for (int i = std::max(0, row - 1); i <= std::min(rows - 1, row + 1); ++i)
      {
        for (int j = col - 1; j <= col + 1; ++j)
        {
          float& nearest = range_[static_cast<std::size_t>(i * cols + (j + cols) % cols)];
          nearest = std::min(nearest, p.norm());
        }
      }
    }
  }

  [[nodiscard]] bool hides(const Eigen::Vector3f& p) const
  {
    const auto [row, col] = cell(p);
    return p.norm() > range_[static_cast<std::size_t>(row * cols + col)] + 0.1F;
  }

 private:
  static constexpr int rows = 80;
  static constexpr int cols = 720;

  static std::pair<int, int> cell(const Eigen::Vector3f& p)
  {
    const float slope = p.z() / std::max(std::hypot(p.x(), p.y()), 1e-3F);
    return {static_cast<int>(std::clamp((slope + 0.5F) * rows, 0.F, rows - 1.F)),
            imageColumn(p.x(), p.y(), cols)};
  }

  std::vector<float> range_;
};

void hideBehind(const Body& body, std::vector<Eigen::Vector3f>& points)
{
  if (body.empty())
  {
    return;
  }
  const Shadow shadow(body);
  for (Eigen::Vector3f& p : points)
  {
    if (p.allFinite() && shadow.hides(p))
    {
      p.setConstant(std::numeric_limits<float>::quiet_NaN());
    }
  }
}

void moveAll(const Pose& motion, std::vector<Eigen::Vector3f>& points)
{
  const Eigen::Isometry3f m = motion.cast<float>();
  for (Eigen::Vector3f& p : points)
  {
    p = m * p;
  }
}

void mirrorPair(TrainingPair& pair)
{
  for (auto* points : {&pair.points1, &pair.points2})
  {
    for (Eigen::Vector3f& p : *points)
    {
      p.y() = -p.y();
    }
  }
  const Eigen::Vector3d flip(1, -1, 1);
  pair.T_2_1.linear() = flip.asDiagonal() * pair.T_2_1.linear() * flip.asDiagonal();
  pair.T_2_1.translation().y() *= -1;
}

void disturb(double noise, double dropout, RandomDraws& draws, std::vector<Eigen::Vector3f>& points)
{
  for (Eigen::Vector3f& p : points)
  {
    if (!p.allFinite())
    {
      continue;
    }
    if (draws.chance(dropout))
    {
      p.setConstant(std::numeric_limits<float>::quiet_NaN());
      continue;
    }
    // A sum of uniform numbers is approximately normal, and cheap.
    const double error = noise * 1.225 * (draws.uniform(-1, 1) + draws.uniform(-1, 1));
    p *= 1 + static_cast<float>(error) / std::max(p.norm(), 0.5F);
  }
}

/** Keeps every `keep`-th beam of a sensor with many. */
void thinBeams(int keep, int offset, std::vector<Eigen::Vector3f>& points)
{
  constexpr int many = 32;
  const PreparedScan scan = prepareScan(points);
  if (scan.rows < many)
  {
    return;
  }
  for (Eigen::Vector3f& p : points)
  {
    const float slope = p.z() / std::max(std::hypot(p.x(), p.y()), 1e-3F);
    if (p.allFinite() &&
        scan.row_of_slope[static_cast<std::size_t>(slopeBin(slope))] % keep != offset)
    {
      p.setConstant(std::numeric_limits<float>::quiet_NaN());
    }
  }
}

void pasteBodies(const AugmentationOptions& options,
                 const std::vector<Body>& bodies,
                 RandomDraws& draws,
                 TrainingPair& pair)
{
  const std::size_t count = 1 + draws.below(static_cast<std::size_t>(options.max_bodies));
  const bool jam = draws.chance(options.co_moving / 2);
  const double step = pair.T_2_1.translation().norm();
  for (std::size_t i = 0; i < count; ++i)
  {
    Body body = bodies[draws.below(bodies.size())];
    const Pose turn = poseFromYpr(0, 0, 0, draws.uniform(-M_PI, M_PI), 0, 0);
    moveAll(turn, body);
    const double kind = draws.uniform();
    Pose T_2_1_body = pair.T_2_1;
    PointLabel label = PointLabel::still;
    if (jam || kind < options.co_moving)
    {
      // Moves with the ego-vehicle, approximately.
      const auto [x, y, yaw] = draws.normals<3>({0.02, 0.01, 0.002});
      T_2_1_body = poseFromYpr(x, y, 0, yaw, 0, 0);
      label = (pair.T_2_1.translation() - T_2_1_body.translation()).norm() > 0.05
                  ? PointLabel::moving
                  : PointLabel::unknown;
    }
    else if (kind < 0.85)
    {
      // Moves over ground: along, against or across, by up to twice the ego's step.
      const double heading =
          draws.chance(0.7) ? (draws.chance(0.5) ? 0 : M_PI) : draws.uniform(-M_PI, M_PI);
      const double length = draws.uniform(0.05, 2 * step + 0.3);
      const Eigen::Vector3d moved(length * std::cos(heading), length * std::sin(heading), 0);
      T_2_1_body = pair.T_2_1 * Eigen::Translation3d(-moved);
      label = PointLabel::moving;
    }
    pasteBody(body, T_2_1_body, label, pair);
  }
}
}  // namespace

void AugmentationOptions::describe(OptionsVisitor& visitor)
{
  visitor.real("translation", translation, 0, 5,
               "standard deviation of the augmenting motion's translation along x [m]");
  visitor.degrees("yaw_deg", yaw, 0, 45, "standard deviation of the augmenting motion's yaw [deg]");
  visitor.real("mirror", mirror, 0, 1, "probability that a pair is mirrored");
  visitor.real("turned", turned, 0, 1, "probability that a pair is turned to a random heading");
  visitor.real("range_noise", range_noise, 0, 1,
               "largest standard deviation of added range noise [m]");
  visitor.real("point_dropout", point_dropout, 0, 1,
               "largest share of a scan's points that is left out");
  visitor.real("beam_dropout", beam_dropout, 0, 1,
               "probability that only every 2nd or 4th beam is kept");
  visitor.real("bodies", bodies, 0, 1,
               "probability that bodies are pasted into a pair that is not simulated");
  visitor.integer("max_bodies", max_bodies, 1, 100, "most bodies pasted into a pair");
  visitor.real("co_moving", co_moving, 0, 1,
               "share of pasted bodies that move with the ego-vehicle");
}

std::vector<Body> loadBodies(const std::string& folder, std::size_t min_points)
{
  std::vector<Body> bodies;
  for (const std::string& file : listBinFiles(folder))
  {
    const auto label_file = std::filesystem::path(file).replace_extension(".label");
    if (!std::filesystem::exists(label_file))
    {
      continue;
    }
    const std::vector<Eigen::Vector3f> points =
        readTrainingPoints(file, std::numeric_limits<float>::quiet_NaN());
    const std::vector<Label> labels = readLabels(label_file.string(), points.size());
    std::map<std::uint32_t, Body> instances;
    for (std::size_t i = 0; i < points.size(); ++i)
    {
      if (semanticOf(labels[i]) == 252 && points[i].allFinite())
      {
        instances[instanceOf(labels[i])].push_back(points[i]);
      }
    }
    for (auto& [number, body] : instances)
    {
      if (body.size() >= min_points)
      {
        bodies.push_back(std::move(body));
      }
    }
  }
  return bodies;
}

void pasteBody(const Body& body, const Pose& T_2_1_body, PointLabel label, TrainingPair& pair)
{
  Body earlier = body;
  moveAll(T_2_1_body, earlier);
  hideBehind(body, pair.points1);
  hideBehind(earlier, pair.points2);
  pair.points1.insert(pair.points1.end(), body.begin(), body.end());
  pair.points2.insert(pair.points2.end(), earlier.begin(), earlier.end());
  pair.labels1.resize(pair.points1.size(), label);
}

void augment(const AugmentationOptions& options,
             const std::vector<Body>& bodies,
             RandomDraws& draws,
             TrainingPair& pair)
{
  pair.labels1.resize(pair.points1.size(), PointLabel::unknown);
  if (draws.chance(options.turned))
  {
    const Pose turn = poseFromYpr(0, 0, 0, draws.uniform(-M_PI, M_PI), 0, 0);
    moveAll(turn, pair.points1);
    moveAll(turn, pair.points2);
    pair.T_2_1 = turn * pair.T_2_1 * turn.inverse();
  }
  if (!bodies.empty() && draws.chance(options.bodies))
  {
    pasteBodies(options, bodies, draws, pair);
  }
  if (draws.chance(options.mirror))
  {
    mirrorPair(pair);
  }
  if (draws.chance(options.beam_dropout))
  {
    const int keep = draws.chance(0.5) ? 2 : 4;
    const int offset = static_cast<int>(draws.below(static_cast<std::size_t>(keep)));
    thinBeams(keep, offset, pair.points1);
    thinBeams(keep, offset, pair.points2);
  }
  const double noise = draws.uniform(0, options.range_noise);
  const double dropout = draws.uniform(0, options.point_dropout);
  disturb(noise, dropout, draws, pair.points1);
  disturb(noise, dropout, draws, pair.points2);
  const double t = options.translation;
  const auto [x, y, z, yaw, pitch, roll] =
      draws.normals<6>({t, t / 2, t / 4, options.yaw, options.yaw / 3, options.yaw / 3});
  const Pose T_aug = poseFromYpr(x, y, z, yaw, pitch, roll);
  moveAll(T_aug, pair.points1);
  pair.T_2_1 = pair.T_2_1 * T_aug.inverse();
}
}  // namespace dyslam
