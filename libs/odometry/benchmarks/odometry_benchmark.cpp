// SPDX-License-Identifier: BSD-3-Clause
// All odometry methods and the refinement on the same frames: one table of accuracy and time.
//
// All rows run the class Odometry: METHOD is a scan matcher alone, METHOD+refine the matcher with
// registration to the local map, refine:point_to_plane and refine:gicp that registration from the
// prior alone. constant_velocity repeats the reference's previous motion.
#include <dyslam/base/Angle.h>
#include <dyslam/base/Error.h>
#include <dyslam/base/Heap.h>
#include <dyslam/base/Quantile.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/odometry/Odometry.h>
#include <dyslam/odometry/Preprocessor.h>
#include <dyslam/odometry/ScanMatcher.h>
#include <dyslam/train/DataSplits.h>
#include <mrpt/system/CTimeLogger.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <iostream>
#include <map>

namespace
{
using namespace dyslam;

struct Arguments
{
  std::string folder;
  std::string poses;
  std::size_t first = 0;
  std::size_t frames = 100000;
  int threads = 2;
  double period = 0.1;               //!< time between scans [s]
  std::vector<std::string> methods;  //!< names of rows
  std::vector<std::string> assignments;
};

struct Row
{
  std::vector<Pose> poses;
  std::vector<double> wall_ms;
  std::vector<double> cpu_ms;
  std::size_t failures = 0;
  /** Normalised squared error of the motions: mean 6 if the information is consistent. */
  double normalised_error = 0;
};

void declare(CLI::App& app, Arguments& a)
{
  a.methods = scanMatcherNames();
  a.methods.insert(a.methods.end(), {"refine:point_to_plane", "refine:gicp"});
  app.add_option("folder", a.folder,
                 "folder with .bin files (float32 x y z intensity), or with a folder velodyne/ "
                 "with them")
      ->required();
  app.add_option("--poses", a.poses,
                 "true poses of the sensor, 12 numbers a line; without it only times and the ends "
                 "are printed");
  app.add_option("--first", a.first, "number of the first frame");
  app.add_option("--frames", a.frames, "number of frames");
  app.add_option("--threads", a.threads, "threads; 0: number of cores")
      ->check(CLI::Range(0, 256))
      ->capture_default_str();
  app.add_option("--period", a.period, "time between scans [s]")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--methods", a.methods,
                 "rows: METHOD, METHOD+refine, refine:point_to_plane, refine:gicp")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->capture_default_str();
  app.add_option("--set", a.assignments, "one setting of every row; repeatable")
      ->type_name("SECTION.KEY=VALUE")
      ->take_all()
      ->allow_extra_args(false);
}

std::vector<std::string> filesOf(const Arguments& a)
{
  const std::filesystem::path inside = std::filesystem::path(a.folder) / "velodyne";
  const std::string folder = std::filesystem::is_directory(inside) ? inside.string() : a.folder;
  const std::vector<std::string> all = listBinFiles(folder);
  const std::size_t first = std::min(all.size(), a.first);
  const std::size_t end = first + std::min(all.size() - first, a.frames);
  if (first == end)
  {
    throw UserError(folder + ": has no .bin file from number " + std::to_string(a.first) + " on");
  }
  return {all.begin() + static_cast<std::ptrdiff_t>(first),
          all.begin() + static_cast<std::ptrdiff_t>(end)};
}

std::vector<Scan> readScans(const std::vector<std::string>& files)
{
  std::vector<Scan> scans;
  for (const std::string& file : files)
  {
    scans.push_back(readBin(file));
  }
  return scans;
}

/** Number of scans in each split as text: ", 80 training, 30 validation". */
std::string splitsOf(const std::vector<std::string>& files)
{
  const DataSplits splits = DataSplits::load("splits", "splits.ini");
  std::map<std::string, std::size_t> counts;
  for (const std::string& file : files)
  {
    const auto split = splits.splitOfScan(file);
    ++counts[split ? toString(*split) : "of unknown split"];
  }
  std::string text;
  for (const auto& [name, count] : counts)
  {
    text += ", " + std::to_string(count) + " " + name;
  }
  return text;
}

double cpuMs()
{
  return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

/** The settings that a row's name stands for. */
Config configOf(const std::string& method, const Arguments& a)
{
  Config config;
  for (const std::string& assignment : a.assignments)
  {
    config.set(assignment);
  }
  const std::size_t plus = method.find("+refine");
  if (method.rfind("refine:", 0) == 0)
  {
    config.set("odometry.method=constant_velocity");
    config.set("refine.method=" + method.substr(7));
  }
  else
  {
    config.set("odometry.method=" + method.substr(0, plus));
    if (plus == std::string::npos)
    {
      config.set("refine.method=none");
    }
  }
  return config;
}

/** Row constant_velocity: the reference's previous motion as the estimate. */
Row repeatReference(const std::vector<Pose>& reference)
{
  Row row;
  for (std::size_t i = 0; i < reference.size(); ++i)
  {
    const Pose motion =
        i < 2 ? Pose::Identity() : Pose(reference[i - 2].inverse() * reference[i - 1]);
    row.poses.push_back(i == 0 ? Pose::Identity() : Pose(row.poses.back() * motion));
    row.wall_ms.push_back(0);
    row.cpu_ms.push_back(0);
  }
  return row;
}

Row runMethod(const std::string& method,
              const Arguments& a,
              const std::vector<Scan>& scans,
              const std::vector<Pose>& reference)
{
  ThreadPool pool(a.threads);
  const Config config = configOf(method, a);
  ConfigLoader loader(config);
  mrpt::system::CTimeLogger times(false);
  const Preprocessor preprocessor(loader.get<PreprocessOptions>("preprocess"), pool);
  Odometry odometry(loader, pool, times);
  loader.requireAllUsed();

  Row row;
  std::size_t judged = 0;
  for (std::size_t i = 0; i < scans.size(); ++i)
  {
    Frame frame;
    frame.index = i;
    frame.scan = scans[i];
    frame.scan.stamp = a.period * static_cast<double>(i);
    const auto start = std::chrono::steady_clock::now();
    const double cpu_start = cpuMs();
    odometry.predict(frame);
    frame.cloud = preprocessor.prepare(frame.scan, frame.prior.T_previous_current, frame.dt);
    odometry.estimate(frame);
    odometry.integrate(frame);
    row.cpu_ms.push_back(cpuMs() - cpu_start);
    row.wall_ms.push_back(
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
            .count());
    row.failures += frame.motion.registered() ? 0U : 1U;
    row.poses.push_back(frame.T_odom_vehicle);
    if (i > 0 && i < reference.size())
    {
      const Vector6 e = logSE3(frame.motion.T_previous_current.inverse() *
                               reference[i - 1].inverse() * reference[i]);
      row.normalised_error += e.dot(frame.motion.information * e);
      ++judged;
    }
  }
  row.normalised_error /= static_cast<double>(std::max<std::size_t>(1, judged));
  return row;
}

double medianOf(std::vector<double> values)
{
  return upperMedian(values);
}

void print(const std::string& method, const Row& row, const std::vector<Pose>& reference)
{
  const std::size_t count = std::min(row.poses.size(), reference.size());
  double t_mean = 0;
  double t_square = 0;
  double r_mean = 0;
  double r_square = 0;
  double forward = 0;
  double forward_true = 0;
  for (std::size_t i = 1; i < count; ++i)
  {
    const Pose truth = reference[i - 1].inverse() * reference[i];
    const Pose found = row.poses[i - 1].inverse() * row.poses[i];
    const Pose error = truth.inverse() * found;
    const double t = error.translation().norm();
    const double r = rotationAngle(error) / radians_per_degree;
    t_mean += t;
    t_square += t * t;
    r_mean += r;
    r_square += r * r;
    forward += found.translation().x();
    forward_true += truth.translation().x();
  }
  const double n = std::max(1.0, static_cast<double>(count) - 1);
  const double end = count == 0 ? 0
                                : ((row.poses[0].inverse() * row.poses[count - 1]).translation() -
                                   (reference[0].inverse() * reference[count - 1]).translation())
                                      .norm();
  std::printf(
      "| %-21s | %6.4f | %6.4f | %6.4f | %6.4f | %6.3f | %6.4f | %6.1f | %6.1f | %6.1f | %6.1f | "
      "%zu |\n",
      method.c_str(), t_mean / n, std::sqrt(t_square / n), r_mean / n, std::sqrt(r_square / n), end,
      forward_true == 0 ? 0 : forward / forward_true,
      *std::min_element(row.wall_ms.begin() + (row.wall_ms.size() > 1 ? 1 : 0), row.wall_ms.end()),
      medianOf(row.wall_ms), medianOf(row.cpu_ms), row.normalised_error, row.failures);
  std::fflush(stdout);
}
}  // namespace

int main(int argc, char** argv)
{
  tuneHeap();
  Arguments a;
  CLI::App app("Odometry methods on the same frames: a table of accuracy and time");
  declare(app, a);
  CLI11_PARSE(app, argc, argv);
  try
  {
    const std::vector<std::string> files = filesOf(a);
    const std::vector<Scan> scans = readScans(files);
    std::vector<Pose> reference = a.poses.empty() ? std::vector<Pose>() : readKittiPoses(a.poses);
    reference.erase(reference.begin(), reference.begin() + static_cast<std::ptrdiff_t>(std::min(
                                                               a.first, reference.size())));
    std::printf("%zu frames%s, %d threads\n", scans.size(), splitsOf(files).c_str(), a.threads);
    std::printf(
        "| method | RPE m mean | RMSE | RPE deg mean | RMSE | end m | forward | ms min | ms median "
        "|"
        " CPU ms | e'Ie | failed |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n");
    for (const std::string& method : a.methods)
    {
      const bool repeats = method == "constant_velocity" && !reference.empty();
      print(method, repeats ? repeatReference(reference) : runMethod(method, a, scans, reference),
            reference);
    }
    return EXIT_SUCCESS;
  }
  catch (const std::exception& e)
  {
    std::cerr << "odometry_benchmark: " << e.what() << "\n";
    return EXIT_FAILURE;
  }
}
