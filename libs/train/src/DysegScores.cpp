// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Statistics.h>
#include <dyslam/core/Scan.h>
#include <dyslam/train/DysegLosses.h>
#include <dyslam/train/DysegScores.h>

#include <cmath>

namespace dyslam
{
std::optional<double> DysegScores::iou() const
{
  return ratio(true_positives, true_positives + false_positives + false_negatives);
}

std::optional<double> DysegScores::precision() const
{
  return ratio(true_positives, true_positives + false_positives);
}

std::optional<double> DysegScores::recall() const
{
  return ratio(true_positives, true_positives + false_negatives);
}

void DysegScores::add(const DysegScores& o)
{
  true_positives += o.true_positives;
  false_positives += o.false_positives;
  false_negatives += o.false_negatives;
  static_error += o.static_error;
  moving_error += o.moving_error;
  static_cells += o.static_cells;
  moving_cells += o.moving_cells;
  translation_error += o.translation_error;
  yaw_error += o.yaw_error;
  pairs += o.pairs;
}

DysegScores scorePair(const DysegModel& model,
                      const DysegSample& sample,
                      const PlanarPrior* guess,
                      int iterations)
{
  const auto current = model.encode(sample.current);
  const auto past = model.encode(sample.past);
  RigidFlowFit step = model.match(*current, *past, guess);
  if (guess != nullptr && !step.converged)
  {
    step.motion = guess->motion;
  }
  const DysegResult result = model.segment(*current, *past, step, iterations);
  DysegScores s;
  for (std::size_t i = 0; i < sample.current.size(); ++i)
  {
    if (sample.label[i] == DysegSample::ignored_point || !isReturn(sample.current[i]))
    {
      continue;
    }
    const bool moves = sample.label[i] == DysegSample::moving_point;
    const bool called = result.moving_probability[i] > 0.5F;
    s.true_positives += moves && called ? 1 : 0;
    s.false_positives += !moves && called ? 1 : 0;
    s.false_negatives += moves && !called ? 1 : 0;
  }
  const PlanarMotion ego = PlanarMotion::fromPose(sample.T_past_current);
  s.pairs = 1;
  s.translation_error = (result.static_flow.motion.translation - ego.translation).norm();
  s.yaw_error = std::abs(result.static_flow.motion.yaw - ego.yaw);

  const BevScan scan = makeBevScan(sample.current, model.grid());
  const DysegCells cells(scan);
  const auto truth =
      cellTruth(sample, scan, cells.level.quarter.row_of_point, cells.quarter_centre, ego);
  for (std::size_t i = 0; i < truth.flow.size() && i < result.cell_flow.size(); ++i)
  {
    if (!truth.flow[i].allFinite())
    {
      continue;
    }
    const double error = (truth.flow[i] - result.cell_flow[i]).norm();
    const bool moves = truth.label[i] == DysegSample::moving_point;
    (moves ? s.moving_error : s.static_error) += error;
    (moves ? s.moving_cells : s.static_cells) += 1;
  }
  return s;
}
}  // namespace dyslam
