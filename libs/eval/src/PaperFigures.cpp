// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Angle.h>
#include <dyslam/base/Error.h>
#include <dyslam/base/Words.h>
#include <dyslam/eval/PaperFigures.h>

#include <array>

namespace dyslam
{
namespace
{

struct OdometryFigures
{
  const char* sequence;
  double loam[2];  // t_rel, r_rel
  double po2po[2];
  double po2pl[2];
  double lonet[2];
  double loam_no_mapping[2];
  double dylo[2];
};
constexpr std::array<OdometryFigures, 11> table1{{
    {"00", {1.10, 0.53}, {6.88, 2.99}, {3.80, 1.73}, {1.47, 0.72}, {15.99, 6.25}, {1.26, 0.64}},
    {"01", {2.79, 0.55}, {11.21, 2.58}, {13.53, 2.58}, {1.36, 0.47}, {3.43, 0.93}, {0.73, 0.41}},
    {"02", {1.54, 0.55}, {8.21, 3.39}, {9.00, 2.74}, {1.52, 0.71}, {9.40, 3.68}, {1.86, 0.78}},
    {"03", {1.13, 0.65}, {11.07, 5.05}, {2.72, 1.63}, {1.03, 0.66}, {18.18, 9.91}, {0.96, 0.75}},
    {"04", {1.45, 0.50}, {6.64, 4.02}, {2.96, 2.58}, {0.51, 0.65}, {9.59, 4.57}, {0.45, 0.56}},
    {"05", {0.75, 0.38}, {3.97, 1.93}, {2.29, 1.08}, {1.04, 0.69}, {9.16, 4.10}, {1.28, 0.74}},
    {"06", {0.72, 0.39}, {1.95, 1.59}, {1.77, 1.00}, {0.71, 0.50}, {8.91, 4.63}, {1.17, 0.63}},
    {"07", {0.69, 0.50}, {5.17, 3.35}, {1.55, 1.42}, {1.70, 0.89}, {10.87, 6.76}, {1.32, 0.67}},
    {"08", {1.18, 0.44}, {10.04, 4.93}, {4.42, 2.14}, {2.12, 0.77}, {12.72, 5.77}, {1.81, 0.70}},
    {"09", {1.20, 0.48}, {6.93, 2.89}, {3.95, 1.71}, {1.37, 0.58}, {8.10, 4.30}, {1.53, 0.70}},
    {"10", {1.51, 0.57}, {8.91, 4.74}, {6.13, 2.60}, {1.80, 0.93}, {12.67, 8.79}, {1.60, 0.73}},
}};

struct MaskFigures
{
  const char* sequence;
  double no_mask;  // RPE, RMSE [m]
  double lonet;
  double ours;
};
constexpr std::array<MaskFigures, 2> table2{{{"01", 3.50, 2.32, 2.18}, {"04", 2.86, 2.54, 2.06}}};

struct TrackingFigures
{
  const char* sequence;
  double dylo[2];  // ATE translation [m], rotation [rad]
  double dylo_sam[2];
  double segmot[2];
  double dylo_sam_mot[2];
};
constexpr std::array<TrackingFigures, 7> table6{{
    {"04", {2.947, 0.167}, {2.915, 0.161}, {2.754, 0.167}, {2.841, 0.167}},
    {"07", {4.821, 0.108}, {4.671, 0.118}, {4.356, 0.120}, {4.142, 0.114}},
    {"08", {2.216, 0.207}, {2.227, 0.213}, {2.205, 0.201}, {2.144, 0.206}},
    {"10", {1.163, 0.153}, {1.121, 0.150}, {1.115, 0.152}, {1.105, 0.146}},
    {"15", {0.427, 0.099}, {0.420, 0.103}, {0.401, 0.112}, {0.366, 0.098}},
    {"18", {3.894, 0.186}, {3.620, 0.185}, {3.425, 0.189}, {3.526, 0.185}},
    {"19", {3.452, 0.161}, {3.391, 0.162}, {3.464, 0.160}, {3.430, 0.158}},
}};

struct CampusFigures
{
  const char* sequence;
  double loam;  // ATE, RMSE [m]
  double dylo;
  double dylo_sam_mot;
};
constexpr std::array<CampusFigures, 3> table7{
    {{"00", 1.113, 1.568, 0.895}, {"01", 3.121, 1.713, 0.910}, {"02", 0.146, 0.396, 0.144}}};

PaperRow driftRow(const char* method, const double (&figures)[2])
{
  PaperRow row;
  row.method = method;
  row.t_rel_percent = figures[0];
  row.r_rel_deg_per_100m = figures[1];
  return row;
}

PaperRow absoluteRow(const char* method, const double (&figures)[2])
{
  PaperRow row;
  row.method = method;
  row.ate_translation_rmse = figures[0];
  row.ate_rotation_rmse_deg = figures[1] * degrees_per_radian;
  return row;
}

PaperRow absoluteRow(const char* method, double translation)
{
  PaperRow row;
  row.method = method;
  row.ate_translation_rmse = translation;
  return row;
}

PaperRow relativeRow(const char* method, double translation)
{
  PaperRow row;
  row.method = method;
  row.rpe_translation_rmse = translation;
  return row;
}

std::vector<PaperRow> odometryRows(const OdometryFigures& figures)
{
  std::vector<PaperRow> rows{
      driftRow("LOAM", figures.loam),       driftRow("LOAM w/o mapping", figures.loam_no_mapping),
      driftRow("ICP-po2po", figures.po2po), driftRow("ICP-po2pl", figures.po2pl),
      driftRow("LO-Net", figures.lonet),    driftRow("DyLO", figures.dylo)};
  for (const auto& mask : table2)
  {
    if (std::string(mask.sequence) == figures.sequence)
    {
      rows.push_back(relativeRow("DyLO w/o mask", mask.no_mask));
      rows.push_back(relativeRow("DyLO, mask of LO-Net", mask.lonet));
      rows[5].rpe_translation_rmse = mask.ours;
    }
  }
  return rows;
}
}  // namespace

std::vector<PaperRow> paperFigures(const std::string& sequence)
{
  std::vector<std::string> known;
  for (const auto& f : table1)
  {
    known.push_back(std::string("odometry/") + f.sequence);
    if (known.back() == sequence)
    {
      return odometryRows(f);
    }
  }
  for (const auto& f : table6)
  {
    known.push_back(std::string("tracking/") + f.sequence);
    if (known.back() == sequence)
    {
      return {absoluteRow("DyLO", f.dylo), absoluteRow("DyLO-SAM", f.dylo_sam),
              absoluteRow("LIO-SEGMOT*", f.segmot), absoluteRow("DyLO-SAM-MOT", f.dylo_sam_mot)};
    }
  }
  for (const auto& f : table7)
  {
    known.push_back(std::string("campus/") + f.sequence);
    if (known.back() == sequence)
    {
      return {absoluteRow("LOAM", f.loam), absoluteRow("DyLO", f.dylo),
              absoluteRow("DyLO-SAM-MOT", f.dylo_sam_mot)};
    }
  }
  throw UserError(unknownWord("sequence of the paper", sequence, known) +
                  " (odometry/00-10, tracking/04..19, campus/00-02)");
}

std::optional<PaperRow> paperMeanDrift(const std::string& method)
{
  PaperRow mean;
  mean.method = method;
  double t_rel = 0;
  double r_rel = 0;
  std::size_t sequences = 0;
  for (const OdometryFigures& figures : table1)
  {
    for (const PaperRow& row : odometryRows(figures))
    {
      if (row.method == method && row.t_rel_percent && row.r_rel_deg_per_100m)
      {
        t_rel += *row.t_rel_percent;
        r_rel += *row.r_rel_deg_per_100m;
        ++sequences;
      }
    }
  }
  if (sequences == 0)
  {
    return std::nullopt;
  }
  mean.t_rel_percent = t_rel / static_cast<double>(sequences);
  mean.r_rel_deg_per_100m = r_rel / static_cast<double>(sequences);
  return mean;
}

std::vector<PaperTimes> paperTimes()
{
  return {{"LOAM w/o mapping", 24, 70, 94}, {"LOAM", std::nullopt, 140, 140}, {"DyLO", 15, 71, 86}};
}
}  // namespace dyslam
