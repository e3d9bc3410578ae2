// SPDX-License-Identifier: BSD-3-Clause
#include "KeyframeRegistration.h"

#include <dyslam/core/Normals.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "GroundHeight.h"

namespace dyslam
{
namespace
{
constexpr std::size_t min_pairs = 50;
constexpr double cell_size = 0.5;   // cell size of the grid seen from above [m]
constexpr float min_height = 0.7F;  // least height above ground of structure [m]
constexpr std::size_t max_structure_points = 1500;

/** Evenly picked points, at most about `limit`. */
template <typename Point>
std::vector<Point> thinned(const std::vector<Point>& points, std::size_t limit)
{
  const std::size_t step = points.size() / limit + 1;
  std::vector<Point> result;
  for (std::size_t i = 0; i < points.size(); i += step)
  {
    result.push_back(points[i]);
  }
  return result;
}

/** Points higher than min_height above ground, evenly picked. */
std::vector<Eigen::Vector2f> structureOf(const std::vector<Eigen::Vector3f>& points,
                                         std::size_t limit)
{
  const float ground = groundHeight(points, 10);
  std::vector<Eigen::Vector2f> all;
  for (const Eigen::Vector3f& p : points)
  {
    if (p.z() > ground + min_height)
    {
      all.emplace_back(p.head<2>());
    }
  }
  return thinned(all, limit);
}

/** Grid of structure seen from above: occupied cells are 2, their neighbours 1. */
class GridFromAbove
{
 public:
  explicit GridFromAbove(const std::vector<Eigen::Vector2f>& points)
  {
    Eigen::Vector2f low = points.front();
    Eigen::Vector2f high = points.front();
    for (const Eigen::Vector2f& p : points)
    {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
    origin_ = low - Eigen::Vector2f::Constant(2 * static_cast<float>(cell_size));
    width_ = cellOf(high.x(), origin_.x()) + 3;
    height_ = cellOf(high.y(), origin_.y()) + 3;
    cells_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), 0);
    for (const Eigen::Vector2f& p : points)
    {
      const int x = cellOf(p.x(), origin_.x());
      const int y = cellOf(p.y(), origin_.y());
      for (int dy = -1; dy <= 1; ++dy)
      {
        for (int dx = -1; dx <= 1; ++dx)
        {
          std::uint8_t& cell = cells_[index(x + dx, y + dy)];
          cell = std::max(cell, static_cast<std::uint8_t>(dx == 0 && dy == 0 ? 2 : 1));
        }
      }
    }
  }

  [[nodiscard]] int score(int x, int y) const
  {
    return x < 0 || y < 0 || x >= width_ || y >= height_ ? 0 : cells_[index(x, y)];
  }
  [[nodiscard]] Eigen::Vector2i cell(const Eigen::Vector2f& p) const
  {
    return {cellOf(p.x(), origin_.x()), cellOf(p.y(), origin_.y())};
  }

 private:
  [[nodiscard]] static int cellOf(float value, float origin)
  {
    return static_cast<int>(std::floor((value - origin) / static_cast<float>(cell_size)));
  }
  [[nodiscard]] std::size_t index(int x, int y) const
  {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(x);
  }

  Eigen::Vector2f origin_ = Eigen::Vector2f::Zero();
  int width_ = 0;
  int height_ = 0;
  std::vector<std::uint8_t> cells_;
};

struct Placement
{
  int score = 0;
  Eigen::Vector2i shift = Eigen::Vector2i::Zero();  //!< offset in cells
};

Placement bestShift(const GridFromAbove& grid, const std::vector<Eigen::Vector2i>& cells, int range)
{
  Placement best;
  for (int dy = -range; dy <= range; ++dy)
  {
    for (int dx = -range; dx <= range; ++dx)
    {
      int score = 0;
      for (const Eigen::Vector2i& c : cells)
      {
        score += grid.score(c.x() + dx, c.y() + dy);
      }
      const Eigen::Vector2i shift(dx, dy);
      if (score > best.score ||
          (score == best.score && shift.squaredNorm() < best.shift.squaredNorm()))
      {
        best = {score, shift};
      }
    }
  }
  return best;
}
}  // namespace

double RegistrationTarget::overlap(const std::vector<Eigen::Vector3f>& source,
                                   const Pose& T_target_source) const
{
  const float ground = groundHeight(source, 10);
  const Eigen::Isometry3f T = T_target_source.cast<float>();
  std::size_t standing = 0;
  std::size_t met = 0;
  for (const Eigen::Vector3f& p : source)
  {
    if (p.z() > ground + min_height)
    {
      Neighbour near;
      ++standing;
      met += tree_.nearest(T * p, near, static_cast<float>(options_.fine_distance)) ? 1 : 0;
    }
  }
  return standing > 0 ? static_cast<double>(met) / static_cast<double>(standing) : 0;
}

RegistrationTarget::RegistrationTarget(std::vector<Eigen::Vector3f> points,
                                       const KeyframeRegistrationOptions& options)
    : options_(options), points_(std::move(points)), tree_(points_)
{
  normals_.assign(points_.size(), Eigen::Vector3f::Constant(NAN));
}

const Eigen::Vector3f& RegistrationTarget::normalAt(std::uint32_t index)
{
  Eigen::Vector3f& normal = normals_[index];
  if (std::isnan(normal.x()))
  {
    tree_.nearest(points_[index], static_cast<std::size_t>(options_.normal_neighbours), neighbours_,
                  static_cast<float>(options_.normal_radius));
    patch_.clear();
    for (const Neighbour& neighbour : neighbours_)
    {
      patch_.push_back(points_[neighbour.index]);
    }
    const LocalShape shape = fitLocalShape(patch_, Eigen::Vector3f::Zero());
    const bool surface = shape.valid() && shape.spread.x() < 0.3F * shape.spread.y();
    normal = surface ? shape.normal : Eigen::Vector3f(Eigen::Vector3f::Zero());
  }
  return normal;
}

void RegistrationTarget::addRow(const Eigen::Vector3d& p,
                                const Pose& T,
                                double gate,
                                NormalEquations& sums)
{
  Neighbour near;
  const Eigen::Vector3d q = T * p;
  if (!tree_.nearest(q.cast<float>(), near, static_cast<float>(gate)))
  {
    return;
  }
  const Eigen::Vector3d n = normalAt(near.index).cast<double>();
  if (n.isZero(0))
  {
    return;
  }
  const double r = n.dot(q - points_[near.index].cast<double>());
  const double width = options_.loss_width * std::max(1.0, gate / options_.fine_distance);
  sums.addRow(n, p, T.linear(), r, gemanMcClureWeight(r * r, width));
  ++sums.inliers;
}

KeyframeRegistrationResult RegistrationTarget::align(const std::vector<Eigen::Vector3f>& all,
                                                     const Pose& T_target_source_initial)
{
  const std::vector<Eigen::Vector3f> source =
      thinned(all, static_cast<std::size_t>(options_.max_points));
  PoseGaussNewtonSettings settings;
  settings.max_iterations = options_.max_iterations;
  settings.start_gate = options_.coarse_distance;
  settings.end_gate = options_.fine_distance;
  settings.gate_decay = 0.85;
  settings.min_inliers = min_pairs;
  settings.converged_step = settings.settled_step;
  ThreadPool one_thread;  // addRow() computes normals and is not thread-safe
  const auto match =
      [&](std::size_t begin, std::size_t end, const Pose& T, double gate, NormalEquations& sums)
  {
    for (std::size_t i = begin; i < end; ++i)
    {
      addRow(source[i].cast<double>(), T, gate, sums);
    }
  };
  const PoseGaussNewtonResult found =
      poseGaussNewton(source.size(), match, T_target_source_initial, settings, one_thread);
  KeyframeRegistrationResult result;
  result.T_target_source = found.T;
  result.iterations = found.iterations;
  result.converged = found.converged;
  const NormalEquations& sums = found.equations;
  if (sums.weight <= 0)
  {
    return result;
  }
  result.overlap = overlap(source, result.T_target_source);
  result.rmse = std::sqrt(sums.error / sums.weight);
  const Eigen::Vector3d strengths =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(sums.H.topLeftCorner<3, 3>()).eigenvalues();
  result.observability = strengths[0] / strengths[2];
  const double sigma = std::max(result.rmse, options_.noise_floor);
  Vector6 floor;
  floor << Eigen::Vector3d::Constant(options_.sigma_translation * options_.sigma_translation),
      Eigen::Vector3d::Constant(options_.sigma_rotation * options_.sigma_rotation);
  Matrix6 covariance =
      sigma * sigma * (sums.H + 1e-6 * sums.weight * Matrix6::Identity()).inverse();
  covariance.diagonal() += floor;
  result.information = covariance.inverse();
  result.information = 0.5 * (result.information + result.information.transpose()).eval();
  return result;
}

std::optional<Pose> correlateFromAbove(const std::vector<Eigen::Vector3f>& source,
                                       const std::vector<Eigen::Vector3f>& target,
                                       const Pose& T_target_source_initial,
                                       double range,
                                       double heading_range)
{
  if (source.empty() || target.empty())
  {
    return std::nullopt;
  }
  const std::vector<Eigen::Vector2f> above = structureOf(source, max_structure_points);
  const std::vector<Eigen::Vector2f> base = structureOf(target, target.size() + 1);
  if (above.size() < 20 || base.size() < 20)
  {
    return std::nullopt;
  }
  const GridFromAbove grid(base);
  const double initial_heading = yawPitchRoll(T_target_source_initial).x();
  const Eigen::Vector2f offset = T_target_source_initial.translation().head<2>().cast<float>();
  constexpr double heading_step = 0.035;
  const int headings = static_cast<int>(std::ceil(heading_range / heading_step));
  Placement best;
  double best_heading = initial_heading;
  std::vector<Eigen::Vector2i> cells(above.size());
  for (int k = -headings; k <= headings; ++k)
  {
    const double heading = initial_heading + k * heading_step;
    const Eigen::Rotation2Df turn(static_cast<float>(heading));
    for (std::size_t i = 0; i < above.size(); ++i)
    {
      cells[i] = grid.cell(turn * above[i] + offset);
    }
    const Placement placement =
        bestShift(grid, cells, static_cast<int>(std::ceil(range / cell_size)));
    if (placement.score > best.score)
    {
      best = placement;
      best_heading = heading;
    }
  }
  if (best.score == 0)
  {
    return std::nullopt;
  }
  Pose pose = T_target_source_initial;
  pose.linear() =
      Eigen::AngleAxisd(best_heading - initial_heading, Eigen::Vector3d::UnitZ()) * pose.linear();
  pose.translation().head<2>() += cell_size * best.shift.cast<double>();
  return pose;
}
}  // namespace dyslam
