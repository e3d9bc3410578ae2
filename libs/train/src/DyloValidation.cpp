// SPDX-License-Identifier: BSD-3-Clause
#include "DyloValidation.h"

#include <chrono>
#include <cmath>
#include <cstdio>

namespace dyslam
{
namespace
{
std::string line(const char* name, const MotionErrors& e)
{
  char text[200];
  std::snprintf(text, sizeof text, "    %-18s %8.4f %8.4f m  %8.4f %8.4f deg  %7.3f\n", name,
                e.translation_mean, e.translation_rmse, e.rotation_mean_deg, e.rotation_rmse_deg,
                e.forward_ratio);
  return text;
}
}  // namespace

MotionErrors motionErrors(const std::vector<Pose>& estimates, const std::vector<Pose>& truths)
{
  MotionErrors errors;
  double forward = 0;
  double forward_truth = 0;
  const auto count = static_cast<double>(std::max<std::size_t>(truths.size(), 1));
  for (std::size_t i = 0; i < truths.size(); ++i)
  {
    const Pose difference = truths[i].inverse() * estimates[i];
    const double t = difference.translation().norm();
    const double r = rotationAngle(difference) * 180 / M_PI;
    errors.translation_mean += t / count;
    errors.translation_rmse += t * t / count;
    errors.rotation_mean_deg += r / count;
    errors.rotation_rmse_deg += r * r / count;
    forward += estimates[i].translation().x();
    forward_truth += truths[i].translation().x();
  }
  errors.translation_rmse = std::sqrt(errors.translation_rmse);
  errors.rotation_rmse_deg = std::sqrt(errors.rotation_rmse_deg);
  errors.forward_ratio = std::abs(forward_truth) > 1e-9 ? forward / forward_truth : 0;
  return errors;
}

std::vector<ValidationRow> validateDylo(DyloNetwork& network,
                                        const std::vector<Recording>& recordings,
                                        torch::Device device)
{
  const torch::NoGradGuard no_grad;
  std::vector<ValidationRow> rows;
  for (const Recording& recording : recordings)
  {
    std::vector<Pose> estimates;
    std::vector<Pose> followed;
    std::vector<Pose> truths;
    std::vector<Pose> still;
    std::vector<Pose> same;
    std::vector<std::vector<Pose>> stages;
    EncodedScan before;
    double seconds = 0;
    for (std::size_t k = 0; k < recording.scans.size(); ++k)
    {
      const PreparedScan prepared = prepareScan(recording.scans[k]);
      const auto begin = std::chrono::steady_clock::now();
      EncodedScan now = network->encode(toTensors(prepared, device));
      if (k > 0)
      {
        const auto found = network->forward(
            now, before, PoseTensors::identity(torch::dtype(torch::kFloat).device(device)));
        seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
        // No step before the first one: it starts from what was found from standing still.
        const Pose start = followed.empty() ? found.back().pose.toPose() : followed.back();
        followed.push_back(
            network
                ->forward(now, before,
                          PoseTensors::from(start, torch::dtype(torch::kFloat).device(device)))
                .back()
                .pose.toPose());
        stages.resize(found.size());
        for (std::size_t s = 0; s < found.size(); ++s)
        {
          stages[s].push_back(found[s].pose.toPose());
        }
        estimates.push_back(stages.back().back());
        same.push_back(truths.empty() ? Pose::Identity() : truths.back());
        truths.push_back(recording.T_world_scan[k - 1].inverse() * recording.T_world_scan[k]);
        still.push_back(Pose::Identity());
      }
      before = std::move(now);
    }
    ValidationRow row;
    row.recording = recording.name;
    row.network = motionErrors(estimates, truths);
    row.predicted_start = motionErrors(followed, truths);
    row.zero_motion = motionErrors(still, truths);
    // The first step has no step before it.
    row.constant_velocity =
        motionErrors({same.begin() + 1, same.end()}, {truths.begin() + 1, truths.end()});
    for (const auto& stage : stages)
    {
      row.stage_translation_rmse.push_back(motionErrors(stage, truths).translation_rmse);
    }
    row.milliseconds = 1e3 * seconds / static_cast<double>(std::max<std::size_t>(truths.size(), 1));
    rows.push_back(row);
  }
  return rows;
}

std::string validationTable(const std::vector<ValidationRow>& rows)
{
  std::string text =
      "  per frame:          t mean    t rmse       r mean   r rmse       forward ratio\n";
  for (const ValidationRow& row : rows)
  {
    char stage_text[32];
    text += "  " + row.recording + "\n" + line("dylo", row.network) +
            line("dylo, predicted", row.predicted_start) + line("zero motion", row.zero_motion) +
            line("constant velocity", row.constant_velocity);
    text += "    stages, t rmse [m]:";
    for (const double error : row.stage_translation_rmse)
    {
      std::snprintf(stage_text, sizeof stage_text, " %.4f", error);
      text += stage_text;
    }
    std::snprintf(stage_text, sizeof stage_text, ";  %.1f ms\n", row.milliseconds);
    text += stage_text;
  }
  return text;
}
}  // namespace dyslam
