// SPDX-License-Identifier: BSD-3-Clause
// The ego on the closed path of a campus, a field or a building.
#include <algorithm>
#include <cmath>

#include "Traffic.h"

namespace dyslam::sim
{
namespace
{
/** The ego on a closed path. */
class PathEgo : public Crowd::Group
{
 public:
  explicit PathEgo(Crowd& crowd)
      : crowd_(crowd), rng_(combine(crowd.options().trafficSeed(), 0xE605))
  {
    s_ = crowd.options().start_fraction * crowd.world().ego_path.length();
    next_stop_ = rng_.uniform(15, 40);
    place();
  }

  void step(double dt) override
  {
    const Path& path = crowd_.world().ego_path;
    double desired_speed = egoCruise(crowd_.world(), crowd_.options());
    if (crowd_.options().stops && crowd_.time() > next_stop_)
    {
      stop_until_ = crowd_.time() + rng_.uniform(1.5, 5);
      next_stop_ = stop_until_ + rng_.uniform(20, 60);
    }
    desired_speed = crowd_.time() < stop_until_ ? 0 : desired_speed;
    const double heading_change =
        std::abs(wrapToPi(path.at(s_ + 1.5 * sense()).heading - path.at(s_).heading));
    if (heading_change > 0.2)
    {
      const double in_corners = std::max(0.6, 0.5 * egoCruise(crowd_.world(), crowd_.options()));
      desired_speed = std::min(desired_speed, in_corners);
    }
    const auto gap =
        bodyAhead(crowd_, -1, crowd_.ego().position, crowd_.ego().yaw, 0.45, 2.5 + 1.5 * v_);
    if (gap && stuck_ < 5)
    {
      desired_speed = std::min(desired_speed, std::max(0.0, 0.8 * (*gap - 1.0)));
    }
    stuck_ = v_ < 0.1 && gap ? stuck_ + dt : std::max(0.0, stuck_ - 0.5 * dt);
    v_ = std::max(0.0, v_ + std::clamp(desired_speed - v_, -1.8 * dt, 0.9 * dt));
    s_ += sense() * v_ * dt;
    place();
  }

 private:
  /** 1 along the path, -1 the other way. */
  double sense() const { return crowd_.options().reverse ? -1 : 1; }

  void place()
  {
    const Path& path = crowd_.world().ego_path;
    const auto front = path.at(s_ + 0.4 * sense()), back = path.at(s_ - 0.4 * sense());
    const Eigen::Vector2d d = front.position - back.position;
    crowd_.ego() = {0.5 * (front.position + back.position), std::atan2(d.y(), d.x()), v_};
  }

  Crowd& crowd_;
  Rng rng_;
  double s_ = 0, v_ = 0, next_stop_ = 0, stop_until_ = 0, stuck_ = 0;
};
}  // namespace

std::unique_ptr<Crowd::Group> makePathEgo(Crowd& crowd)
{
  return std::make_unique<PathEgo>(crowd);
}
}  // namespace dyslam::sim
