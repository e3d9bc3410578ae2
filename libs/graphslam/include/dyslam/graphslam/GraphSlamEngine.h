// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/graphslam/GraphSlamPlugins.h>
#include <mrpt/graphslam/CGraphSlamEngine.h>

#include <memory>
#include <string>

namespace dyslam
{
/** Disconnects console and keyboard from construction until restore(): output to std::cout and
 * std::cerr is discarded, standard input is at its end. It affects the whole process: not
 * thread-safe. */
class ConsoleCutOff
{
 public:
  ConsoleCutOff();
  ~ConsoleCutOff();
  ConsoleCutOff(const ConsoleCutOff&) = delete;
  ConsoleCutOff& operator=(const ConsoleCutOff&) = delete;

  void restore();

 private:
  struct State;
  std::unique_ptr<State> state_;  //!< null once restored
};

/** mrpt::graphslam::CGraphSlamEngine of 3D poses without window, console output and prompt; its
 * messages are in its report.
 *
 * MRPT 2.5.8 looks for CPose3DPDFGaussianInf without its namespace in the list of classes that it
 * has been tested with. So its constructor prints a warning and waits for a key, whatever its
 * verbosity; here it finds neither console nor keyboard.
 */
class GraphSlamEngine : private ConsoleCutOff,
                        public mrpt::graphslam::CGraphSlamEngine<GraphSlamContext::Graph>
{
 public:
  /** \param ini file with the engine's own settings, such as [GeneralConfiguration]
   * class_verbosity; must exist \param rawlog name of the recording, for the engine's reports. The
   * plug-ins outlive the engine. */
  GraphSlamEngine(const std::string& ini,
                  const std::string& rawlog,
                  NodeDecider& nodes,
                  EdgeDecider& edges,
                  GraphOptimizer& optimizer);
};
}  // namespace dyslam
