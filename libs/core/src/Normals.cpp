// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Normals.h>

#include <Eigen/Eigenvalues>

namespace dyslam
{
LocalShape fitLocalShape(const std::vector<Eigen::Vector3f>& points,
                         const Eigen::Vector3f& viewpoint)
{
  LocalShape shape;
  if (points.size() < 3)
  {
    return shape;
  }
  const auto count = static_cast<double>(points.size());
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3f& p : points)
  {
    mean += p.cast<double>();
  }
  mean /= count;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3f& p : points)
  {
    const Eigen::Vector3d d = p.cast<double>() - mean;
    covariance += d * d.transpose();
  }
  covariance /= count;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(covariance);
  const Eigen::Vector3d variance = solver.eigenvalues().cwiseMax(0.0);
  shape.mean = mean.cast<float>();
  shape.spread = variance.cwiseSqrt().cast<float>();
  // A line has no normal: the two small eigenvalues cannot be told apart.
  if (variance[1] <= 1e-6 * variance[2])
  {
    return shape;
  }
  Eigen::Vector3d normal = solver.eigenvectors().col(0).normalized();
  if (normal.dot(viewpoint.cast<double>() - mean) < 0)
  {
    normal = -normal;
  }
  shape.normal = normal.cast<float>();
  return shape;
}

std::vector<LocalShape> estimateNormals(const std::vector<Eigen::Vector3f>& points,
                                        const KdTree& tree,
                                        std::size_t k,
                                        float max_distance,
                                        const Eigen::Vector3f& viewpoint,
                                        ThreadPool& pool)
{
  std::vector<LocalShape> shapes(points.size());
  pool.forChunks(points.size(), 512,
                 [&](std::size_t begin, std::size_t end, std::size_t)
                 {
                   std::vector<Neighbour> neighbours;
                   std::vector<Eigen::Vector3f> patch;
                   for (std::size_t i = begin; i < end; ++i)
                   {
                     tree.nearest(points[i], k, neighbours, max_distance);
                     patch.clear();
                     for (const Neighbour& n : neighbours)
                     {
                       patch.push_back(points[n.index]);
                     }
                     shapes[i] = fitLocalShape(patch, viewpoint);
                   }
                 });
  return shapes;
}
}  // namespace dyslam
