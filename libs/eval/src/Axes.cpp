// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/eval/Axes.h>

#include <cmath>

namespace dyslam
{
namespace
{
constexpr double shortest_motion = 1.0;  //!< shorter motions are mostly noise [m]

Eigen::Vector3d motion(const std::vector<Pose>& poses, std::size_t from, std::size_t to)
{
  return (poses[from].inverse() * poses[to]).translation();
}
}  // namespace

BodyAxes compareBodyAxes(const PosePairs& pairs)
{
  Eigen::Matrix3d lidar_from_camera;
  lidar_from_camera << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  double lengths = 0, difference = 0, products = 0, plain = 0;
  double estimate = 0, estimate_ahead = 0, reference = 0, reference_ahead = 0;
  std::size_t from = 0;
  for (std::size_t i = 1; i < pairs.size(); ++i)
  {
    const Eigen::Vector3d r = motion(pairs.reference, from, i);
    const Eigen::Vector3d e = motion(pairs.estimate, from, i);
    if (r.norm() < shortest_motion)
    {
      continue;
    }
    from = i;
    lengths += r.norm();
    difference += std::abs(r.norm() - e.norm());
    products += r.norm() * e.norm();
    plain += r.dot(e);
    estimate += r.dot(lidar_from_camera * e);
    estimate_ahead += r.norm() * e.z();
    reference += e.dot(lidar_from_camera * r);
    reference_ahead += e.norm() * r.z();
  }
  constexpr double unlike = 0.5;
  constexpr double alike = 0.9;
  constexpr double same_length = 0.2;
  if (!(products > 0) || plain >= unlike * products || difference > same_length * lengths)
  {
    return BodyAxes::same;
  }
  const auto ofCamera = [&](double turned, double ahead)
  { return turned > alike * products && ahead > alike * products; };
  return ofCamera(estimate, estimate_ahead)     ? BodyAxes::estimate_camera
         : ofCamera(reference, reference_ahead) ? BodyAxes::reference_camera
                                                : BodyAxes::differ;
}
}  // namespace dyslam
