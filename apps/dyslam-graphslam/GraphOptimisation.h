// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Config.h>

#include <string>

namespace dyslam
{
/** A saved graph to optimise. */
struct GraphOptimisation
{
  std::string input;   //!< factor_graph.txt, .graph or .g2o
  std::string output;  //!< file to write; empty: none
  Config config;       //!< section [solver] for a factor graph, [pose_graph] for the others
  bool quiet = false;  //!< print warnings only
};

/** Optimises a saved graph and prints the figures. \throws UserError for a bad file or setting. */
void optimiseGraph(const GraphOptimisation& job);
}  // namespace dyslam
