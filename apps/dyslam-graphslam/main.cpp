// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Heap.h>
#include <dyslam/graphslam/GraphSlamPlugins.h>
#include <dyslam/graphslam/GraphSlamRun.h>

#include <algorithm>
#include <string>
#include <vector>

#include "../common/AppMain.h"
#include "../common/OutputOptions.h"
#include "../common/SlamProgram.h"
#include "GraphOptimisation.h"

namespace
{
using dyslam::UserError;

struct Arguments
{
  dyslam::SlamArguments slam;
  dyslam::GraphSlamPluginNames plugins;
  std::string graph;  //!< to optimise
  bool list_registrars = false;
  bool list_optimizers = false;
  const CLI::App* parser = nullptr;  //!< of the command line
};

void declare(CLI::App& app, Arguments& a)
{
  a.parser = &app;
  app.description(
      "MRPT's graph-SLAM engine with our odometry, loops and optimiser on a rawlog, without a "
      "window; or optimises a saved graph");
  app.add_option("-r,--rawlog,-i,--input", a.slam.settings.rawlog, "rawlog to replay");
  app.add_option("-n,--node-reg", a.plugins.node_decider, "node registration decider");
  app.add_option("-e,--edge-reg", a.plugins.edge_decider, "edge registration decider");
  dyslam::addOutputFile(app, "-o,--optimizer", a.plugins.optimizer,
                        "optimizer; with --optimize: the file to write");
  dyslam::addOutputFolder(app, "--output", a.slam.settings.output_folder,
                          "folder for the results; with --optimize: the file to write")
      ->default_str("graphslam_results");
  app.add_flag("--list-registrars,--list-regs", a.list_registrars,
               "list the node and edge registration deciders");
  app.add_flag("--list-optimizers", a.list_optimizers, "list the optimizers");
  app.add_option("--optimize", a.graph,
                 "saved graph to optimise: factor_graph.txt, .graph or .g2o");
  dyslam::declareSlamArguments(app, a.slam);
}

template <typename Plugin>
void list(const char* title, const std::vector<dyslam::GraphSlamPlugin<Plugin>>& plugins)
{
  std::printf("%s\n", title);
  for (const auto& plugin : plugins)
  {
    std::printf("  %-22s %s\n", plugin.name, plugin.description);
  }
}

/** \return whether a list was asked for. */
bool showLists(const Arguments& a)
{
  if (a.list_registrars)
  {
    list("Node registration deciders:", dyslam::nodeDeciders());
    list("Edge registration deciders:", dyslam::edgeDeciders());
  }
  if (a.list_optimizers)
  {
    list("Optimizers:", dyslam::graphOptimizers());
  }
  return a.list_registrars || a.list_optimizers;
}

/** Requires that all given flags have a meaning for --optimize. \throws UserError naming one. */
void requireGraphFlags(const CLI::App& parser)
{
  const std::vector<std::string> known = {"--optimize", "--output", "--optimizer",
                                          "--set",      "--quiet",  "--verbosity"};
  for (const CLI::Option* option :
       parser.get_options([](const CLI::Option* o) { return o->count() > 0; }))
  {
    if (std::find(known.begin(), known.end(), option->get_name()) == known.end())
    {
      throw UserError("--optimize takes a saved graph instead of a rawlog; " + option->get_name() +
                      " does not apply to it");
    }
  }
}

/** Optimises the graph of --optimize. \throws UserError, also for flags of a recording. */
void optimiseSavedGraph(const Arguments& a)
{
  requireGraphFlags(*a.parser);
  if (!a.slam.settings.output_folder.empty() && !a.plugins.optimizer.empty())
  {
    throw UserError("--optimize writes one file: give -o or --output, not both");
  }
  dyslam::GraphOptimisation job;
  job.input = a.graph;
  job.output = a.plugins.optimizer.empty() ? a.slam.settings.output_folder : a.plugins.optimizer;
  job.quiet = a.slam.quiet();
  for (const auto& assignment : a.slam.assignments)
  {
    job.config.set(assignment);
  }
  dyslam::optimiseGraph(job);
}

void run(Arguments& a)
{
  if (showLists(a))
  {
    return;
  }
  if (!a.graph.empty())
  {
    optimiseSavedGraph(a);
    return;
  }
  if (a.slam.settings.rawlog.empty())
  {
    throw UserError("--rawlog is required (or --optimize; see dyslam-graphslam --help)");
  }
  if (a.slam.settings.output_folder.empty())
  {
    a.slam.settings.output_folder = "graphslam_results";
  }
  dyslam::repeatConversionWarnings(a.slam);
  dyslam::runSlamProgram("dyslam-graphslam", a.slam,
                         [&a](const auto& settings, const auto& on_frame)
                         { return dyslam::runGraphSlam(settings, a.plugins, on_frame); });
}
}  // namespace

int main(int argc, char** argv)
{
  dyslam::tuneHeap();
  Arguments a;
  return dyslam::runApp(
      argc, argv, [&](CLI::App& app) { declare(app, a); }, [&] { run(a); });
}
