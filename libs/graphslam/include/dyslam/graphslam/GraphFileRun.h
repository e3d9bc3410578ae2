// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/FactorGraph.h>
#include <dyslam/backend/PoseGraphSolver.h>
#include <dyslam/base/Config.h>

#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace dyslam
{
/** Result of optimising a saved graph. */
struct GraphFileReport
{
  std::size_t nodes = 0;
  std::size_t edges = 0;
  PoseGraphResult result;
  std::vector<std::string> warnings;  //!< about the file
  double seconds = 0;                 //!< time of the optimisation, without reading and writing [s]
};

/** Optimises a saved graph (`.graph` or `.g2o`) by PoseGraphSolver, with the options of section
 * [pose_graph].
 * \param output `.graph` or `.g2o`, by its extension; empty: nothing is written
 * \throws UserError for a bad file, a graph that cannot be solved, and an unknown extension. */
GraphFileReport optimiseGraphFile(const std::string& input,
                                  const std::string& output,
                                  const Config& config = {});

/** Result of optimising a saved factor graph. */
struct FactorGraphFileReport
{
  std::map<std::string, std::size_t> variables;  //!< number of variables of each kind
  std::map<std::string, std::size_t> factors;    //!< number of factors of each kind
  OptimisationResult result;
  std::vector<std::string> warnings;  //!< factors of the file that were left out
  double seconds = 0;                 //!< time of the optimisation, without reading and writing [s]
};

/** Optimises a saved factor graph, with the options of section [solver].
 * \param output file to write; empty: nothing is written \throws UserError for a bad file. */
FactorGraphFileReport optimiseFactorGraphFile(const std::string& input,
                                              const std::string& output,
                                              const Config& config = {});
}  // namespace dyslam
