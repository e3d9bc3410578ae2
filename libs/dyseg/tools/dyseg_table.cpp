// SPDX-License-Identifier: BSD-3-Clause
// Evaluates moving-point segmentation: the network, and the residual baseline with given poses.
#include <dyslam/base/Error.h>
#include <dyslam/base/SharedFiles.h>
#include <dyslam/core/Scan.h>
#include <dyslam/dyseg/NetworkSegmenter.h>
#include <dyslam/dyseg/ResidualSegmenter.h>
#include <dyslam/train/DysegBodies.h>
#include <dyslam/train/DysegScores.h>
#include <dyslam/train/LabelledRun.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "Scenarios.h"
#include "SegmentationRun.h"

namespace
{
using namespace dyslam;

constexpr std::size_t simulated_history = 10;  // number of scans before the evaluated ones

struct Arguments
{
  std::string weights = "dyseg_simulated";
  std::string data;
  int worlds = 4;
  int scans = 24;
  NetworkSegmenterOptions network;
  int threads = 2;
  bool network_only = false;
  bool scenarios = false;  //!< evaluate scenarios instead of the sets
  bool instances = false;
  bool brief = false;    //!< omit the rows of pose errors
  std::string pictures;  //!< folder for one image per set; empty: none
  std::string only;      //!< evaluate only sets whose name contains this
};

void printRow(const std::string& set, const std::string& method, const SegmentationCounts& c)
{
  const double nan = std::nan("");
  auto ms = c.ms;
  std::sort(ms.begin(), ms.end());
  std::printf("%-22s %-28s IoU %.3f  precision %.3f  recall %.3f", set.c_str(), method.c_str(),
              c.iou().value_or(nan), c.precision().value_or(nan), c.recall().value_or(nan));
  if (!ms.empty())
  {
    auto cpu = c.cpu_ms;
    std::sort(cpu.begin(), cpu.end());
    std::printf("  median %.0f ms, min %.0f ms; CPU time %.0f and %.0f ms", ms[ms.size() / 2],
                ms.front(), cpu[cpu.size() / 2], cpu.front());
  }
  std::printf("\n");
  std::fflush(stdout);
}

void printInstances(const SegmentedInstances& network, const SegmentedInstances& baseline)
{
  std::printf(
      "  object, frames, mean distance [m], mean speed [m/s], points per frame, recall of the "
      "network, of the baseline\n");
  for (const auto& [id, n] : network)
  {
    const auto other = baseline.find(id);
    const auto recall = [](const SegmentedInstance& i)
    { return static_cast<double>(i.hits) / static_cast<double>(i.points); };
    const double speed = n.speeds > 0 ? n.speed / n.speeds : std::nan("");
    std::printf("  %6d %4d %6.1f %6.1f %7.0f   %.2f   %.2f\n", id, n.frames, n.distance / n.frames,
                speed, static_cast<double>(n.points) / n.frames, recall(n),
                other != baseline.end() ? recall(other->second) : 0.0);
  }
}

/** A body of a shape absent from the training data: an arch on two legs. */
CastBody arch()
{
  return assembleBody(BodyKind::random, {{{0, 1.1F, 0.8F}, {0.25F, 0.2F, 0.8F}, false},
                                         {{0, -1.1F, 0.8F}, {0.25F, 0.2F, 0.8F}, false},
                                         {{0, 0, 1.8F}, {0.3F, 1.4F, 0.2F}, false}});
}

void checkIdenticalScan(const DysegModel& model, const SegmentationSet& set)
{
  RandomDraws draws(5, 5);
  DysegScores sum;
  std::uint64_t points = 0;
  for (std::size_t f = set.first; f < set.clip.frames.size(); f += 3)
  {
    const Pose motion =
        poseFromYpr(draws.uniform(0, 2), draws.normal(0.05), 0, draws.normal(0.03), 0, 0);
    const auto sample = doubleScan(set.clip.frames[f].points, motion, draws);
    sum.add(scorePair(model, sample));
    points += static_cast<std::uint64_t>(std::count_if(sample.current.begin(), sample.current.end(),
                                                       [](const auto& p) { return isReturn(p); }));
  }
  std::printf(
      "%-22s identical scan, transformed: %.3f %% false positives, ego-motion error "
      "%.3f m, %.4f rad\n",
      set.name.c_str(),
      100.0 * static_cast<double>(sum.false_positives) / static_cast<double>(points),
      sum.translation_error / static_cast<double>(sum.pairs),
      sum.yaw_error / static_cast<double>(sum.pairs));
}

void checkUnseenShape(const DysegModel& model, const SegmentationSet& set)
{
  for (const double speed : {0.0, 1.5, 4.0, 10.0})
  {
    RandomDraws draws(6, 6);
    DysegScores sum;
    std::uint64_t on = 0;
    std::uint64_t predicted = 0;
    for (std::size_t f = std::max<std::size_t>(1, set.first); f < set.clip.frames.size(); f += 3)
    {
      auto sample = makeSample(set.clip, f, f - 1);
      const double bearing = draws.uniform(-3.14159, 3.14159);
      const double distance = draws.uniform(7, 20);
      const double heading = draws.uniform(-3.14159, 3.14159);
      const Pose now = poseFromYpr(distance * std::cos(bearing), distance * std::sin(bearing),
                                   -1.73, heading, 0, 0);
      const Pose then =
          sample.T_past_current * now * poseFromYpr(-speed * sample.elapsed, 0, 0, 0, 0, 0);
      const auto hit = castBody(arch(), now, 0.02F, draws, sample.current);
      castBody(arch(), then, 0.02F, draws, sample.past);
      const auto current = model.encode(sample.current);
      const auto past = model.encode(sample.past);
      const auto result = model.compare(*current, *past);
      for (const auto i : hit)
      {
        ++on;
        predicted += result.moving_probability[i] > 0.5F ? 1 : 0;
      }
    }
    std::printf(
        "%-22s arch (a shape absent from the training data) at %4.1f m/s: %.3f of its points "
        "predicted moving\n",
        set.name.c_str(), speed,
        on > 0 ? static_cast<double>(predicted) / static_cast<double>(on) : 0.0);
  }
}

std::vector<SegmentationSet> makeSets(const Arguments& a)
{
  std::vector<SegmentationSet> sets;
  const auto wanted = [&](const std::string& name)
  { return a.only.empty() || name.find(a.only) != std::string::npos; };
  struct Kind
  {
    const char* name;
    DysegClipScene scene;
  };
  const Kind kinds[] = {
      {"simulated street", {}},
      {"simulated highway", {sim::WorldKind::highway, sim::SensorKind::hdl64e, -1}},
      {"simulated campus", {sim::WorldKind::campus, sim::SensorKind::hdl64e, -1}},
      {"simulated campus 16", {sim::WorldKind::campus, sim::SensorKind::vlp16, -1}}};
  for (const auto& kind : kinds)
  {
    for (int w = 0; w < a.worlds; ++w)
    {
      const auto name = std::string(kind.name) + ", " + std::to_string(w);
      if (wanted(name))
      {
        const auto seed = unseen_seeds + 100 + static_cast<std::uint64_t>(w);
        sets.push_back({name, simulateClip(seed, a.scans, true, kind.scene), simulated_history});
      }
    }
  }
  if (!a.data.empty())
  {
    if (wanted("vls128_run88 48-63"))
    {
      sets.push_back(
          {"vls128_run88 48-63", loadBoxedRun(a.data + "/vls128_run88", 36, 63, {}), 12});
    }
    const auto drive = a.data + "/kitti_raw_2011_09_26_drive_0005";
    if (wanted("drive 0005 0-109"))
    {
      sets.push_back({"drive 0005 0-109",
                      loadLabelledRun(drive, drive + "/poses_icp_raw_velo.txt", 0, 109), 1});
    }
  }
  return sets;
}

NetworkSegmenterOptions networkOptions(const Arguments& a)
{
  NetworkSegmenterOptions options = a.network;
  options.weights = a.weights;
  options.threads = a.threads;
  return options;
}

std::string pictureOf(const Arguments& a, const SegmentationSet& set)
{
  std::string name = set.name;
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c == ' ' || c == '/' || c == ','; }, '_');
  return a.pictures.empty() ? "" : a.pictures + "/dyseg_" + name + ".ppm";
}

void printFlow(const Arguments& a, const DysegModel& model, const SegmentationSet& set)
{
  DysegScores flow;
  for (std::size_t f = std::max<std::size_t>(1, set.first); f < set.clip.frames.size(); f += 4)
  {
    flow.add(scorePair(model, makeSample(set.clip, f, f - 1), nullptr, a.network.iterations));
  }
  const auto mean = [](double sum, std::uint64_t n)
  { return n > 0 ? sum / static_cast<double>(n) : std::nan(""); };
  std::printf(
      "%-22s flow per cell: EPE all %.3f m, static %.3f m, moving %.3f m; ego-motion error %.3f "
      "m, %.4f rad\n",
      set.name.c_str(),
      mean(flow.static_error + flow.moving_error, flow.static_cells + flow.moving_cells),
      mean(flow.static_error, flow.static_cells), mean(flow.moving_error, flow.moving_cells),
      mean(flow.translation_error, flow.pairs), mean(flow.yaw_error, flow.pairs));
}

constexpr double degree = 0.017453293;
const std::pair<double, double> pose_errors[] = {
    {0.0, 0.0}, {0.05, 0.25 * degree}, {0.1, 0.5 * degree}};

void printTable(const Arguments& a)
{
  const DysegModel model(findGivenOrShared(a.weights, "models", ".safetensors"), a.threads);
  ThreadPool pool(a.threads);
  for (const auto& set : makeSets(a))
  {
    if (!a.network_only)
    {
      auto options = networkOptions(a);
      options.first_gap = 1;
      NetworkSegmenter one(options);
      printRow(set.name, "network, 1 scan back", runSegmenter(one, set));
    }
    NetworkSegmenter network(networkOptions(a));
    SegmentedInstances by_network;
    char name[64];
    std::snprintf(name, sizeof(name), "network, %d scans back", a.network.first_gap);
    printRow(set.name, name, runSegmenter(network, set, {}, &by_network, pictureOf(a, set)));
    if (a.network_only)
    {
      continue;
    }
    SegmentedInstances by_baseline;
    for (const auto& [m, rad] : pose_errors)
    {
      if (a.brief && m > 0)
      {
        break;
      }
      ResidualSegmenter residual(ResidualSegmenterOptions(), pool);
      std::snprintf(name, sizeof(name), "residual, pose error %.2f m", m);
      printRow(set.name, name,
               runSegmenter(residual, set, {m, rad}, m == 0 ? &by_baseline : nullptr));
    }
    printFlow(a, model, set);
    if (a.instances)
    {
      printInstances(by_network, by_baseline);
    }
    checkIdenticalScan(model, set);
    checkUnseenShape(model, set);
  }
}

/** Traffic scenarios: recall of moving points and false positive rate. */
void printScenarios(const Arguments& a)
{
  constexpr int streets = 3;
  ThreadPool pool(a.threads);
  std::printf("%-26s %15s  %-24s  %s\n", "scenario", "moving per scan", "network",
              "residual, exact poses");
  for (const auto& scenario : makeScenarios(unseen_seeds + 200, streets))
  {
    SegmentationCounts sums[2];
    std::size_t evaluated = 0;
    for (const auto& set : scenario.sets)
    {
      NetworkSegmenter network(networkOptions(a));
      ResidualSegmenter residual(ResidualSegmenterOptions(), pool);
      const bool with_picture = &set == &scenario.sets.front();
      const SegmentationCounts counts[] = {
          runSegmenter(network, set, {}, nullptr, with_picture ? pictureOf(a, set) : ""),
          runSegmenter(residual, set)};
      for (int k = 0; k < 2; ++k)
      {
        sums[k].add(counts[k]);
        sums[k].static_points += counts[k].static_points;
      }
      evaluated += set.clip.frames.size() - set.first;
    }
    std::printf("%-26s %15.0f", scenario.name.c_str(),
                static_cast<double>(sums[0].true_positives + sums[0].false_negatives) /
                    static_cast<double>(evaluated));
    for (const auto& c : sums)
    {
      std::printf(
          "  recall %.3f FPR %.4f %%", c.recall().value_or(std::nan("")),
          100 * static_cast<double>(c.false_positives) / static_cast<double>(c.static_points));
    }
    std::printf("\n");
    std::fflush(stdout);
  }
}
}  // namespace

int main(int argc, char** argv)
{
  Arguments a;
  CLI::App app("Evaluates moving-point segmentation on simulated and real sets");
  app.add_option("--weights", a.weights, "network, a file or a shipped name");
  app.add_option("--data", a.data, "folder of the real sets")->envname("DYSLAM_DATA");
  app.add_option("--worlds", a.worlds, "simulated worlds of each kind");
  app.add_option("--scans", a.scans, "scans of each simulated set")
      ->check(CLI::Range(static_cast<int>(simulated_history) + 1, 100000));
  app.add_option("--threads", a.threads, "threads");
  app.add_option("--first-gap", a.network.first_gap, "as in [dyseg_network]");
  app.add_option("--iterations", a.network.iterations, "as in [dyseg_network]");
  app.add_option("--threshold", a.network.threshold, "as in [dyseg_network]");
  app.add_option("--min-points", a.network.min_points, "as in [dyseg_network]");
  app.add_option("--only", a.only, "only sets whose name contains this");
  app.add_option("--pictures", a.pictures, "folder for a bird's-eye view of each set (PPM)");
  app.add_flag("--instances", a.instances, "recall of each object as well");
  app.add_flag("--network-only", a.network_only, "one row per set");
  app.add_flag("--short", a.brief, "without the rows of pose errors");
  app.add_flag("--scenarios", a.scenarios, "traffic scenarios instead of the sets");
  CLI11_PARSE(app, argc, argv);
  try
  {
    a.scenarios ? printScenarios(a) : printTable(a);
  }
  catch (const dyslam::UserError& error)
  {
    std::fprintf(stderr, "dyseg_table: %s\n", error.what());
    return 1;
  }
  return 0;
}
