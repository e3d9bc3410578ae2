// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Error.h>
#include <dyslam/base/Words.h>
#include <dyslam/graphslam/GraphSlamContext.h>
#include <mrpt/graphslam/interfaces/CEdgeRegistrationDecider.h>
#include <mrpt/graphslam/interfaces/CGraphSlamOptimizer.h>
#include <mrpt/graphslam/interfaces/CNodeRegistrationDecider.h>

#include <memory>
#include <string>
#include <vector>

namespace dyslam
{
using NodeDecider = mrpt::graphslam::deciders::CNodeRegistrationDecider<GraphSlamContext::Graph>;
using EdgeDecider = mrpt::graphslam::deciders::CEdgeRegistrationDecider<GraphSlamContext::Graph>;
using GraphOptimizer = mrpt::graphslam::optimizers::CGraphSlamOptimizer<GraphSlamContext::Graph>;

/** A class that can be plugged into the engine. */
template <typename Interface>
struct GraphSlamPlugin
{
  const char* name;
  const char* description;
  std::unique_ptr<Interface> (*make)(const std::shared_ptr<GraphSlamContext>& context);
};

/** All plug-ins of each kind; the first of each is the default. */
[[nodiscard]] std::vector<GraphSlamPlugin<NodeDecider>> nodeDeciders();
[[nodiscard]] std::vector<GraphSlamPlugin<EdgeDecider>> edgeDeciders();
[[nodiscard]] std::vector<GraphSlamPlugin<GraphOptimizer>> graphOptimizers();

/** The plug-in of that name; the first for an empty one.
 * \param kind for the message, as "edge decider" \param hint at the end of the message
 * \throws UserError for an unknown name, naming the nearest. */
template <typename Interface>
[[nodiscard]] GraphSlamPlugin<Interface> findPlugin(
    const std::vector<GraphSlamPlugin<Interface>>& plugins,
    const std::string& kind,
    const std::string& name,
    const std::string& hint = "")
{
  std::vector<std::string> names;
  for (const auto& plugin : plugins)
  {
    if (name.empty() || name == plugin.name)
    {
      return plugin;
    }
    names.emplace_back(plugin.name);
  }
  throw UserError(unknownWord(kind, name, names) + hint);
}
}  // namespace dyslam
