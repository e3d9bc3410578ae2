// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/FactorGraphFile.h>
#include <dyslam/base/Error.h>
#include <dyslam/graphslam/GraphFileRun.h>
#include <dyslam/io/GraphFiles.h>

#include <chrono>
#include <filesystem>

namespace dyslam
{
namespace
{
using Graph = mrpt::graphs::CNetworkOfPoses3DInf;

using Writer = void (*)(const Graph& graph, const std::string& path);

double secondsSince(std::chrono::steady_clock::time_point start)
{
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

std::string nameOf(VariableKind kind)
{
  switch (kind)
  {
    case VariableKind::ego_pose:
      return "ego poses";
    case VariableKind::static_object:
      return "static objects";
    case VariableKind::object_pose:
      return "object poses";
    case VariableKind::georeference:
      return "georeference";
    case VariableKind::vertical:
      return "vertical";
    case VariableKind::accelerometer_bias:
      return "accelerometer bias";
    case VariableKind::prior_map:
      return "prior map";
    case VariableKind::object_velocity:
      break;
  }
  return "object velocities";
}

Writer writerFor(const std::string& path)
{
  const std::string extension = std::filesystem::path(path).extension().string();
  if (extension == ".graph")
  {
    return writeGraph;
  }
  if (extension == ".g2o")
  {
    return writeG2o;
  }
  throw UserError(path + ": unknown kind of graph file; end it in .graph or .g2o");
}
}  // namespace

GraphFileReport optimiseGraphFile(const std::string& input,
                                  const std::string& output,
                                  const Config& config)
{
  PoseGraphSolverOptions options;
  load(options, config, "pose_graph");
  const Writer write = output.empty() ? nullptr : writerFor(output);
  GraphFileReport report;
  Graph graph = readPoseGraph(input, &report.warnings);

  const PoseGraphSolver solver(options);
  const auto start = std::chrono::steady_clock::now();
  try
  {
    report.result = solver.solve(graph);
  }
  catch (const UserError& error)
  {
    throw UserError(input + ": " + error.what());
  }
  report.seconds = secondsSince(start);
  report.nodes = graph.nodeCount();
  report.edges = graph.edgeCount();
  if (write != nullptr)
  {
    write(graph, output);
  }
  return report;
}

FactorGraphFileReport optimiseFactorGraphFile(const std::string& input,
                                              const std::string& output,
                                              const Config& config)
{
  const std::string extension = std::filesystem::path(output).extension().string();
  if (extension == ".g2o" || extension == ".graph")
  {
    throw UserError(output + ": a factor graph with objects is written as .txt only");
  }
  FactorGraphOptions options;
  load(options, config, "solver");
  FactorGraphFileReport report;
  FactorGraph graph = readFactorGraph(input, report.warnings);
  for (const auto& [key, variable] : graph.variables())
  {
    ++report.variables[nameOf(key.kind)];
  }
  for (const FactorGraph::FactorId id : graph.factorIds())
  {
    ++report.factors[graph.factor(id).type().name];
  }
  const auto start = std::chrono::steady_clock::now();
  report.result = graph.optimise(options);
  report.seconds = secondsSince(start);
  if (!output.empty())
  {
    writeFactorGraph(graph, output);
  }
  return report;
}
}  // namespace dyslam
