// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/nets/MotionVote.h>

#include <algorithm>
#include <cmath>

namespace dyslam
{
namespace
{
/** Share of the cells that follow no common motion, whatever their windows say. */
constexpr float outliers = 0.2F;

/** Where the best of three equidistant values lies between them, in [-0.5, 0.5]. */
double vertex(double before, double at, double after)
{
  const double bend = before - 2 * at + after;
  return bend < -1e-9 ? std::clamp(0.5 * (before - after) / bend, -0.5, 0.5) : 0;
}

class Vote
{
 public:
  explicit Vote(const OffsetWindows& windows)
      : windows_(windows),
        side_(2 * windows.radius + 1),
        bins_(static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_))
  {
    const float floor = outliers / static_cast<float>(bins_);
    loss_of_none_ = std::log(floor);
    score_.resize(windows.places.size() * bins_);
    for (std::size_t k = 0; k < score_.size(); ++k)
    {
      score_[k] = std::log((1 - outliers) * std::exp(windows.log_probability[k]) + floor);
    }
  }

  /** Scores of all translations, in cells from the centre's, for one change of yaw. */
  [[nodiscard]] std::vector<double> scores(double yaw_before, double change) const
  {
    std::vector<double> total(bins_, 0.0);
    const Eigen::Matrix2f turn = (Eigen::Rotation2Dd(yaw_before + change).toRotationMatrix() -
                                  Eigen::Rotation2Dd(yaw_before).toRotationMatrix())
                                     .cast<float>();
    for (std::size_t i = 0; i < windows_.places.size(); ++i)
    {
      if (windows_.trust[i] > 1e-3F)
      {
        addCell(i, turn * windows_.places[i] / windows_.cell_size, total);
      }
    }
    return total;
  }

  [[nodiscard]] int side() const { return side_; }

 private:
  /** \param shift of the cell's window by the turn [cells] */
  void addCell(std::size_t i, const Eigen::Vector2f& shift, std::vector<double>& total) const
  {
    const float* window = score_.data() + i * bins_;
    const int x0 = static_cast<int>(std::floor(shift.x()));
    const int y0 = static_cast<int>(std::floor(shift.y()));
    const float fx = shift.x() - static_cast<float>(x0);
    const float fy = shift.y() - static_cast<float>(y0);
    const auto at = [&](int x, int y)
    { return x >= 0 && y >= 0 && x < side_ && y < side_ ? window[y * side_ + x] : loss_of_none_; };
    const float trust = windows_.trust[i];
    for (int y = 0; y < side_; ++y)
    {
      for (int x = 0; x < side_; ++x)
      {
        const int u = x + x0;
        const int v = y + y0;
        const float value = (1 - fy) * ((1 - fx) * at(u, v) + fx * at(u + 1, v)) +
                            fy * ((1 - fx) * at(u, v + 1) + fx * at(u + 1, v + 1));
        total[static_cast<std::size_t>(y * side_ + x)] += static_cast<double>(trust * value);
      }
    }
  }

  const OffsetWindows& windows_;
  int side_;
  std::size_t bins_;
  float loss_of_none_ = 0;
  std::vector<float> score_;
};
}  // namespace

PlanarMotion voteMotion(const OffsetWindows& windows,
                        const PlanarMotion& centre,
                        double yaw_step,
                        int yaw_steps)
{
  const Vote vote(windows);
  const int side = vote.side();
  std::vector<double> best;
  std::vector<double> best_of_yaw;
  std::size_t place = 0;
  int turn = -yaw_steps;
  for (int k = -yaw_steps; k <= yaw_steps; ++k)
  {
    auto scores = vote.scores(centre.yaw, k * yaw_step);
    const auto top = std::max_element(scores.begin(), scores.end());
    best_of_yaw.push_back(*top);
    if (best.empty() || *top > best[place])
    {
      place = static_cast<std::size_t>(top - scores.begin());
      best = std::move(scores);
      turn = k;
    }
  }
  const int x = static_cast<int>(place) % side;
  const int y = static_cast<int>(place) / side;
  const auto at = [&](int u, int v)
  {
    return best[static_cast<std::size_t>(std::clamp(v, 0, side - 1) * side +
                                         std::clamp(u, 0, side - 1))];
  };
  Eigen::Vector2d offset(x - windows.radius, y - windows.radius);
  offset.x() += vertex(at(x - 1, y), at(x, y), at(x + 1, y));
  offset.y() += vertex(at(x, y - 1), at(x, y), at(x, y + 1));
  PlanarMotion motion = centre;
  motion.translation += static_cast<double>(windows.cell_size) * offset;
  motion.yaw += turn * yaw_step;
  const auto k = static_cast<std::size_t>(turn + yaw_steps);
  if (k > 0 && k + 1 < best_of_yaw.size())
  {
    motion.yaw += yaw_step * vertex(best_of_yaw[k - 1], best_of_yaw[k], best_of_yaw[k + 1]);
  }
  return motion;
}
}  // namespace dyslam
