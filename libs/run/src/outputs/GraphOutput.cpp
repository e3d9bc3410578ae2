// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/Backend.h>
#include <dyslam/backend/FactorGraphFile.h>
#include <dyslam/formats/RunFiles.h>
#include <dyslam/io/GraphFiles.h>
#include <mrpt/graphs/CNetworkOfPoses.h>

#include "RunOutput.h"

namespace dyslam
{
namespace
{
constexpr const char* mrpt_file = "graph.graph";
constexpr const char* g2o_file = "graph.g2o";

/** Ego poses as `graph.graph` (MRPT) and `graph.g2o`, the whole graph as `factor_graph.txt`. */
class GraphOutput : public RunOutput
{
 public:
  explicit GraphOutput(const RunOutputContext& context)
      : RunOutput(context, {mrpt_file, g2o_file, run_files::factor_graph})
  {
  }
  void checkpoint(const RunResults& results) override { finish(results); }
  void finish(const RunResults& results) override
  {
    const PoseGraph graph = results.backend->graph();
    eachByItself(
        {[&] { writeGraph(graph, path(mrpt_file)); }, [&] { writeG2o(graph, path(g2o_file)); },
         [&] { writeFactorGraph(results.backend->factorGraph(), path(run_files::factor_graph)); }});
  }
};
}  // namespace

std::unique_ptr<RunOutput> makeGraphOutput(const RunOutputContext& context)
{
  return std::make_unique<GraphOutput>(context);
}
}  // namespace dyslam
