// SPDX-License-Identifier: BSD-3-Clause
// Benchmark sets of pose graphs: PoseGraphSolver compared with plain Ceres (autodiff, from the
// file's poses).
//   pose_graph_benchmark [--plain-limit SECONDS] [FOLDER]      FOLDER defaults to
//   $DYSLAM_DATA/pose_graphs
#include <dyslam/backend/PoseGraphSolver.h>
#include <dyslam/base/Error.h>
#include <dyslam/io/GraphFiles.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "PlainCeres.h"

namespace
{
struct Set
{
  const char* name;
  double best_known;  //!< lowest known chi2, by g2o's definition
};

// best_known is from the notes beside the data: the lowest chi2 found by Ceres 2.1 and g2o.
const std::vector<Set> sets = {{"sphere2500", 727.1497}, {"parking-garage", 1.23869},
                               {"torus3D", 14574.75},    {"cubicle", 2379.917},
                               {"kitti_00", 98.3220},    {"kitti_02", 78.7643},
                               {"kitti_05", 157.1044},   {"city10000", 511.985},
                               {"manhattan", 3549.0368}, {"intel", 45.0047},
                               {"MIT", 41.163},          {"CSAIL", 40.5551},
                               {"ais2klinik", 172.816},  {"smallGrid3D", 458.154},
                               {"tinyGrid3D", 6.7279}};

double secondsSince(std::chrono::steady_clock::time_point start)
{
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void runSet(const Set& set, const std::string& file, double plain_limit)
{
  using namespace dyslam;
  const PoseGraph graph = readPoseGraph(file);
  PoseGraphSolverOptions options;
  options.indefinite_information = IndefiniteInformation::project;
  const PoseGraphSolver solver(options);
  PoseGraph ours = graph;
  auto start = std::chrono::steady_clock::now();
  const PoseGraphResult result = solver.solve(ours);
  const double our_seconds = secondsSince(start);

  PoseGraph plain = graph;
  start = std::chrono::steady_clock::now();
  const int plain_iterations = solveByPlainCeres(plain, plain_limit);
  const double plain_seconds = secondsSince(start);
  std::printf(
      "| %s | %zu | %zu | %.8g | %.8g | %.3f | %d | %.8g | %.3f | %d | %s |\n", set.name,
      ours.nodes.size(), graph.edges.size(), set.best_known, result.final_chi2, our_seconds,
      result.iterations, solver.chi2(plain), plain_seconds, plain_iterations,
      result.projected_edges == 0
          ? ""
          : (std::to_string(result.projected_edges) + " indefinite edges projected").c_str());
  std::fflush(stdout);
}
}  // namespace

int main(int argc, char** argv)
{
  const char* data = std::getenv("DYSLAM_DATA");
  std::string folder = data != nullptr ? std::string(data) + "/pose_graphs" : "";
  double plain_limit = 60;
  for (int i = 1; i < argc; ++i)
  {
    if (std::string(argv[i]) == "--plain-limit" && i + 1 < argc)
    {
      plain_limit = std::atof(argv[++i]);
    }
    else
    {
      folder = argv[i];
    }
  }
  std::printf(
      "| set | nodes | edges | best known | ours chi2 | ours s | it | plain chi2 | plain s | it "
      "| note |\n|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const Set& set : sets)
  {
    const std::string file = folder + "/" + set.name + ".g2o";
    if (!std::filesystem::exists(file))
    {
      std::fprintf(stderr, "%s: not there, left out\n", file.c_str());
      continue;
    }
    try
    {
      runSet(set, file, plain_limit);
    }
    catch (const dyslam::UserError& error)
    {
      std::fprintf(stderr, "%s\n", error.what());
      return 1;
    }
  }
  return 0;
}
