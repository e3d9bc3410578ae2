// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Pose.h>
#include <dyslam/nets/GaussNewton.h>
#include <dyslam/nets/Threads.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

namespace dyslam
{
namespace
{
using Matrix6r = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

Eigen::LDLT<Matrix6> factor(const torch::Tensor& a)
{
  const Eigen::Map<const Matrix6r> view(a.data_ptr<double>());
  return Eigen::LDLT<Matrix6>(view);
}

torch::Tensor solveOnCpu(const torch::Tensor& a, const torch::Tensor& b)
{
  torch::Tensor x = torch::empty({6}, torch::kDouble);
  Eigen::Map<Vector6>(x.data_ptr<double>()) =
      factor(a).solve(Eigen::Map<const Vector6>(b.data_ptr<double>()));
  return x;
}

torch::Tensor toCpu(const torch::Tensor& t)
{
  return t.to(torch::kCPU).contiguous();
}

class SolveSpdFunction : public torch::autograd::Function<SolveSpdFunction>
{
 public:
  static torch::Tensor forward(torch::autograd::AutogradContext* context,
                               const torch::Tensor& a,
                               const torch::Tensor& b)
  {
    const torch::Tensor x = solveOnCpu(toCpu(a), toCpu(b)).to(a.device());
    context->save_for_backward({a, x});
    return x;
  }

  static torch::autograd::variable_list backward(torch::autograd::AutogradContext* context,
                                                 const torch::autograd::variable_list& grads)
  {
    const auto saved = context->get_saved_variables();
    const torch::Tensor grad_b = solveOnCpu(toCpu(saved[0]), toCpu(grads[0])).to(saved[0].device());
    return {-torch::outer(grad_b, saved[1]), grad_b};
  }
};

// Levenberg damping: too small to bias an observable motion, sufficient for a single plane.
constexpr double damping = 1e-6;
// Rotations in units of 0.1 rad, for the conditioning of the normal matrix.
constexpr double rotation_unit = 0.1;

Eigen::Vector3d vectorAt(const torch::Tensor& t, std::int64_t i)
{
  return Eigen::Map<const Eigen::Vector3f>(t.data_ptr<float>() + 3 * i).cast<double>();
}

/** gaussNewtonStep() without gradients: float input, sums in double. */
GaussNewtonStep stepWithoutGradients(const PoseStepProblem& problem)
{
  const torch::Tensor points = toCpu(problem.points);
  const torch::Tensor normals = toCpu(problem.normal);
  const torch::Tensor offsets = toCpu(problem.offset);
  const torch::Tensor weights = toCpu(problem.weight);
  const bool isotropic = problem.isotropic.defined();
  const torch::Tensor targets = isotropic ? toCpu(problem.target) : points;
  const double point_weight = isotropic ? problem.isotropic.item<double>() : 0;
  Matrix6 matrix = Matrix6::Zero();
  Vector6 right = Vector6::Zero();
  for (std::int64_t i = 0; i < points.size(0); ++i)
  {
    const auto weight = static_cast<double>(weights.data_ptr<float>()[i]);
    if (weight == 0)
    {
      continue;
    }
    const Eigen::Vector3d p = vectorAt(points, i);
    const Eigen::Vector3d n = vectorAt(normals, i);
    Vector6 row;
    row << n, p.cross(n);
    const Vector6 weighted = weight * row;
    matrix.noalias() += weighted * row.transpose();
    right += (n.dot(p) - static_cast<double>(offsets.data_ptr<float>()[i])) * weighted;
    if (isotropic)
    {
      Eigen::Matrix<double, 6, 3> rows;
      rows << Eigen::Matrix3d::Identity(), skew(p);
      const Eigen::Matrix<double, 6, 3> weighted_rows = weight * point_weight * rows;
      matrix += weighted_rows.lazyProduct(rows.transpose());
      right += weighted_rows * (p - vectorAt(targets, i));
    }
  }
  Vector6 scale = Vector6::Ones();
  scale.tail<3>().setConstant(rotation_unit);
  const Matrix6 damped =
      scale.asDiagonal() * matrix * scale.asDiagonal() + damping * Matrix6::Identity();
  const Vector6 step = -scale.cwiseProduct(damped.ldlt().solve(scale.cwiseProduct(right)));

  const auto options = problem.points.options();
  Pose update = Pose::Identity();
  update.translation() = step.head<3>();
  const double angle = step.tail<3>().norm();
  if (angle > 0)
  {
    update.linear() = Eigen::AngleAxisd(angle, step.tail<3>() / angle).toRotationMatrix();
  }
  GaussNewtonStep result;
  result.update = PoseTensors::from(update, options);
  result.normal_matrix = torch::empty({6, 6}, torch::kDouble);
  Eigen::Map<Matrix6r>(result.normal_matrix.data_ptr<double>()) = matrix;
  result.normal_matrix = result.normal_matrix.to(options);
  return result;
}

/** Jacobian rows [n, p x n] of n . (p + t + w x p). */
torch::Tensor jacobian(const torch::Tensor& points, const torch::Tensor& normal)
{
  return torch::cat({normal, torch::cross(points, normal, 1)}, 1);
}
}  // namespace

torch::Tensor solveSpd(const torch::Tensor& a, const torch::Tensor& b)
{
  return SolveSpdFunction::apply(a.to(torch::kDouble), b.to(torch::kDouble));
}

torch::Tensor expRotation(const torch::Tensor& rotation)
{
  const torch::Tensor angle2 = rotation.square().sum() + 1e-16;
  const torch::Tensor angle = angle2.sqrt();
  const torch::Tensor zero = torch::zeros({}, rotation.options());
  const torch::Tensor x = rotation[0];
  const torch::Tensor y = rotation[1];
  const torch::Tensor z = rotation[2];
  const torch::Tensor skew = torch::stack({zero, -z, y, z, zero, -x, -y, x, zero}).reshape({3, 3});
  const torch::Tensor half = torch::sin(0.5 * angle) / angle;
  return torch::eye(3, rotation.options()) + torch::sin(angle) / angle * skew +
         2 * half * half * torch::matmul(skew, skew);
}

torch::Tensor rotationOfQuaternion(const torch::Tensor& quaternion)
{
  const torch::Tensor q = quaternion / quaternion.norm();
  const torch::Tensor w = q[0];
  const torch::Tensor x = q[1];
  const torch::Tensor y = q[2];
  const torch::Tensor z = q[3];
  return torch::stack({1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
                       2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                       2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)})
      .reshape({3, 3});
}

GaussNewtonStep gaussNewtonStep(const PoseStepProblem& problem)
{
  if (!torch::GradMode::is_enabled() && problem.points.scalar_type() == torch::kFloat)
  {
    return stepWithoutGradients(problem);
  }
  const auto options = problem.points.options();
  torch::Tensor rows = jacobian(problem.points, problem.normal);
  torch::Tensor residual = (problem.normal * problem.points).sum(1) - problem.offset;
  torch::Tensor weight = problem.weight;
  if (problem.isotropic.defined())
  {
    const torch::Tensor difference = problem.points - problem.target;
    std::vector<torch::Tensor> all_rows = {rows};
    std::vector<torch::Tensor> all_residuals = {residual};
    std::vector<torch::Tensor> all_weights = {weight};
    for (std::int64_t axis = 0; axis < 3; ++axis)
    {
      torch::Tensor direction = torch::zeros_like(problem.points);
      direction.select(1, axis).fill_(1);
      all_rows.push_back(jacobian(problem.points, direction));
      all_residuals.push_back(difference.select(1, axis));
      all_weights.push_back(weight * problem.isotropic);
    }
    rows = torch::cat(all_rows);
    residual = torch::cat(all_residuals);
    weight = torch::cat(all_weights);
  }
  torch::Tensor scale = torch::ones({6}, options);
  scale.slice(0, 3, 6).fill_(rotation_unit);
  const torch::Tensor scaled = rows * scale;
  const torch::Tensor weighted = scaled * weight.unsqueeze(1);
  const torch::Tensor matrix = torch::matmul(weighted.t(), scaled);
  const torch::Tensor right = torch::matmul(weighted.t(), residual.unsqueeze(1)).squeeze(1);
  const torch::Tensor damped = matrix + damping * torch::eye(6, options);
  const torch::Tensor step = -solveSpd(damped, right).to(options) * scale;

  GaussNewtonStep result;
  result.update.rotation = expRotation(step.slice(0, 3, 6));
  result.update.translation = step.slice(0, 0, 3);
  const torch::Tensor unscale = 1 / scale;
  result.normal_matrix = matrix.detach() * unscale.unsqueeze(0) * unscale.unsqueeze(1);
  return result;
}

PlaneFit fitPlanes(const torch::Tensor& covariance)
{
  const torch::NoGradGuard no_grad;
  PlaneFit fit;
  if (!covariance.device().is_cpu())
  {
    const auto [values, vectors] = torch::linalg_eigh(covariance);
    fit.normal = vectors.select(2, 0).contiguous();
    fit.spread = values.clamp_min(0).sqrt();
    return fit;
  }
  const torch::Tensor in = covariance.to(torch::kFloat).contiguous();
  const std::int64_t n = in.size(0);
  fit.normal = torch::empty({n, 3});
  fit.spread = torch::empty({n, 3});
  const float* source = in.data_ptr<float>();
  float* normals = fit.normal.data_ptr<float>();
  float* spreads = fit.spread.data_ptr<float>();
  forRows(n, 256,
          [&](std::int64_t begin, std::int64_t end)
          {
            Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver;
            for (std::int64_t i = begin; i < end; ++i)
            {
              const Eigen::Matrix3f matrix = Eigen::Map<const Eigen::Matrix3f>(source + 9 * i);
              solver.computeDirect(matrix);
              Eigen::Vector3f normal = solver.eigenvectors().col(0);
              if (!normal.allFinite())
              {
                normal.setZero();
              }
              Eigen::Map<Eigen::Vector3f>(normals + 3 * i) = normal;
              Eigen::Map<Eigen::Vector3f>(spreads + 3 * i) =
                  solver.eigenvalues().cwiseMax(0).cwiseSqrt();
            }
          });
  return fit;
}
}  // namespace dyslam
