// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Angle.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/PendingFile.h>
#include <dyslam/benchmarks/JsonText.h>
#include <dyslam/benchmarks/KittiSlamErrors.h>
#include <dyslam/eval/PaperFigures.h>

#include <algorithm>
#include <array>
#include <iomanip>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

namespace dyslam
{
namespace
{
/** Noise model of the visual odometry of the data, whose scale error is up to 4 %. */
const OdometryNoise visual_noise{"visual", 0.01, 0.02, 0.05 * radians_per_degree};
const std::array<OdometryNoise, 4> odometry_noises{{{"poor", 0.05, 0.005, 0.1 * radians_per_degree},
                                                    {"middle", 0.02, 0, 0.05 * radians_per_degree},
                                                    {"good", 0.005, 0, 0.015 * radians_per_degree},
                                                    visual_noise}};

const OdometryNoise& noiseOf(const std::string& name)
{
  return *std::find_if(odometry_noises.begin(), odometry_noises.end(),
                       [&](const OdometryNoise& noise) { return noise.name == name; });
}

BackendMode modeOf(const std::string& name)
{
  return name == "odometry" ? BackendMode::odometry
         : name == "ego"    ? BackendMode::ego
         : name == "segmot" ? BackendMode::segmot
                            : BackendMode::full;
}

/** Means over the seeds of one sequence. */
struct ModeError
{
  double translation = 0;  //!< RMSE of the positions [m]
  double rotation = 0;     //!< RMSE of the orientations [rad]
};
using SequenceErrors = std::map<std::string, ModeError>;  //!< by mode

/** Errors of moving vehicles, of the first seed in the last mode. */
Table objectTable(const std::map<std::string, KittiObjectErrors>& errors)
{
  Table table({"sequence", "vehicles observed", "position of detections [m]", "tracker [m]",
               "graph [m]", "speed of differences [m/s]", "tracker [m/s]", "graph [m/s]"},
              "Moving vehicles against their labels, RMSE");
  for (const auto& [name, e] : errors)
  {
    table.addRow({name, TableCell(static_cast<double>(e.count), 0),
                  TableCell(e.observed_position, 3), TableCell(e.tracked_position, 3),
                  TableCell(e.smoothed_position, 3), TableCell(e.difference_speed, 2),
                  TableCell(e.tracked_speed, 2), TableCell(e.smoothed_speed, 2)});
  }
  return table;
}

ModeError errorOf(const KittiDrive& drive, const std::vector<Pose>& estimate, Alignment alignment)
{
  PosePairs pairs;
  pairs.stamps = drive.stamps;
  pairs.reference = drive.truth;
  pairs.estimate = estimate;
  const AbsoluteTrajectoryError error = absoluteTrajectoryError(pairs, alignment);
  return {error.translation.rmse, error.rotation_deg.rmse * radians_per_degree};
}

/** Writes FOLDER/SEQUENCE_LABEL_SOURCE.csv for each vehicle. */
void writeSpeeds(const std::string& folder,
                 const std::string& sequence,
                 const std::map<int, KittiVehicleSpeeds>& vehicles)
{
  makeFolder(folder);
  for (const auto& [label, vehicle] : vehicles)
  {
    const std::string name = folder + "/" + sequence + "_" + std::to_string(label);
    for (const auto& [source, speeds] :
         {std::pair{"_tracker.csv", &vehicle.tracked}, std::pair{"_graph.csv", &vehicle.smoothed}})
    {
      std::ostringstream text;
      text << "time,speed\n" << std::fixed << std::setprecision(4);
      for (const auto& [time, speed] : *speeds)
      {
        text << time << ',' << speed << '\n';
      }
      writeWhole(name + source, text.str());
    }
  }
}

/** Errors with the visual odometry of the data if `noise` is its model, else with drawn odometries.
 */
SequenceErrors errorsOn(const KittiDrive& drive,
                        const OdometryNoise& noise,
                        const KittiSlamSetup& setup,
                        std::map<std::string, KittiObjectErrors>& objects)
{
  SequenceErrors errors;
  const bool drawn = noise.name != visual_noise.name;
  const int seeds = drawn ? setup.seeds : 1;
  BackendConfig backend = setup.backend;
  for (int seed = 0; seed < seeds; ++seed)
  {
    const std::vector<Pose> odometry =
        drawn ? noisyOdometry(drive.truth, noise, static_cast<std::uint32_t>(1000 + seed))
              : drive.visual;
    const std::vector<Matrix6> information = stepInformation(odometry, noise);
    for (const std::string& mode : setup.modes)
    {
      backend.backend.mode = modeOf(mode);
      const KittiSlamRun run = runKittiSlam(drive, odometry, information, setup.tracker, backend);
      const ModeError error = errorOf(drive, run.trajectory, setup.alignment);
      errors[mode].translation += error.translation / seeds;
      errors[mode].rotation += error.rotation / seeds;
      if (seed == 0 && !run.objects.empty())
      {
        objects[noise.name + " " + drive.name] = kittiObjectErrors(drive, odometry, run);
        if (!setup.speeds.empty())
        {
          writeSpeeds(setup.speeds + "/" + noise.name, drive.name,
                      kittiVehicleSpeeds(drive, odometry, run));
        }
      }
    }
  }
  return errors;
}

void addModeRow(Table& table,
                const std::string& odometry,
                const std::string& sequence,
                const SequenceErrors& errors,
                const std::vector<std::string>& modes)
{
  std::vector<TableCell> cells{odometry, sequence};
  for (const std::string& mode : modes)
  {
    cells.emplace_back(errors.at(mode).translation, 3);
    cells.emplace_back(errors.at(mode).rotation, 4);
  }
  table.addRow(cells);
}

SequenceErrors meanErrors(const std::vector<SequenceErrors>& sequences,
                          const std::vector<std::string>& modes)
{
  SequenceErrors mean;
  const auto n = static_cast<double>(sequences.size());
  for (const std::string& mode : modes)
  {
    for (const SequenceErrors& errors : sequences)
    {
      mean[mode].translation += errors.at(mode).translation / n;
      mean[mode].rotation += errors.at(mode).rotation / n;
    }
  }
  return mean;
}

/** Means over the sequences, and the ratios to the first mode: of the means, mean of the ratios. */
void addModeMeans(Table& table,
                  const std::string& odometry,
                  const std::vector<SequenceErrors>& sequences,
                  const std::vector<std::string>& modes)
{
  SequenceErrors mean = meanErrors(sequences, modes);
  SequenceErrors ratio_of_means;
  SequenceErrors mean_of_ratios;
  const auto n = static_cast<double>(sequences.size());
  for (const std::string& mode : modes)
  {
    for (const SequenceErrors& errors : sequences)
    {
      const ModeError& base = errors.at(modes.front());
      mean_of_ratios[mode].translation += errors.at(mode).translation / base.translation / n;
      mean_of_ratios[mode].rotation += errors.at(mode).rotation / base.rotation / n;
    }
    const ModeError& base = mean.at(modes.front());
    ratio_of_means[mode] = {mean[mode].translation / base.translation,
                            mean[mode].rotation / base.rotation};
  }
  addModeRow(table, odometry, "mean", mean, modes);
  addModeRow(table, odometry, "ratio of means", ratio_of_means, modes);
  addModeRow(table, odometry, "mean of ratios", mean_of_ratios, modes);
}

/** The paper's figures of a sequence, by the mode that corresponds to each of its methods. */
SequenceErrors paperErrors(const std::string& sequence)
{
  const std::map<std::string, std::string> mode_of{{"DyLO", "odometry"},
                                                   {"DyLO-SAM", "ego"},
                                                   {"LIO-SEGMOT*", "segmot"},
                                                   {"DyLO-SAM-MOT", "full"}};
  SequenceErrors errors;
  for (const PaperRow& row : paperFigures("tracking/" + sequence.substr(2)))
  {
    errors[mode_of.at(row.method)] = {row.ate_translation_rmse.value(),
                                      row.ate_rotation_rmse_deg.value() * radians_per_degree};
  }
  return errors;
}

void addPaper(Table& table, const std::vector<std::string>& modes)
{
  std::vector<SequenceErrors> sequences;
  for (const std::string& sequence : kittiSlamPaperSequences())
  {
    sequences.push_back(paperErrors(sequence));
    addModeRow(table, "the paper's", sequence, sequences.back(), modes);
  }
  addModeRow(table, "the paper's", "mean", meanErrors(sequences, modes), modes);
}
}  // namespace

std::vector<std::string> kittiSlamPaperSequences()
{
  return {"0004", "0007", "0008", "0010", "0015", "0018", "0019"};
}

KittiSlamReport evaluateKittiSlam(const KittiSlamSetup& setup)
{
  std::vector<std::string> columns{"odometry", "sequence"};
  for (const std::string& mode : setup.modes)
  {
    columns.push_back(mode + " [m]");
    columns.push_back("[rad]");
  }
  Table table(columns, "ATE RMSE, alignment " + toString(setup.alignment) + ", mean of " +
                           std::to_string(setup.seeds) + " drawn odometries");
  std::map<std::string, KittiDrive> drives;
  for (const std::string& name : setup.sequences)
  {
    drives[name] = readKittiDrive(setup.data, name, setup.detector, setup.min_score, setup.noise);
  }
  nlohmann::ordered_json json;
  std::map<std::string, KittiObjectErrors> objects;  // by odometry and sequence
  for (const std::string& odometry : setup.odometries)
  {
    std::vector<SequenceErrors> sequences;
    for (const std::string& name : setup.sequences)
    {
      sequences.push_back(errorsOn(drives[name], noiseOf(odometry), setup, objects));
      addModeRow(table, odometry, name, sequences.back(), setup.modes);
      for (const auto& [mode, error] : sequences.back())
      {
        json[odometry][name][mode] = {{"translation_m", error.translation},
                                      {"rotation_rad", error.rotation}};
      }
    }
    addModeMeans(table, odometry, sequences, setup.modes);
  }
  addPaper(table, setup.modes);
  return {table, objectTable(objects), textOf(json)};
}
}  // namespace dyslam
