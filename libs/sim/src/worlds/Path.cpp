// SPDX-License-Identifier: BSD-3-Clause
#include "Path.h"

#include <algorithm>
#include <cmath>

namespace dyslam::sim
{
double wrapToPi(double angle)
{
  constexpr double kTau = 2 * M_PI;
  angle = std::fmod(angle, kTau);
  if (angle > kTau / 2)
  {
    angle -= kTau;
  }
  return angle <= -kTau / 2 ? angle + kTau : angle;
}

Path::Path(const std::vector<Eigen::Vector2d>& points, bool closed) : closed_(closed)
{
  for (const auto& p : points)
  {
    if (points_.empty() || (p - points_.back()).norm() > 1e-6)
    {
      points_.push_back(p);
    }
  }
  if (closed && points_.size() > 1 && (points_.front() - points_.back()).norm() > 1e-6)
  {
    points_.push_back(points_.front());
  }
  for (std::size_t i = 0; i < points_.size(); ++i)
  {
    length_ += i == 0 ? 0.0 : (points_[i] - points_[i - 1]).norm();
    s_.push_back(length_);
  }
}

Path::Sample Path::at(double s) const
{
  if (points_.size() < 2)
  {
    return {points_.empty() ? Eigen::Vector2d::Zero() : points_.front(), 0};
  }
  if (closed_)
  {
    s -= length_ * std::floor(s / length_);
  }
  s = std::clamp(s, 0.0, length_);
  const auto next = std::upper_bound(s_.begin() + 1, s_.end() - 1, s);
  const auto i = static_cast<std::size_t>(next - s_.begin());
  const Eigen::Vector2d d = points_[i] - points_[i - 1];
  const double span = s_[i] - s_[i - 1];
  const double f = (s - s_[i - 1]) / span;
  // Headings are interpolated between segments, for continuous yaw.
  const auto direction = [&](std::size_t k)
  { return std::atan2(points_[k].y() - points_[k - 1].y(), points_[k].x() - points_[k - 1].x()); };
  const double here = std::atan2(d.y(), d.x());
  double heading = here;
  const std::size_t last = points_.size() - 1;
  if (f < 0.5 && (i > 1 || closed_))
  {
    heading += (0.5 - f) * wrapToPi(direction(i > 1 ? i - 1 : last) - here);
  }
  else if (f >= 0.5 && (i < last || closed_))
  {
    heading += (f - 0.5) * wrapToPi(direction(i < last ? i + 1 : 1) - here);
  }
  return {points_[i - 1] + f * d, heading};
}

std::vector<Eigen::Vector2d> bezier(const Eigen::Vector2d& from,
                                    double from_heading,
                                    const Eigen::Vector2d& to,
                                    double to_heading,
                                    int count)
{
  const double reach =
      0.39 * (to - from).norm() * (1 + 0.4 * std::abs(wrapToPi(to_heading - from_heading)) / 1.57);
  const Eigen::Vector2d a =
      from + reach * Eigen::Vector2d(std::cos(from_heading), std::sin(from_heading));
  const Eigen::Vector2d b =
      to - reach * Eigen::Vector2d(std::cos(to_heading), std::sin(to_heading));
  std::vector<Eigen::Vector2d> points;
  for (int i = 0; i <= count; ++i)
  {
    const double t = static_cast<double>(i) / count, u = 1 - t;
    points.push_back(u * u * u * from + 3 * u * u * t * a + 3 * u * t * t * b + t * t * t * to);
  }
  return points;
}

std::vector<Eigen::Vector2d> roundedCorners(const std::vector<Eigen::Vector2d>& points,
                                            double radius,
                                            double step,
                                            bool closed)
{
  std::vector<Eigen::Vector2d> out;
  const std::size_t n = points.size();
  for (std::size_t i = 0; i < n; ++i)
  {
    if (!closed && (i == 0 || i + 1 == n))
    {
      out.push_back(points[i]);
      continue;
    }
    const Eigen::Vector2d &before = points[(i + n - 1) % n], &here = points[i],
                          &after = points[(i + 1) % n];
    const double la = (here - before).norm(), lb = (after - here).norm();
    const double cut = std::min({radius, 0.49 * la, 0.49 * lb});
    if (cut < 1e-6)
    {
      out.push_back(here);
      continue;
    }
    const Eigen::Vector2d ua = (here - before) / la, ub = (after - here) / lb;
    const auto arc = bezier(here - cut * ua, std::atan2(ua.y(), ua.x()), here + cut * ub,
                            std::atan2(ub.y(), ub.x()), kTurnPoints);
    out.insert(out.end(), arc.begin(), arc.end());
  }
  // Resampled: the heading interpolation requires segments of similar length.
  const Path rough(out, closed);
  const int count = std::max(2, static_cast<int>(std::ceil(rough.length() / step)));
  std::vector<Eigen::Vector2d> even;
  for (int i = 0; i < (closed ? count : count + 1); ++i)
  {
    even.push_back(rough.at(rough.length() * i / count).position);
  }
  return even;
}
}  // namespace dyslam::sim
