// SPDX-License-Identifier: BSD-3-Clause
// Runs with the shipped settings stay within error bounds; a run with all networks; a run that
// closes loops.
#include <dyslam/base/Files.h>
#include <dyslam/core/BoxOverlap.h>
#include <dyslam/eval/SegmentationMetrics.h>
#include <dyslam/eval/TrajectoryMetrics.h>
#include <dyslam/formats/LabelFiles.h>
#include <dyslam/formats/TextFile.h>
#include <dyslam/formats/TrackFiles.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/io/RawlogSource.h>
#include <dyslam/io/RawlogWriter.h>
#include <dyslam/run/RunSlam.h>
#include <dyslam/sim/Simulator.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <vector>

namespace fs = std::filesystem;

namespace dyslam
{
namespace
{
class WholeRun : public ::testing::Test
{
 protected:
  void SetUp() override
  {
    folder_ = fs::temp_directory_path() / ("dyslam_whole_run_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  [[nodiscard]] SlamRunSettings settings(const std::string& rawlog,
                                         const std::string& config,
                                         const std::string& output) const
  {
    SlamRunSettings s;
    s.rawlog = rawlog;
    s.output_folder = (folder_ / output).string();
    s.config =
        Config::fromFile(std::string(DYSLAM_SOURCE_DIR) + "/share/dyslam/config_files/" + config);
    s.config.set("output.replay=false");
    s.config.set("output.scene=false");
    s.config.set("output.page=false");
    return s;
  }

  [[nodiscard]] static std::string bundled(const std::string& name)
  {
    return std::string(DYSLAM_SOURCE_DIR) + "/rawlog/" + name;
  }

  /** Errors of a trajectory of the run. \param file name of the trajectory in the run's folder */
  [[nodiscard]] static TrajectoryReport errorsOf(const SlamRunSettings& run,
                                                 const char* file = "trajectory_tum.txt")
  {
    const fs::path folder = run.output_folder;
    return evaluateTrajectory("run",
                              associateByTime(readTum((folder / "reference_tum.txt").string()),
                                              readTum((folder / file).string()), 1e-3));
  }

  [[nodiscard]] static double iouOf(const SlamRunSettings& run, const std::string& truth)
  {
    SegmentationEvaluator evaluator;
    for (const auto& entry : fs::directory_iterator(fs::path(run.output_folder) / "labels"))
    {
      const auto reference = readLabels((fs::path(truth) / entry.path().filename()).string());
      evaluator.add(reference, readLabels(entry.path().string()));
    }
    return evaluator.scores().iou().value_or(0);
  }

  fs::path folder_;
};

/** Default settings; labels with hindsight. Reached (x86-64 with AVX2): RPE 0.0091 m, end error
 * 0.259 m, IoU 0.9622. The bounds leave a tenth of the RPE and 0.015 of the IoU for builds that
 * round differently. */
TEST_F(WholeRun, TheBundledStreetStaysWithinBounds)
{
  auto s = settings(bundled("street64.rawlog"), "kitti64.ini", "street64");
  s.labels = true;
  const SlamRunReport report = runSlam(s);
  EXPECT_EQ(report.unconverged, 0U);
  EXPECT_LT(errorsOf(s).relative.translation.rmse, 0.0100);
  EXPECT_LT(errorsOf(s).end.translation, 0.26);
  EXPECT_GT(iouOf(s, bundled("street64.gt/labels")), 0.947);
}

/** The same: RPE 0.0228 m, ATE 0.016 m, IoU 0.8661. */
TEST_F(WholeRun, TheBundledCampusStaysWithinBounds)
{
  auto s = settings(bundled("campus16.rawlog"), "vlp16.ini", "campus16");
  s.labels = true;
  const SlamRunReport report = runSlam(s);
  EXPECT_EQ(report.unconverged, 0U);
  EXPECT_LT(errorsOf(s).relative.translation.rmse, 0.0250);
  EXPECT_LT(errorsOf(s).absolute.translation.rmse, 0.018);
  EXPECT_GT(iouOf(s, bundled("campus16.gt/labels")), 0.85);
}

/** With fewer iterations than most scans need, the motions are less accurate, and the user is told.
 */
TEST_F(WholeRun, FewIterationsLeaveAUsableTrajectory)
{
  auto s = settings(bundled("campus16.rawlog"), "vlp16.ini", "few_iterations");
  s.config.set("refine.max_iterations=3");
  s.config.set("input.only_first_n=40");
  const SlamRunReport report = runSlam(s);
  EXPECT_EQ(report.unconverged, 0U);
  EXPECT_EQ(report.verdict, "usable");
  ASSERT_EQ(report.warnings.size(), 1U);
  EXPECT_NE(report.warnings[0].find("of 40 scans ended before it converged"), std::string::npos)
      << report.warnings[0];
  EXPECT_LT(errorsOf(s).relative.translation.rmse, 0.03);
}

/** On a slope, with an IMU: all results are those of the run that was not levelled, rotated. */
TEST_F(WholeRun, ALevelMapIsTheMapRotated)
{
  constexpr int scans = 40;
  const std::string rawlog = (folder_ / "slope.rawlog").string();
  sim::SimulatorOptions campus;
  campus.world = sim::WorldKind::campus;
  campus.sensor = sim::SensorKind::vlp16;
  campus.columns = 600;
  campus.traffic = 0.8;
  campus.seed = 700000053;
  campus.imu = true;
  sim::Simulator simulator(campus, 2);
  RawlogWriter writer(rawlog);
  Trajectory truth;
  for (int i = 0; i < scans; ++i)
  {
    const auto simulated = simulator.next();
    for (const ImuSample& sample : simulated.imu)
    {
      writer.write(sample);
    }
    writer.write(simulated.scan, simulated.T_map_vehicle);
    truth.push_back(simulated.scan.stamp, simulated.T_map_vehicle);
  }
  writer.close();

  const auto runWith = [&](const std::string& level_map)
  {
    auto s = settings(rawlog, "vlp16.ini", "level_map_" + level_map);
    s.config.set("gravity.window=1");
    s.config.set("gravity.level_map=" + level_map);
    EXPECT_EQ(runSlam(s).unconverged, 0U);
    return s;
  };
  const SlamRunSettings plain = runWith("false");
  const SlamRunSettings level = runWith("true");
  const auto trajectoryOf = [](const SlamRunSettings& run)
  { return readTum(run.output_folder + "/trajectory_tum.txt"); };
  const Trajectory before = trajectoryOf(plain);
  const Trajectory after = trajectoryOf(level);
  ASSERT_EQ(before.size(), truth.size());
  ASSERT_EQ(after.size(), truth.size());
  const Pose T_level_map = after[0].pose * before[0].pose.inverse();
  EXPECT_GT(rotationAngle(T_level_map), 0.003) << "there is a slope";
  for (std::size_t i = 0; i < after.size(); ++i)
  {
    EXPECT_TRUE(after[i].pose.isApprox(T_level_map * before[i].pose, 1e-6)) << i;
  }
  // The vehicle's upwards in the map, and in the world.
  const auto upwards = [](const Trajectory& trajectory)
  { return Eigen::Vector3d(trajectory[0].pose.linear().row(2)); };
  EXPECT_LT((upwards(after) - upwards(truth)).norm(), 0.02);

  const auto tracksOf = [](const SlamRunSettings& run)
  { return readTracks(run.output_folder + "/tracks.txt"); };
  EXPECT_EQ(tracksOf(level).size(), tracksOf(plain).size());
  EXPECT_LT(errorsOf(level).absolute.translation.rmse, 0.03);
}

/** A robot with a lidar at the front and one at the rear. */
TEST_F(WholeRun, ASecondLidarHelps)
{
  constexpr int scans = 40;
  const std::string rawlog = (folder_ / "robot.rawlog").string();
  sim::SimulatorOptions campus;
  campus.world = sim::WorldKind::campus;
  campus.sensor = sim::SensorKind::vlp16;
  campus.columns = 600;
  campus.traffic = 0.8;
  campus.seed = 700000011;
  campus.further_sensors = {{sim::SensorKind::vlp16, poseFromYpr(-0.5, 0, 0.5, M_PI, -0.15, 0)}};
  std::vector<std::vector<Label>> truth;
  {
    sim::Simulator simulator(campus, 2);
    RawlogWriter writer(rawlog);
    for (int i = 0; i < scans; ++i)
    {
      const auto simulated = simulator.next();
      writer.write(simulated.scan, simulated.T_map_vehicle);
      writer.write(simulated.further.front());
      truth.push_back(simulated.label);
    }
    writer.close();
  }
  const SlamRunSettings one = settings(rawlog, "vlp16.ini", "one");
  SlamRunSettings both = settings(rawlog, "vlp16.ini", "both");
  both.config.set("input.further_lidars=VLP16_2");
  both.labels = true;
  both.static_scans = true;
  (void)runSlam(one);
  (void)runSlam(both);
  EXPECT_LT(errorsOf(both).relative.translation.rmse, errorsOf(one).relative.translation.rmse);
  EXPECT_LT(errorsOf(both).absolute.translation.rmse, 0.02);
  std::size_t static_points = 0;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < truth.size(); ++i)
  {
    char name[40];
    std::snprintf(name, sizeof name, "/labels/%06zu.label", i);
    const std::vector<Label> labels = readLabels(both.output_folder + name);
    ASSERT_EQ(labels.size(), truth[i].size()) << "of both lidars";
    for (std::size_t k = 0; k < labels.size(); ++k)
    {
      static_points += isMovingLabel(truth[i][k]) ? 0U : 1U;
      kept += isMovingLabel(truth[i][k]) || isMovingLabel(labels[k]) ? 0U : 1U;
    }
  }
  EXPECT_GT(static_cast<double>(kept), 0.998 * static_cast<double>(static_points));
  RawlogSource static_scans(both.output_folder + "/static_scans.rawlog", RawlogSourceOptions());
  const auto first = static_scans.next();
  ASSERT_TRUE(first);
  EXPECT_GT(first->scan.size(), truth[0].size() / 2);
  EXPECT_TRUE(first->scan.ring.empty()) << "numbers of two lidars";
}

/** The true boxes serve as detections of another detector, without a segmenter: each object has one
 * track, or at most two if it was hidden for long. */
TEST_F(WholeRun, BoxesOfAnotherDetectorAreTracked)
{
  constexpr int scans = 40;
  constexpr int first = 5;  // first frame at which tracks are confirmed
  auto s = settings(bundled("street64.rawlog"), "kitti64.ini", "boxes");
  s.config.set("dyseg.method=none");
  s.config.set("input.only_first_n=" + std::to_string(scans));
  s.config.set("boxes.file=" + bundled("street64.gt/tracks.txt"));
  (void)runSlam(s);
  std::map<int, std::vector<LabelledBox>> tracked;  // tracked boxes by scan
  for (const LabelledBox& box : readTracks(s.output_folder + "/tracks.txt"))
  {
    tracked[box.frame].push_back(box);
  }
  int boxes = 0;
  int found = 0;
  std::map<int, std::set<int>> ids;  // track ids by true object
  for (const LabelledBox& truth : readTracks(bundled("street64.gt/tracks.txt")))
  {
    if (truth.frame < first || truth.frame >= scans)
    {
      continue;
    }
    ++boxes;
    const auto& here = tracked[truth.frame];
    const auto match =
        std::find_if(here.begin(), here.end(),
                     [&truth](const LabelledBox& box) { return boxIou(box.box, truth.box) > 0.5; });
    if (match != here.end())
    {
      ++found;
      ids[truth.id].insert(match->id);
    }
  }
  EXPECT_GT(boxes, 100);
  EXPECT_GT(found, 0.85 * boxes);
  const auto broken = std::count_if(ids.begin(), ids.end(),
                                    [](const auto& object) { return object.second.size() > 1; });
  EXPECT_LT(broken, 0.15 * static_cast<double>(ids.size()));
  EXPECT_TRUE(std::all_of(ids.begin(), ids.end(),
                          [](const auto& object) { return object.second.size() <= 2; }));
}

/** Segmenter, learned matcher and registration use the results of one another. */
TEST_F(WholeRun, DysegDyloAndRefineTogether)
{
  auto s = settings(bundled("street64.rawlog"), "kitti64.ini", "networks");
  s.config.set("odometry.method=dylo");
  s.config.set("input.only_first_n=40");
  const SlamRunReport report = runSlam(s);
  EXPECT_EQ(report.method, "network + dylo + point_to_plane");
  EXPECT_EQ(report.unconverged, 0U);
  EXPECT_EQ(report.odometry_failed, 0U);
  EXPECT_LT(errorsOf(s).relative.translation.rmse, 0.013);

  // DyLO's motion is used, not only found.
  std::ifstream file(fs::path(s.output_folder) / "scans.csv");
  std::string line;
  std::getline(file, line);
  std::stringstream header(line);
  std::size_t column = 0;
  for (std::string name; std::getline(header, name, ',') && name != "odometry_accepted";)
  {
    ++column;
  }
  int accepted = 0;
  while (std::getline(file, line))
  {
    std::stringstream row(line);
    std::string cell;
    for (std::size_t i = 0; i <= column; ++i)
    {
      std::getline(row, cell, ',');
    }
    accepted += cell == "1" ? 1 : 0;
  }
  EXPECT_GT(accepted, 20) << "of 40";
}

/** In a jam the registration follows the vehicles; with their labels it finds the static world. */
TEST_F(WholeRun, LabelsHelpInAJam)
{
  sim::SimulatorOptions options;
  options.world = sim::WorldKind::highway;
  options.traffic = 1;
  options.loop_length = 2400;
  options.seed = 700000033;
  options.columns = 1024;
  sim::Simulator simulator(options, 1);
  const std::string rawlog = (folder_ / "jam.rawlog").string();
  const std::string labels = (folder_ / "jam_labels").string();
  fs::create_directories(labels);
  RawlogWriter writer(rawlog);
  for (std::size_t i = 0; i < 30; ++i)
  {
    const sim::SimulatedScan scan = simulator.next();
    writer.write(scan.scan, scan.T_map_vehicle);
    writeLabels(numberedPath(labels, i, ".label"), scan.label);
  }
  writer.close();

  auto without = settings(rawlog, "kitti64.ini", "without");
  without.config.set("dyseg.method=none");
  runSlam(without);
  auto with = settings(rawlog, "kitti64.ini", "with");
  with.config.set("dyseg.method=none");
  with.config.set("dyseg.labels=" + labels);
  const SlamRunReport report = runSlam(with);
  EXPECT_EQ(report.unconverged, 0U);
  EXPECT_GT(errorsOf(without).relative.translation.rmse, 0.05);
  EXPECT_LT(errorsOf(with).relative.translation.rmse,
            0.3 * errorsOf(without).relative.translation.rmse);
}

/** A drive along a campus path and back, with an odometry that drifts. */
TEST_F(WholeRun, ALoopCorrectsTrajectoryAndMap)
{
  sim::SimulatorOptions options;
  options.world = sim::WorldKind::campus;
  options.sensor = sim::SensorKind::vlp16;
  options.columns = 600;
  options.seed = 5;
  options.ego_speed = 3;
  options.motion_distortion = false;  // reversed scans would have the wrong distortion
  options.stops = false;
  sim::Simulator simulator(options, 1);
  const std::string rawlog = (folder_ / "there_and_back.rawlog").string();
  std::vector<sim::SimulatedScan> scans;
  for (int i = 0; i < 120; ++i)
  {
    scans.push_back(simulator.next());
  }
  RawlogWriter writer(rawlog);
  const std::size_t count = scans.size();
  for (std::size_t i = 0; i < 2 * count - 1; ++i)
  {
    auto& scan = scans[i < count ? i : 2 * count - 2 - i];
    scan.scan.time.clear();
    scan.scan.stamp = 1000 + 0.1 * static_cast<double>(i);
    writer.write(scan.scan, scan.T_map_vehicle);
  }
  writer.close();

  const auto runWith = [&](const std::string& mode)
  {
    auto s = settings(rawlog, "vlp16.ini", mode);
    s.config.set("backend.mode=" + mode);
    s.config.set("odometry.method=loam_no_mapping");
    s.config.set("refine.method=none");
    s.config.set("dyseg.method=none");
    s.config.set("labels.hindsight=false");
    return std::pair(s, runSlam(s));
  };
  const auto [open, open_report] = runWith("odometry");
  const auto [closed, closed_report] = runWith("ego");
  EXPECT_EQ(open_report.loops, 0U);
  EXPECT_GT(closed_report.loops, 2U);
  EXPECT_GT(errorsOf(open).end.translation, 0.2) << "there is a drift to correct";
  EXPECT_LT(errorsOf(closed).end.translation, 0.5 * errorsOf(open).end.translation);
  EXPECT_LT(errorsOf(closed).end.translation, errorsOf(closed, "odometry_tum.txt").end.translation);
  // Walls that are mapped twice, at two positions, fill more voxels.
  EXPECT_LT(closed_report.map_points, open_report.map_points);
}

TEST_F(WholeRun, LoopsThatAreLeftOutAreNotCounted)
{
  auto s = settings(bundled("campus16.rawlog"), "vlp16.ini", "left_out");
  for (const char* assignment :
       {"input.only_first_n=40", "output.page=true", "backend.keyframe_distance=0.8",
        "loop.min_path=4", "loop.min_support=0", "loop.interval=1",
        "loop.max_descriptor_distance=1", "loop.min_overlap=0.3", "loop.min_observability=0",
        "solver.loop_loss_width=0.1"})  // far too strict: every loop contradicts the odometry
  {
    s.config.set(assignment);
  }
  const SlamRunReport report = runSlam(s);
  const fs::path folder = s.output_folder;
  const std::string graph = readWhole(folder / "factor_graph.txt");
  const auto linesOf = [&graph](const std::string& type)
  {
    std::size_t count = 0;
    for (auto at = graph.find("\n" + type); at != std::string::npos;
         at = graph.find("\n" + type, at + 1))
    {
      ++count;
    }
    return count;
  };
  EXPECT_GT(report.loops_left_out, 2U) << "this recording should test loops";
  EXPECT_EQ(report.loops_left_out, linesOf("LEFT_OUT_LOOP "));
  EXPECT_EQ(report.loops, linesOf("LOOP "));
  const std::string totals = "\"loops\":" + std::to_string(report.loops) +
                             ",\"loops_left_out\":" + std::to_string(report.loops_left_out) + ",";
  EXPECT_NE(readWhole(folder / "report.html").find(totals), std::string::npos);
  EXPECT_NE(readWhole(folder / "report.json").find("\"loops\": " + std::to_string(report.loops)),
            std::string::npos);
}
}  // namespace
}  // namespace dyslam
