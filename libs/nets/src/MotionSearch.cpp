// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/nets/MotionSearch.h>

#include <algorithm>
#include <cmath>

namespace dyslam
{
namespace
{
/** Prior probability that a cell is an outlier. */
constexpr float outlier_probability = 0.2F;
constexpr float min_weight = 0.01F;

/** Vertex of the parabola through three equidistant values, in [-0.5, 0.5]. */
double parabolaVertex(double before, double at, double after)
{
  const double curvature = before - 2 * at + after;
  return curvature < -1e-9 ? std::clamp(0.5 * (before - after) / curvature, -0.5, 0.5) : 0;
}

/** Best score more than one cell away from (x, y); at least 0. */
float bestElsewhere(const Eigen::ArrayXf& scores, int side, int x, int y)
{
  float best = 0;
  for (int v = 0; v < side; ++v)
  {
    for (int u = 0; u < side; ++u)
    {
      if (std::max(std::abs(u - x), std::abs(v - y)) > 1)
      {
        best = std::max(best, scores[v * side + u]);
      }
    }
  }
  return best;
}

class MotionLikelihood
{
 public:
  explicit MotionLikelihood(const OffsetWindows& windows)
      : windows_(windows), side_(2 * windows.radius + 1), bins_(side_ * side_)
  {
    // Likelihood ratio to an outlier, whose offset is uniform in the window.
    const float gain =
        (1 - outlier_probability) / (outlier_probability / static_cast<float>(bins_));
    const auto count = static_cast<Eigen::Index>(windows.positions.size()) * bins_;
    score_ = (gain * Eigen::Map<const Eigen::ArrayXf>(windows.probability, count)).log1p();
  }

  /** Log-likelihoods of all translations of the grid, for one change of yaw [rad]. */
  [[nodiscard]] Eigen::ArrayXf scores(double yaw_before, double change) const
  {
    Eigen::ArrayXf total = Eigen::ArrayXf::Zero(bins_);
    const Eigen::Matrix2f turn = (Eigen::Rotation2Dd(yaw_before + change).toRotationMatrix() -
                                  Eigen::Rotation2Dd(yaw_before).toRotationMatrix())
                                     .cast<float>();
    for (std::size_t i = 0; i < windows_.positions.size(); ++i)
    {
      if (windows_.weights[i] > min_weight)
      {
        addCell(i, turn * windows_.positions[i] / windows_.cell_size, total);
      }
    }
    return total;
  }

  [[nodiscard]] int side() const { return side_; }

 private:
  /** Adds the log-likelihoods of a cell. \param shift shift of the cell's window by the rotation
   * [cells] */
  void addCell(std::size_t i, const Eigen::Vector2f& shift, Eigen::ArrayXf& total) const
  {
    const int x0 = static_cast<int>(std::floor(shift.x()));
    const int y0 = static_cast<int>(std::floor(shift.y()));
    const float fx = shift.x() - static_cast<float>(x0);
    const float fy = shift.y() - static_cast<float>(y0);
    const float weights = windows_.weights[i];
    for (const int dy : {0, 1})
    {
      for (const int dx : {0, 1})
      {
        const float weight = weights * (dx == 1 ? fx : 1 - fx) * (dy == 1 ? fy : 1 - fy);
        if (weight > 0)
        {
          addShifted(i, x0 + dx, y0 + dy, weight, total);
        }
      }
    }
  }
  void addShifted(std::size_t i, int x, int y, float weight, Eigen::ArrayXf& total) const
  {
    const int first = std::max(0, -x);
    const int count = side_ - std::abs(x);
    for (int v = std::max(0, -y); v < std::min(side_, side_ - y) && count > 0; ++v)
    {
      total.segment(v * side_ + first, count) +=
          weight *
          score_.segment(static_cast<Eigen::Index>(i) * bins_ + (v + y) * side_ + first + x, count);
    }
  }

  const OffsetWindows& windows_;
  int side_;
  int bins_;
  Eigen::ArrayXf score_;
};
}  // namespace

MotionSearchResult searchMotion(const OffsetWindows& windows,
                                const PlanarMotion& centre,
                                double yaw_step,
                                int yaw_steps)
{
  const MotionLikelihood likelihood(windows);
  const int side = likelihood.side();
  Eigen::ArrayXf best;
  std::vector<double> best_of_yaw;
  int place = 0;
  int turn = -yaw_steps;
  for (int k = -yaw_steps; k <= yaw_steps; ++k)
  {
    Eigen::ArrayXf scores = likelihood.scores(centre.yaw, k * yaw_step);
    Eigen::Index top = 0;
    const float score = scores.maxCoeff(&top);
    best_of_yaw.push_back(static_cast<double>(score));
    if (best.size() == 0 || score > best[place])
    {
      place = static_cast<int>(top);
      best = std::move(scores);
      turn = k;
    }
  }
  if (!(best[place] > 0))  // no cell votes
  {
    return {centre};
  }
  const int x = place % side;
  const int y = place / side;
  const auto at = [&](int u, int v)
  {
    return static_cast<double>(
        best[std::clamp(v, 0, side - 1) * side + std::clamp(u, 0, side - 1)]);
  };
  Eigen::Vector2d offset(x - windows.radius, y - windows.radius);
  offset.x() += parabolaVertex(at(x - 1, y), at(x, y), at(x + 1, y));
  offset.y() += parabolaVertex(at(x, y - 1), at(x, y), at(x, y + 1));
  MotionSearchResult found;
  found.margin = 1 - static_cast<double>(bestElsewhere(best, side, x, y) / best[place]);
  PlanarMotion& motion = found.motion;
  motion = centre;
  motion.translation += static_cast<double>(windows.cell_size) * offset;
  motion.yaw += turn * yaw_step;
  const auto k = static_cast<std::size_t>(turn + yaw_steps);
  if (k > 0 && k + 1 < best_of_yaw.size())
  {
    motion.yaw += yaw_step * parabolaVertex(best_of_yaw[k - 1], best_of_yaw[k], best_of_yaw[k + 1]);
  }
  return found;
}
}  // namespace dyslam
