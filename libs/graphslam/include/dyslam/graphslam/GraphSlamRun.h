// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/run/RunSlam.h>

#include <string>

namespace dyslam
{
/** Classes that are plugged into MRPT's engine, by name; empty: the default. */
struct GraphSlamPluginNames
{
  std::string node_decider;
  std::string edge_decider;
  std::string optimizer;
};

/** As runSlam(), but driven by mrpt::graphslam::CGraphSlamEngine, without a window. With the
 * default plug-ins every file has the same bytes as by runSlam(), but for the times in report.json.
 *
 * Writes besides what MRPT's graphslam-engine does: `output_graph.graph` (the engine's network),
 * `CGraphSlamEngine.log`, `timings.log`, `node_registrar.log`, `edge_registrar.log` and
 * `optimizer.log`; and `engine.ini`, the settings of the engine.
 * \throws UserError as runSlam(), and for an unknown plug-in. */
SlamRunReport runGraphSlam(const SlamRunSettings& settings,
                           const GraphSlamPluginNames& plugins = {},
                           const FrameCallback& on_frame = {});
}  // namespace dyslam
