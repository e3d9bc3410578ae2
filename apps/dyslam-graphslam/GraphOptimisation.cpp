// SPDX-License-Identifier: BSD-3-Clause
#include "GraphOptimisation.h"

#include <dyslam/backend/FactorGraphFile.h>
#include <dyslam/base/Printable.h>
#include <dyslam/graphslam/GraphFileRun.h>

#include <cstddef>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

namespace dyslam
{
namespace
{
void printCounts(const char* title, const std::map<std::string, std::size_t>& counts)
{
  std::printf("%s:", title);
  const char* separator = " ";
  for (const auto& [kind, count] : counts)
  {
    std::printf("%s%zu %s", separator, count, kind.c_str());
    separator = ", ";
  }
  std::printf("\n");
}

void printWritten(const std::string& output)
{
  if (!output.empty())
  {
    std::printf("written: %s\n", output.c_str());
  }
}

void printSolution(int iterations, double seconds, const std::string& reason)
{
  std::printf("%s, %.3f s: %s\n",
              counted(static_cast<std::size_t>(iterations), "iteration").c_str(), seconds,
              reason.c_str());
}

void printWarnings(const std::vector<std::string>& warnings)
{
  for (const std::string& warning : warnings)
  {
    std::fprintf(stderr, "warning: %s\n", printable(warning).c_str());
  }
}

void optimiseFactorGraph(const GraphOptimisation& job)
{
  const FactorGraphFileReport report = optimiseFactorGraphFile(job.input, job.output, job.config);
  const OptimisationResult& result = report.result;
  printWarnings(report.warnings);
  printWarnings(result.warnings);
  if (job.quiet)
  {
    return;
  }
  printCounts("variables", report.variables);
  printCounts("factors", report.factors);
  std::printf("chi2 of the file %.9g, final %.9g; %s left out\n", result.initial_chi2,
              result.final_chi2, counted(result.false_loops, "loop").c_str());
  printSolution(result.iterations, report.seconds, result.reason);
  printWritten(job.output);
}

void optimisePoseGraph(const GraphOptimisation& job)
{
  const GraphFileReport report = optimiseGraphFile(job.input, job.output, job.config);
  printWarnings(report.warnings);
  if (job.quiet)
  {
    return;
  }
  const PoseGraphResult& result = report.result;
  std::printf("%s: %s, %s\n", job.input.c_str(), counted(report.nodes, "node").c_str(),
              counted(report.edges, "edge").c_str());
  std::printf("chi2 of the file %.9g, where the optimisation began %.9g, final %.9g\n",
              result.start_chi2, result.initial_chi2, result.final_chi2);
  printSolution(result.iterations, report.seconds, result.reason);
  if (result.projected_edges > 0)
  {
    std::printf("%s had no positive definite information; the nearest was used\n",
                counted(result.projected_edges, "edge").c_str());
  }
  printWritten(job.output);
}
}  // namespace

void optimiseGraph(const GraphOptimisation& job)
{
  const bool has_objects = isFactorGraphFile(job.input);
  job.config.requireKnownSections({has_objects ? "solver" : "pose_graph"});
  if (has_objects)
  {
    optimiseFactorGraph(job);
  }
  else
  {
    optimisePoseGraph(job);
  }
}
}  // namespace dyslam
