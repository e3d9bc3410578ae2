// SPDX-License-Identifier: BSD-3-Clause
// Prints how well moving points are found: the network, and the residual baseline with given poses.
#include <dyslam/core/Error.h>
#include <dyslam/core/Scan.h>
#include <dyslam/core/SharedFiles.h>
#include <dyslam/dyseg/NetworkSegmenter.h>
#include <dyslam/dyseg/ResidualSegmenter.h>
#include <dyslam/dyseg/TemporalFilter.h>
#include <dyslam/train/DysegBodies.h>
#include <dyslam/train/DysegScores.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fstream>
#include <map>
#include <string>
#include <vector>

namespace
{
using namespace dyslam;

constexpr std::uint64_t unseen_seeds = 900000000;  // the trainer never draws these

struct Arguments
{
  std::string weights = "dyseg";
  std::string data;
  int worlds = 4;
  int scans = 8;
  int second_gap = 4;
  std::string combine = "mean";
  int iterations = 2;
  int threads = 2;
  bool instances = false;
  bool brief = false;    //!< without the rows of wrong poses
  std::string pictures;  //!< folder for one picture of each set
  std::string only;      //!< part of the names of the sets to print
};

struct Set
{
  std::string name;
  DysegClip clip;
  std::size_t first = 0;  //!< first frame that is judged; those before are history
};

struct Counts
{
  std::uint64_t hits = 0, alarms = 0, misses = 0;
  std::vector<double> ms;
  std::vector<double> cpu_ms;  //!< processor time of all threads
};

void printRow(const std::string& set, const std::string& method, const Counts& c)
{
  const auto share = [](std::uint64_t a, std::uint64_t b)
  { return b > 0 ? static_cast<double>(a) / static_cast<double>(b) : 0.0; };
  auto ms = c.ms;
  std::sort(ms.begin(), ms.end());
  std::printf("%-22s %-28s IoU %.3f  precision %.3f  recall %.3f", set.c_str(), method.c_str(),
              share(c.hits, c.hits + c.alarms + c.misses), share(c.hits, c.hits + c.alarms),
              share(c.hits, c.hits + c.misses));
  if (!ms.empty())
  {
    auto cpu = c.cpu_ms;
    std::sort(cpu.begin(), cpu.end());
    std::printf("  median %.0f ms, least %.0f ms; of processor time %.0f and %.0f ms",
                ms[ms.size() / 2], ms.front(), cpu[cpu.size() / 2], cpu.front());
  }
  std::printf("\n");
  std::fflush(stdout);
}

/** The scan from above, 80 m square, x up: grey static, green found movers, red missed ones, blue
 * false alarms. */
void writePicture(const std::string& file,
                  const Frame& frame,
                  const std::vector<std::uint8_t>& label)
{
  constexpr int side = 800;
  constexpr float half = 40;
  std::vector<std::uint8_t> image(3 * side * side, 255);
  const std::uint8_t colours[4][3] = {{150, 150, 150}, {40, 90, 255}, {230, 30, 30}, {0, 160, 40}};
  for (int kind = 0; kind < 4; ++kind)
  {
    for (std::size_t k = 0; k < frame.cloud.size(); ++k)
    {
      const bool called = frame.moving_probability[k] > 0.5F;
      const auto truth = label[frame.cloud.source[k]];
      const bool moves = truth == DysegSample::moving_point;
      const bool alarm = called && truth == DysegSample::static_point;
      if (kind != (moves ? (called ? 3 : 2) : (alarm ? 1 : 0)))
      {
        continue;
      }
      const auto& p = frame.cloud.points[k];
      const int row = static_cast<int>((half - p.x()) / (2 * half) * side);
      const int column = static_cast<int>((half - p.y()) / (2 * half) * side);
      for (int n = 0; n < (kind == 0 ? 1 : 4); ++n)
      {
        const int y = row + n / 2;
        const int x = column + n % 2;
        if (x >= 0 && y >= 0 && x < side && y < side)
        {
          std::copy_n(colours[kind], 3, &image[static_cast<std::size_t>(3 * (y * side + x))]);
        }
      }
    }
  }
  std::ofstream out(file, std::ios::binary);
  out << "P6\n" << side << ' ' << side << "\n255\n";
  out.write(reinterpret_cast<const char*>(image.data()),
            static_cast<std::streamsize>(image.size()));
  if (!out)
  {
    throw UserError(file + ": cannot be written");
  }
}

struct Instance
{
  double distance = 0;
  double speed = 0;
  int frames = 0;
  std::uint64_t points = 0;
  std::uint64_t hits = 0;
};

/** Runs a segmenter over a set in order, as the pipeline does. Each step's pose may be off. */
Counts judge(MovingSegmenter& segmenter,
             const Set& set,
             double noise_m,
             double noise_rad,
             std::map<std::int32_t, Instance>* instances,
             const std::string& picture = {})
{
  Counts counts;
  RandomDraws draws(11, 1);
  Pose drift = Pose::Identity();
  for (std::size_t f = 0; f < set.clip.frames.size(); ++f)
  {
    const auto& from = set.clip.frames[f];
    Frame frame;
    frame.index = f;
    for (std::size_t i = 0; i < from.points.size(); ++i)
    {
      if (isReturn(from.points[i]))
      {
        frame.cloud.points.push_back(from.points[i]);
        frame.cloud.source.push_back(static_cast<std::uint32_t>(i));
      }
    }
    const double bearing = draws.uniform(-3.14159, 3.14159);
    drift = drift * poseFromYpr(noise_m * std::cos(bearing), noise_m * std::sin(bearing), 0,
                                draws.chance(0.5) ? noise_rad : -noise_rad, 0, 0);
    frame.T_odom_vehicle = from.T_world_sensor * drift;
    const auto start = std::chrono::steady_clock::now();
    const auto start_cpu = std::clock();
    segmenter.segment(frame);
    counts.cpu_ms.push_back(1e3 * static_cast<double>(std::clock() - start_cpu) / CLOCKS_PER_SEC);
    counts.ms.push_back(
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
            .count());
    if (f < set.first)
    {
      continue;
    }
    const auto truth = makeSample(set.clip, f, f > 0 ? f - 1 : 0);
    if (!picture.empty() && f == (set.first + set.clip.frames.size()) / 2)
    {
      writePicture(picture, frame, truth.label);
    }
    std::map<std::int32_t, std::pair<int, int>> seen;
    for (std::size_t k = 0; k < frame.cloud.size(); ++k)
    {
      const auto i = frame.cloud.source[k];
      const bool called = frame.moving_probability[k] > 0.5F;
      if (truth.label[i] == DysegSample::moving_point)
      {
        (called ? counts.hits : counts.misses) += 1;
        auto& s = seen[from.object[i]];
        s.first += 1;
        s.second += called ? 1 : 0;
      }
      else if (truth.label[i] == DysegSample::static_point)
      {
        counts.alarms += called ? 1 : 0;
      }
    }
    for (const auto& [id, s] : seen)
    {
      if (instances == nullptr || s.first < 10)
      {
        continue;
      }
      auto& entry = (*instances)[id > 100000 ? id % 100000 : id];
      const auto& object = from.objects.at(id);
      entry.distance += object.T_sensor_object.translation().norm();
      if (f > 0 && set.clip.frames[f - 1].objects.count(id) != 0)
      {
        const auto& before = set.clip.frames[f - 1];
        entry.speed +=
            ((before.T_world_sensor * before.objects.at(id).T_sensor_object).translation() -
             (from.T_world_sensor * object.T_sensor_object).translation())
                .norm() /
            set.clip.period;
      }
      ++entry.frames;
      entry.points += static_cast<std::uint64_t>(s.first);
      entry.hits += static_cast<std::uint64_t>(s.second);
    }
  }
  return counts;
}

void printInstances(const std::map<std::int32_t, Instance>& network,
                    const std::map<std::int32_t, Instance>& baseline)
{
  std::printf(
      "  object, frames, mean distance [m], mean speed [m/s], points per frame, recall of the "
      "network, of the baseline\n");
  for (const auto& [id, n] : network)
  {
    const auto other = baseline.find(id);
    const auto recall = [](const Instance& i)
    { return static_cast<double>(i.hits) / static_cast<double>(i.points); };
    std::printf("  %6d %4d %6.1f %6.1f %7.0f   %.2f   %.2f\n", id, n.frames, n.distance / n.frames,
                n.speed / n.frames, static_cast<double>(n.points) / n.frames, recall(n),
                other != baseline.end() ? recall(other->second) : 0.0);
  }
}

/** A body of a shape that training never makes: an arch on two legs. */
CastBody arch()
{
  CastBody body;
  body.kind = "arch";
  body.parts.push_back({{0, 1.1F, 0.8F}, {0.25F, 0.2F, 0.8F}, false});
  body.parts.push_back({{0, -1.1F, 0.8F}, {0.25F, 0.2F, 0.8F}, false});
  body.parts.push_back({{0, 0, 1.8F}, {0.3F, 1.4F, 0.2F}, false});
  body.radius = 1.5F;
  return body;
}

void checkTwice(const DysegModel& model, const Set& set)
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
      "%-22s same scan twice, moved: %.3f %% of points called moving, ego motion off by "
      "%.3f m, %.4f rad\n",
      set.name.c_str(), 100.0 * static_cast<double>(sum.alarms) / static_cast<double>(points),
      sum.translation_error / static_cast<double>(sum.pairs),
      sum.yaw_error / static_cast<double>(sum.pairs));
}

void checkUnseenShape(const DysegModel& model, const Set& set)
{
  for (const double speed : {0.0, 1.5, 4.0, 10.0})
  {
    RandomDraws draws(6, 6);
    DysegScores sum;
    std::uint64_t on = 0;
    std::uint64_t called = 0;
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
        called += result.moving_probability[i] > 0.5F ? 1 : 0;
      }
    }
    std::printf(
        "%-22s arch (a shape never trained on) at %4.1f m/s: %.3f of its points called "
        "moving\n",
        set.name.c_str(), speed,
        on > 0 ? static_cast<double>(called) / static_cast<double>(on) : 0.0);
  }
}

std::vector<Set> makeSets(const Arguments& a)
{
  std::vector<Set> sets;
  const auto wanted = [&](const std::string& name)
  { return a.only.empty() || name.find(a.only) != std::string::npos; };
  for (int w = 0; w < a.worlds && wanted("simulated"); ++w)
  {
    sets.push_back({"simulated " + std::to_string(w),
                    simulateClip(unseen_seeds + 100 + static_cast<std::uint64_t>(w), a.scans, true),
                    1});
  }
  if (!a.data.empty())
  {
    if (wanted("vls128_run88 48-63"))
    {
      sets.push_back({"vls128_run88 48-63", loadBoxedRun(a.data + "/vls128_run88", 36, 63), 12});
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

NetworkSegmenterOptions networkOptions(const Arguments& a, int second_gap)
{
  NetworkSegmenterOptions options;
  options.weights = a.weights;
  options.threads = a.threads;
  options.iterations = a.iterations;
  options.second_gap = second_gap;
  options.combine = a.combine;
  return options;
}

std::string pictureOf(const Arguments& a, const Set& set)
{
  std::string name = set.name;
  std::replace(name.begin(), name.end(), ' ', '_');
  return a.pictures.empty() ? "" : a.pictures + "/dyseg_" + name + ".ppm";
}

void printFlow(const Arguments& a, const DysegModel& model, const Set& set)
{
  DysegScores flow;
  for (std::size_t f = std::max<std::size_t>(1, set.first); f < set.clip.frames.size(); f += 4)
  {
    flow.add(scorePair(model, makeSample(set.clip, f, f - 1), a.iterations));
  }
  const auto mean = [](double sum, std::uint64_t n)
  { return n > 0 ? sum / static_cast<double>(n) : std::nan(""); };
  std::printf(
      "%-22s flow per cell: EPE all %.3f m, static %.3f m, moving %.3f m; ego motion off by %.3f "
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
  const DysegModel model(findGivenOrShared(a.weights, "models", ".pt"), a.threads);
  ThreadPool pool(a.threads);
  for (const auto& set : makeSets(a))
  {
    NetworkSegmenter one(networkOptions(a, 0));
    printRow(set.name, "network, 1 scan back", judge(one, set, 0, 0, nullptr));
    NetworkSegmenter two(networkOptions(a, a.second_gap));
    std::map<std::int32_t, Instance> by_network;
    char name[64];
    std::snprintf(name, sizeof(name), "network, 1 and %d back", a.second_gap);
    printRow(set.name, name, judge(two, set, 0, 0, &by_network, pictureOf(a, set)));
    for (const auto& [m, rad] : pose_errors)
    {
      if (a.brief && m > 0)
      {
        break;
      }
      TemporalFilter filtered(TemporalFilterOptions(),
                              std::make_unique<NetworkSegmenter>(networkOptions(a, a.second_gap)));
      std::snprintf(name, sizeof(name), "the same, filter, poses off %.2f m", m);
      printRow(set.name, name, judge(filtered, set, m, rad, nullptr));
    }
    std::map<std::int32_t, Instance> by_baseline;
    for (const auto& [m, rad] : pose_errors)
    {
      if (a.brief && m > 0)
      {
        break;
      }
      ResidualSegmenter residual(ResidualSegmenterOptions(), pool);
      std::snprintf(name, sizeof(name), "residual, poses off %.2f m", m);
      printRow(set.name, name, judge(residual, set, m, rad, m == 0 ? &by_baseline : nullptr));
    }
    TemporalFilter filtered(TemporalFilterOptions(),
                            std::make_unique<ResidualSegmenter>(ResidualSegmenterOptions(), pool));
    printRow(set.name, "residual, filter", judge(filtered, set, 0, 0, nullptr));
    printFlow(a, model, set);
    if (a.instances)
    {
      printInstances(by_network, by_baseline);
    }
    checkTwice(model, set);
    checkUnseenShape(model, set);
  }
}
}  // namespace

int main(int argc, char** argv)
{
  Arguments a;
  if (const char* folder = std::getenv("DYSLAM_DATA"))
  {
    a.data = folder;
  }
  for (int i = 1; i < argc; ++i)
  {
    const std::string word = argv[i];
    const bool more = i + 1 < argc;
    if (word == "--instances")
    {
      a.instances = true;
    }
    else if (more && word == "--weights")
    {
      a.weights = argv[++i];
    }
    else if (more && word == "--worlds")
    {
      a.worlds = std::atoi(argv[++i]);
    }
    else if (more && word == "--scans")
    {
      a.scans = std::atoi(argv[++i]);
    }
    else if (more && word == "--second-gap")
    {
      a.second_gap = std::atoi(argv[++i]);
    }
    else if (more && word == "--combine")
    {
      a.combine = argv[++i];
    }
    else if (more && word == "--pictures")
    {
      a.pictures = argv[++i];
    }
    else if (word == "--short")
    {
      a.brief = true;
    }
    else if (more && word == "--only")
    {
      a.only = argv[++i];
    }
    else if (more && word == "--iterations")
    {
      a.iterations = std::atoi(argv[++i]);
    }
    else if (more && word == "--threads")
    {
      a.threads = std::atoi(argv[++i]);
    }
    else
    {
      std::puts(
          "dyseg_table [--weights FILE] [--worlds N] [--scans N] [--second-gap N] [--iterations "
          "N]\n"
          "            [--combine mean|max] [--threads N] [--instances]\n"
          "            [--only SET]   sets whose name holds SET\n"
          "            [--short]      without the rows of wrong poses\n"
          "            [--pictures DIR]   one scan of each set from above, DIR/dyseg_SET.ppm\n"
          "Real sets are read from $DYSLAM_DATA.");
      return word == "--help" ? 0 : 1;
    }
  }
  try
  {
    printTable(a);
  }
  catch (const dyslam::UserError& error)
  {
    std::fprintf(stderr, "dyseg_table: %s\n", error.what());
    return 1;
  }
  return 0;
}
