// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/eval/Axes.h>

#include <cmath>

namespace dyslam
{
namespace
{
constexpr double shortest_motion = 1.0;  //!< shorter motions are mostly noise [m]
constexpr double alike = 0.9;            //!< least mean cosine of motions in the same direction

Eigen::Vector3d motion(const std::vector<Pose>& poses, std::size_t from, std::size_t to)
{
  return (poses[from].inverse() * poses[to]).translation();
}
/** Sums over the motions of a body. */
struct OwnMotion
{
  double length = 0;
  double along_x = 0;
  double along_z = 0;

  void add(const Eigen::Vector3d& motion)
  {
    length += motion.norm();
    along_x += motion.x();
    along_z += motion.z();
  }
  [[nodiscard]] bool isLidar() const { return length > 0 && along_x > alike * length; }
  [[nodiscard]] bool isCamera() const { return length > 0 && along_z > alike * length; }
};
}  // namespace

BodyAxes compareBodyAxes(const PosePairs& pairs)
{
  Eigen::Matrix3d lidar_from_camera;
  lidar_from_camera << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  double lengths = 0, difference = 0, products = 0, plain = 0;
  double estimate = 0, estimate_ahead = 0, reference = 0, reference_ahead = 0;
  OwnMotion of_estimate;
  OwnMotion of_reference;
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
    of_reference.add(r);
    of_estimate.add(e);
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
  constexpr double same_length = 0.2;
  if (!(products > 0) || plain >= unlike * products)
  {
    return BodyAxes::same;
  }
  if (difference > same_length * lengths)
  {
    return of_estimate.isCamera() && of_reference.isLidar()   ? BodyAxes::estimate_camera
           : of_reference.isCamera() && of_estimate.isLidar() ? BodyAxes::reference_camera
                                                              : BodyAxes::same;
  }
  const auto ofCamera = [&](double turned, double ahead)
  { return turned > alike * products && ahead > alike * products; };
  return ofCamera(estimate, estimate_ahead)     ? BodyAxes::estimate_camera
         : ofCamera(reference, reference_ahead) ? BodyAxes::reference_camera
                                                : BodyAxes::differ;
}
}  // namespace dyslam
