// SPDX-License-Identifier: BSD-3-Clause
// The fine and dense stages of DyLO's network: Gauss-Newton steps on the full-resolution image.
#include <dyslam/nets/DyloNetwork.h>
#include <dyslam/nets/Grouping.h>

#include <algorithm>
#include <cmath>

namespace dyslam
{
namespace
{
/** Scales of the robust weights in the dense stage [m]. */
constexpr double dense_kernel = 0.1;
constexpr double dense_thickness = 0.05;

/** Dense stage: upper limit of the total weight of ground surfaces relative to all others. They do
 * not constrain the forward motion and only add their errors to it. */
constexpr double max_ground_weight_ratio = 1.5;
constexpr double min_ground_normal_cosine = 0.9;  //!< least |z| of a ground normal
constexpr double min_ground_weight = 0.02;

/** Points of a scan deskewed by `motion` instead of T_sweep, to first order of the difference. */
torch::Tensor deskewed(const torch::Tensor& xyz,
                       const torch::Tensor& phase,
                       const EncodedScan& scan,
                       const Pose& motion)
{
  if (!phase.defined())
  {
    return xyz;
  }
  const Vector6 more = logSE3(scan.T_sweep.inverse() * motion);
  const torch::Tensor shift = torch::tensor({more[0], more[1], more[2]}, xyz.options());
  const torch::Tensor turn = torch::tensor(
      {0.0, more[5], -more[4], -more[5], 0.0, more[3], more[4], -more[3], 0.0}, xyz.options());
  return torch::addcmul(xyz, phase.unsqueeze(1), torch::addmm(shift, xyz, turn.view({3, 3})));
}

torch::Tensor deskewedBy(const EncodedScan& scan, std::size_t level, const Pose& motion)
{
  return deskewed(scan.scan.levels[level].xyz, scan.phase[level], scan, motion);
}

/** `start` updated by the Gauss-Newton step fused with the prior. */
PoseTensors fuseStepWithPrior(const DyloPrior& prior,
                              const PoseStepProblem& problem,
                              const GaussNewtonStep& step,
                              const PoseTensors& start)
{
  const torch::Tensor residual = (problem.normal * problem.points).sum(1) - problem.offset;
  const double rmse = std::sqrt((problem.weight * residual.square()).sum().item<double>());
  const double points = 1 / std::max(problem.weight.square().sum().item<double>(), 1e-9);
  const torch::Tensor normal = step.normal_matrix.to(torch::kCPU, torch::kDouble).contiguous();
  const Matrix6 measured =
      measurementPrecision(rmse, points, prior.points_per_measurement) *
      Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(normal.data_ptr<double>());
  const Pose T = start.toPose();
  const Vector6 moved = fuseWithPrior(prior, T, logSE3(step.update.toPose()), measured);
  return PoseTensors::from(expSE3(moved) * T, start.rotation.options());
}

/** Factor of a point's weight in the dense stage (Geman-McClure in the residual, thickness). */
torch::Tensor robustWeight(const Surfaces& surfaces, const torch::Tensor& residual)
{
  const torch::Tensor off = (residual / dense_kernel).square() + 1;
  const torch::Tensor thick = (surfaces.thickness / dense_thickness).square() + 1;
  return surfaces.valid / (off.square() * thick);
}

/** `weight` with the total weight of ground surfaces limited. */
torch::Tensor limitGroundWeight(const torch::Tensor& weight, const torch::Tensor& normal)
{
  const torch::Tensor ground =
      normal.select(1, 2).abs().gt(min_ground_normal_cosine).to(weight.dtype());
  const torch::Tensor ground_sum = (weight * ground).sum().detach();
  const torch::Tensor other_sum = (weight * (1 - ground)).sum().detach();
  const torch::Tensor factor = (max_ground_weight_ratio * other_sum / ground_sum.clamp_min(1e-9))
                                   .clamp(min_ground_weight, 1);
  return weight * (1 - (1 - factor) * ground);
}

/** Every other column of values per node of a level. \param of_nodes [N] or [N, 3] \param first
 * first column, 0 or 1 */
torch::Tensor everyOtherColumn(const torch::Tensor& of_nodes,
                               const ScanTensors::Level& level,
                               std::int64_t first)
{
  std::vector<std::int64_t> half_shape = of_nodes.sizes().vec();
  half_shape[0] /= 2;
  return of_nodes.reshape({level.rows, level.cols / 2, 2, -1}).select(2, first).reshape(half_shape);
}

/** Points of one scan on surfaces of the other, as in PoseStepProblem; weights not normalised. */
struct DenseCorrespondences
{
  torch::Tensor points, normal, offset, weight;
};

/** Points of scan 1 on surfaces of scan 2. \param fine weights of scan 1's nodes of level 1 */
DenseCorrespondences matchForward(const EncodedScan& scan1,
                                  const ScanTensors& scan2,
                                  const PoseTensors& start,
                                  const torch::Tensor& fine)
{
  const ScanTensors::Level& nodes = scan1.scan.levels[0];
  const ScanTensors::Level& parents = scan1.scan.levels[1];
  const torch::Tensor points = everyOtherColumn(deskewedBy(scan1, 0, start.toPose()), nodes, 0);
  const torch::Tensor warped = start.apply(points);
  const Surfaces surfaces =
      surfacesAround(warped, {}, everyOtherColumn(nodes.valid, nodes, 0), scan2);
  const torch::Tensor residual = (surfaces.normal * warped).sum(1) - surfaces.offset;
  const torch::Tensor of_parents = fine.reshape({parents.rows, 1, parents.cols, 1})
                                       .expand({parents.rows, nodes.rows / parents.rows,
                                                parents.cols, nodes.cols / 2 / parents.cols})
                                       .reshape({-1});
  return {warped, surfaces.normal, surfaces.offset, of_parents * robustWeight(surfaces, residual)};
}

/** Points of scan 2 on surfaces of scan 1. Here the step moves the surfaces, not the points, so
 * rows and normals change their signs. */
DenseCorrespondences matchBackward(const EncodedScan& scan1,
                                   const ScanTensors& scan2,
                                   const PoseTensors& start,
                                   const torch::Tensor& fine)
{
  ScanTensors image1 = scan1.scan;
  image1.image_xyz = deskewed(image1.image_xyz, scan1.image_phase, scan1, start.toPose());
  const ScanTensors::Level& nodes = scan2.levels[0];
  const torch::Tensor points = everyOtherColumn(nodes.xyz, nodes, 1);
  const torch::Tensor transformed = torch::matmul(points - start.translation, start.rotation);
  const Surfaces surfaces =
      surfacesAround(transformed, {}, everyOtherColumn(nodes.valid, nodes, 1), image1);
  const torch::Tensor residual = (surfaces.normal * transformed).sum(1) - surfaces.offset;
  const ScanTensors::Level& parents = image1.levels[1];
  const torch::Tensor parent =
      windowAround(transformed, image1, parents.rows, parents.cols, 0, 0).index.squeeze(1);
  const torch::Tensor normal = -torch::matmul(surfaces.normal, start.rotation.t());
  return {points, normal, (normal * points).sum(1) - residual,
          fine.index_select(0, parent) * robustWeight(surfaces, residual)};
}
}  // namespace

DyloStage DyloNetworkImpl::fineStage(const EncodedScan& scan1,
                                     const EncodedScan& scan2,
                                     const PoseTensors& start,
                                     const torch::Tensor& embedding,
                                     const DyloPrior* prior)
{
  const ScanTensors::Level& nodes = scan1.scan.levels[1];
  const torch::Tensor points = deskewedBy(scan1, 1, start.toPose());
  const torch::Tensor warped = start.apply(points);
  const torch::Tensor own_normal = torch::matmul(nodes.normal, start.rotation.t());
  const Surfaces surfaces = surfacesAround(warped, own_normal, nodes.valid, scan2.scan);

  DyloStage result;
  result.level = 1;
  result.points = points;
  result.valid = surfaces.valid;
  result.normal = surfaces.normal;
  result.offset = surfaces.offset;
  result.target = surfaces.target;
  result.noise = noise_[4].exp();
  const torch::Tensor joined =
      fine_embed_->forward(torch::cat({surfaces.features, embedding, scan1.features[1]}, 1));
  result.logits = fine_mask_->forward(joined, scan1.features[1], result.valid);
  result.weight = maskWeights(result.logits, result.valid);
  const PoseStepProblem problem = {warped,        result.normal, result.offset,
                                   result.target, result.weight, {}};
  const GaussNewtonStep step = gaussNewtonStep(problem);
  result.pose =
      prior == nullptr ? step.update * start : fuseStepWithPrior(*prior, problem, step, start);
  result.normal_matrix = step.normal_matrix;
  return result;
}

DyloStage DyloNetworkImpl::denseStage(const EncodedScan& scan1,
                                      const EncodedScan& scan2,
                                      const DyloStage& fine,
                                      const DyloPrior* prior)
{
  const PoseTensors start = fine.pose.detached();
  const DenseCorrespondences onto = matchForward(scan1, scan2.scan, start, fine.weight);
  const DenseCorrespondences back = matchBackward(scan1, scan2.scan, start, fine.weight);
  const torch::Tensor normal = torch::cat({onto.normal, back.normal});
  const torch::Tensor weight = limitGroundWeight(torch::cat({onto.weight, back.weight}), normal);
  const PoseStepProblem problem = {torch::cat({onto.points, back.points}), normal,
                                   torch::cat({onto.offset, back.offset}), {},
                                   weight / weight.sum().clamp_min(1e-9),  {}};
  const GaussNewtonStep step = gaussNewtonStep(problem);
  DyloStage result = fine;
  result.dense = true;
  result.pose =
      prior == nullptr ? step.update * start : fuseStepWithPrior(*prior, problem, step, start);
  result.normal_matrix = step.normal_matrix;
  return result;
}
}  // namespace dyslam
