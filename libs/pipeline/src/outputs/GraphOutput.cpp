// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/io/GraphFiles.h>

#include "../RunOutput.h"

namespace dyslam
{
namespace
{
constexpr const char* graph = "graph.graph";
constexpr const char* g2o = "graph.g2o";

/** The pose graph: `graph.graph` (MRPT) and `graph.g2o`. */
class GraphOutput : public RunOutput
{
 public:
  explicit GraphOutput(const RunOutputContext& context) : RunOutput(context, {graph, g2o}) {}
  void finish(const RunResults& results) override
  {
    writeGraph(*results.graph, path(graph));
    writeG2o(*results.graph, path(g2o));
  }
};
}  // namespace

std::unique_ptr<RunOutput> makeGraphOutput(const RunOutputContext& context)
{
  return std::make_unique<GraphOutput>(context);
}
}  // namespace dyslam
