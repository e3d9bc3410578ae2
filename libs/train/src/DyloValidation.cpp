// SPDX-License-Identifier: BSD-3-Clause
#include "DyloValidation.h"

#include <dyslam/base/AreaUnderCurve.h>
#include <dyslam/base/PendingFile.h>
#include <dyslam/base/Printable.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cmath>
#include <limits>
#include <ostream>

namespace dyslam
{
namespace
{
std::string line(const char* name, const MotionErrors& e)
{
  return formatted("    %-18s %8.4f %8.4f m  %8.4f %8.4f deg  %7.3f\n", name, e.translation.mean,
                   e.translation.rmse, e.rotation_deg.mean, e.rotation_deg.rmse, e.forward_ratio);
}

struct MaskSamples
{
  std::vector<float> still, moving;
};

/** Confidence of the labelled nodes of the last stage; all points as CSV if `csv` names a file. */
void sampleMask(const DyloStage& stage,
                const PreparedScan& prepared,
                const std::vector<PointLabel>& labels,
                const std::vector<Eigen::Vector3f>& points,
                const std::string& csv,
                MaskSamples& samples)
{
  const torch::Tensor confidence = torch::sigmoid(stage.logits.is_static).cpu().contiguous();
  const torch::Tensor valid = stage.valid.cpu().contiguous();
  std::vector<float> of_point(points.size(), -1);
  const std::vector<std::int32_t>& cells = prepared.levels[stage.level].cell;
  for (std::size_t n = 0; n < cells.size(); ++n)
  {
    if (cells[n] < 0 || valid.data_ptr<float>()[n] == 0)
    {
      continue;
    }
    const auto source =
        static_cast<std::size_t>(prepared.source[static_cast<std::size_t>(cells[n])]);
    const float c = confidence.data_ptr<float>()[n];
    of_point[source] = c;
    if (!labels.empty() && labels[source] != PointLabel::unknown)
    {
      (labels[source] == PointLabel::moving ? samples.moving : samples.still).push_back(c);
    }
  }
  if (csv.empty())
  {
    return;
  }
  writeWhole(csv,
             [&](std::ostream& out)
             {
               out << "x,y,z,static_confidence,label\n";
               for (std::size_t i = 0; i < points.size(); ++i)
               {
                 out << points[i].x() << ',' << points[i].y() << ',' << points[i].z() << ','
                     << of_point[i] << ',' << (labels.empty() ? 0 : static_cast<int>(labels[i]))
                     << '\n';
               }
             });
}

/** Statistics of errors; NaN if one of them is not finite, as of a network that diverged. */
Statistics statisticsOrNaN(const std::vector<double>& errors)
{
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const bool finite =
      std::all_of(errors.begin(), errors.end(), [](double e) { return std::isfinite(e); });
  return finite ? statisticsOf(errors) : Statistics{errors.size(), nan, nan, nan, nan, nan, nan};
}
}  // namespace

MotionErrors motionErrors(const std::vector<Pose>& estimates, const std::vector<Pose>& truths)
{
  std::vector<double> translations;
  std::vector<double> rotations_deg;
  double forward = 0;
  double forward_truth = 0;
  for (std::size_t i = 0; i < truths.size(); ++i)
  {
    const Pose difference = truths[i].inverse() * estimates[i];
    translations.push_back(difference.translation().norm());
    rotations_deg.push_back(rotationAngle(difference) * 180 / M_PI);
    forward += estimates[i].translation().x();
    forward_truth += truths[i].translation().x();
  }
  MotionErrors errors;
  errors.translation = statisticsOrNaN(translations);
  errors.rotation_deg = statisticsOrNaN(rotations_deg);
  errors.forward_ratio = std::abs(forward_truth) > 1e-9 ? forward / forward_truth : 0;
  return errors;
}

namespace
{
/** Replaces all characters but letters, digits, dots and dashes by underscores. */
std::string asFileName(std::string name)
{
  std::replace_if(
      name.begin(), name.end(),
      [](unsigned char c) { return std::isalnum(c) == 0 && c != '.' && c != '-'; }, '_');
  return name;
}

/** Motions of the pairs of one recording. */
struct PairMotions
{
  std::vector<Pose> truths;
  std::vector<Pose> from_standing;        //!< network, started at zero motion
  std::vector<Pose> from_previous;        //!< network, started at its previous motion
  std::vector<Pose> constant;             //!< constant velocity: the previous true motion
  std::vector<std::vector<Pose>> stages;  //!< by stage: network, started at zero motion

  /** Adds a pair. \param found poses of all stages, started at zero motion \param predicted pose
   * started at the previous motion */
  void add(const std::vector<Pose>& found, const Pose& predicted, const Pose& truth)
  {
    // Pairs converge after different numbers of stages; their pose then stays.
    stages.resize(std::max(stages.size(), found.size()), from_standing);
    for (std::size_t s = 0; s < stages.size(); ++s)
    {
      stages[s].push_back(found[std::min(s, found.size() - 1)]);
    }
    from_standing.push_back(found.back());
    from_previous.push_back(predicted);
    constant.push_back(truths.empty() ? Pose::Identity() : truths.back());
    truths.push_back(truth);
  }

  void fill(ValidationRow& row) const
  {
    row.network = motionErrors(from_standing, truths);
    row.predicted_start = motionErrors(from_previous, truths);
    row.zero_motion = motionErrors(std::vector<Pose>(truths.size(), Pose::Identity()), truths);
    if (!truths.empty())  // the first pair has no previous motion
    {
      row.constant_velocity =
          motionErrors({constant.begin() + 1, constant.end()}, {truths.begin() + 1, truths.end()});
    }
    for (const auto& stage : stages)
    {
      row.stage_translation_rmse.push_back(motionErrors(stage, truths).translation.rmse);
    }
  }
};

/** Evaluates a recording. \param mask_csv file for the points of one scan; empty: not written */
ValidationRow validateRecording(DyloNetwork& network,
                                const Recording& recording,
                                torch::Device device,
                                const std::string& mask_csv)
{
  const auto type = torch::dtype(torch::kFloat).device(device);
  PairMotions motions;
  EncodedScan before;
  MaskSamples mask;
  double seconds = 0;
  for (std::size_t k = 0; k < recording.scans.size(); ++k)
  {
    const PreparedScan prepared = prepareScan(recording.scans[k]);
    const auto begin = std::chrono::steady_clock::now();
    EncodedScan now = network->encode(toTensors(prepared, device));
    if (k > 0)
    {
      const auto found = network->forward(now, before, PoseTensors::identity(type));
      seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
      const std::string csv = k == recording.scans.size() / 2 ? mask_csv : "";
      if (recording.labels.size() > k || !csv.empty())
      {
        sampleMask(found.back(), prepared,
                   recording.labels.empty() ? std::vector<PointLabel>() : recording.labels[k],
                   recording.scans[k], csv, mask);
      }
      std::vector<Pose> poses;
      for (const auto& stage : found)
      {
        poses.push_back(stage.pose.toPose());
      }
      // The first pair has no previous motion: it starts from the estimate with zero motion.
      const Pose start = motions.truths.empty() ? poses.back() : motions.from_previous.back();
      const auto predicted = network->forward(now, before, PoseTensors::from(start, type));
      motions.add(poses, predicted.back().pose.toPose(),
                  recording.T_world_scan[k - 1].inverse() * recording.T_world_scan[k]);
    }
    before = std::move(now);
  }
  ValidationRow row;
  row.recording = recording.name;
  motions.fill(row);
  row.mask_auc = areaUnderCurve(mask.still, mask.moving);
  row.moving_points = mask.moving.size();
  row.still_points = mask.still.size();
  row.milliseconds =
      1e3 * seconds / static_cast<double>(std::max<std::size_t>(motions.truths.size(), 1));
  return row;
}
}  // namespace

std::vector<ValidationRow> validateDylo(DyloNetwork& network,
                                        const std::vector<Recording>& recordings,
                                        torch::Device device,
                                        const std::string& mask_folder)
{
  const torch::NoGradGuard no_grad;
  std::vector<ValidationRow> rows;
  for (const Recording& recording : recordings)
  {
    const std::string mask_csv = mask_folder.empty()
                                     ? ""
                                     : mask_folder + "/mask_" + std::to_string(rows.size()) + "_" +
                                           asFileName(recording.name) + ".csv";
    rows.push_back(validateRecording(network, recording, device, mask_csv));
  }
  return rows;
}

std::string validationTable(const std::vector<ValidationRow>& rows)
{
  std::string text =
      "  per frame:          t mean    t rmse       r mean   r rmse       forward ratio\n";
  for (const ValidationRow& row : rows)
  {
    text += "  " + row.recording + "\n" + line("dylo", row.network) +
            line("dylo, predicted", row.predicted_start) + line("zero motion", row.zero_motion) +
            line("constant velocity", row.constant_velocity);
    text += formatted("    dylo, t max %.4f  median %.4f  min %.4f  std %.4f m\n",
                      row.network.translation.max, row.network.translation.median,
                      row.network.translation.min, row.network.translation.standard_deviation);
    text += "    stages, t rmse [m]:";
    for (const double error : row.stage_translation_rmse)
    {
      text += formatted(" %.4f", error);
    }
    text += formatted(";  %.1f ms\n", row.milliseconds);
    if (std::isfinite(row.mask_auc))
    {
      text +=
          formatted("    static confidence, area under ROC: %.3f (%zu moving, %zu static points)\n",
                    row.mask_auc, row.moving_points, row.still_points);
    }
  }
  return text;
}
}  // namespace dyslam
