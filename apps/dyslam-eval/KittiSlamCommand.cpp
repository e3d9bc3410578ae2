// SPDX-License-Identifier: BSD-3-Clause
#include "KittiSlamCommand.h"

#include <dyslam/core/Angle.h>
#include <dyslam/core/Options.h>
#include <dyslam/core/PendingFile.h>
#include <dyslam/core/SharedFiles.h>
#include <dyslam/eval/PaperFigures.h>
#include <dyslam/eval/TrajectoryMetrics.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>

#include "../common/OutputOptions.h"
#include "KittiSlam.h"
#include "OutputFiles.h"

namespace dyslam
{
namespace
{
/** Of the paper's Table 6. */
const std::vector<std::string> paper_sequences{"0004", "0007", "0008", "0010",
                                               "0015", "0018", "0019"};

struct KittiSlamArguments
{
  std::string data;
  std::string config = "kitti_mot.ini";
  std::string detector = "pointrcnn";
  std::vector<std::string> set;
  std::vector<std::string> sequences = paper_sequences;
  std::vector<std::string> odometries{"poor", "middle", "good", "visual"};
  std::vector<std::string> modes{"odometry", "segmot", "full"};
  int seeds = 10;
  double min_score = 0;
  std::string alignment = "se3";
  std::string speeds;
  OutputFlags output;
};

/** Noise model of the visual odometry of the data, whose scale error is up to 4 %. */
const OdometryNoise visual{"visual", 0.01, 0.02, 0.05 * radians_per_degree};
const std::array<OdometryNoise, 4> noises{{{"poor", 0.05, 0.005, 0.1 * radians_per_degree},
                                           {"middle", 0.02, 0, 0.05 * radians_per_degree},
                                           {"good", 0.005, 0, 0.015 * radians_per_degree},
                                           visual}};

const OdometryNoise& noiseOf(const std::string& name)
{
  return *std::find_if(noises.begin(), noises.end(),
                       [&](const OdometryNoise& noise) { return noise.name == name; });
}

struct Settings
{
  TrackerOptions tracker;
  DetectionNoiseOptions noise;
  BackendConfig backend;
};

Settings settingsOf(const KittiSlamArguments& a)
{
  Config config =
      Config::fromFile(findGivenOrShared(a.config, "config_files", ".ini", "", "dyslam-eval"));
  config.requireFor("dyslam-eval");
  config.set("backend.keyframe_distance=0");
  config.set("objects.window_keyframes=0");
  for (const std::string& assignment : a.set)
  {
    config.set(assignment);
  }
  ConfigLoader loader(config);
  Settings settings{loader.get<TrackerOptions>("tracker"),
                    loader.get<DetectionNoiseOptions>("detection_noise"),
                    {loader.get<BackendOptions>("backend"), LoopCloserOptions{},
                     loader.get<ObjectGraphOptions>("objects"),
                     loader.get<FactorGraphOptions>("solver"), GnssOptions{}}};
  loader.requireAllUsed();
  return settings;
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

/** Moving vehicles, of the first seed in the last mode. */
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

/** FOLDER/SEQUENCE_LABEL_SOURCE.csv for each vehicle. */
void writeSpeeds(const std::string& folder,
                 const std::string& sequence,
                 const std::map<int, KittiVehicleSpeeds>& vehicles)
{
  std::filesystem::create_directories(folder);
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

/** By the visual odometry of the data where `noise` is that, else by drawn ones. */
SequenceErrors errorsOn(const KittiDrive& drive,
                        const OdometryNoise& noise,
                        const KittiSlamArguments& a,
                        Settings& settings,
                        std::map<std::string, KittiObjectErrors>& objects)
{
  SequenceErrors errors;
  const bool drawn = noise.name != visual.name;
  const int seeds = drawn ? a.seeds : 1;
  for (int seed = 0; seed < seeds; ++seed)
  {
    const std::vector<Pose> odometry =
        drawn ? noisyOdometry(drive.truth, noise, static_cast<std::uint32_t>(1000 + seed))
              : drive.visual;
    const std::vector<Matrix6> information = stepInformation(odometry, noise);
    for (const std::string& mode : a.modes)
    {
      settings.backend.backend.mode = modeOf(mode);
      const KittiSlamRun run =
          runKittiSlam(drive, odometry, information, settings.tracker, settings.backend);
      const ModeError error = errorOf(drive, run.trajectory, alignmentFromString(a.alignment));
      errors[mode].translation += error.translation / seeds;
      errors[mode].rotation += error.rotation / seeds;
      if (seed == 0 && !run.objects.empty())
      {
        objects[noise.name + " " + drive.name] = kittiObjectErrors(drive, odometry, run);
        if (!a.speeds.empty())
        {
          writeSpeeds(a.speeds + "/" + noise.name, drive.name,
                      kittiVehicleSpeeds(drive, odometry, run));
        }
      }
    }
  }
  return errors;
}

void addRow(Table& table,
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
void addMeans(Table& table,
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
  addRow(table, odometry, "mean", mean, modes);
  addRow(table, odometry, "ratio of means", ratio_of_means, modes);
  addRow(table, odometry, "mean of ratios", mean_of_ratios, modes);
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
  for (const std::string& sequence : paper_sequences)
  {
    sequences.push_back(paperErrors(sequence));
    addRow(table, "the paper's", sequence, sequences.back(), modes);
  }
  addRow(table, "the paper's", "mean", meanErrors(sequences, modes), modes);
}

void runKittiSlam(const KittiSlamArguments& a)
{
  Settings settings = settingsOf(a);
  std::vector<std::string> columns{"odometry", "sequence"};
  for (const std::string& mode : a.modes)
  {
    columns.push_back(mode + " [m]");
    columns.push_back("[rad]");
  }
  Table table(columns, "ATE RMSE, alignment " + a.alignment + ", mean of " +
                           std::to_string(a.seeds) + " drawn odometries");
  std::map<std::string, KittiDrive> drives;
  for (const std::string& name : a.sequences)
  {
    drives[name] = readKittiDrive(a.data, name, a.detector, a.min_score, settings.noise);
  }
  nlohmann::ordered_json json;
  std::map<std::string, KittiObjectErrors> objects;  // by odometry and sequence
  for (const std::string& odometry : a.odometries)
  {
    std::vector<SequenceErrors> sequences;
    for (const std::string& name : a.sequences)
    {
      sequences.push_back(errorsOn(drives[name], noiseOf(odometry), a, settings, objects));
      addRow(table, odometry, name, sequences.back(), a.modes);
      for (const auto& [mode, error] : sequences.back())
      {
        json[odometry][name][mode] = {{"translation_m", error.translation},
                                      {"rotation_rad", error.rotation}};
      }
    }
    addMeans(table, odometry, sequences, a.modes);
  }
  addPaper(table, a.modes);
  a.output.write(table, textOf(json));
  if (!objects.empty())
  {
    std::cout << objectTable(objects).toText();
  }
}
}  // namespace

Subcommand kittiSlamCommand(CLI::App& app)
{
  const auto a = std::make_shared<KittiSlamArguments>();
  CLI::App* sub = app.add_subcommand(
      "kitti-slam",
      "Evaluates the factor graph of ego and objects on KITTI tracking with given detections, "
      "next to the paper's Table 6");
  sub->add_option("--data", a->data, "folder with label_02, oxts, calib, orbslam3_cam0, det_NAME")
      ->required()
      ->check(CLI::ExistingDirectory);
  sub->add_option("-c,--config", a->config, "ini with tracker and backend")->capture_default_str();
  sub->add_option("--set", a->set, "one setting, overrides the ini")
      ->type_name("SECTION.KEY=VALUE");
  sub->add_option("--detector", a->detector, "det_NAME of the data, or labels")
      ->capture_default_str();
  sub->add_option("--min-score", a->min_score, "of detections")->capture_default_str();
  sub->add_option("--sequences", a->sequences, "sequences")->capture_default_str();
  sub->add_option("--odometry", a->odometries,
                  "drawn ones (sigma per step: poor 0.05 m + 0.5 %, 0.1 deg; middle 0.02 m, 0.05 "
                  "deg; good 0.005 m, 0.015 deg), or the visual one of the data")
      ->check(CLI::IsMember({"poor", "middle", "good", "visual"}))
      ->capture_default_str();
  sub->add_option("--modes", a->modes, "modes of the backend; ratios are to the first")
      ->check(CLI::IsMember({"odometry", "ego", "segmot", "full"}))
      ->capture_default_str();
  sub->add_option("--seeds", a->seeds, "drawn odometries per sequence")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  sub->add_option("--align", a->alignment, "of estimate and truth")
      ->check(CLI::IsMember({"none", "first", "se3"}))
      ->capture_default_str();
  addOutputFolder(*sub, "--speeds", a->speeds,
                  "folder for speeds of vehicles, by tracker and graph; dyslam-eval speeds "
                  "--series reads them (first seed, last mode)");
  a->output.declare(*sub);
  return {sub, [a] { runKittiSlam(*a); }};
}
}  // namespace dyslam
