// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/graphslam/GraphSlamEngine.h>
#include <fcntl.h>
#include <unistd.h>

#include <cstdio>
#include <iostream>
#include <sstream>

namespace dyslam
{
struct ConsoleCutOff::State
{
  std::ostringstream nowhere;
  std::streambuf* cout = std::cout.rdbuf(nowhere.rdbuf());
  std::streambuf* cerr = std::cerr.rdbuf(nowhere.rdbuf());
  int keyboard = dup(STDIN_FILENO);  //!< copy of standard input; negative if that is closed
};

ConsoleCutOff::ConsoleCutOff() : state_(std::make_unique<State>())
{
  const int null = open("/dev/null", O_RDONLY | O_CLOEXEC);
  if (null > STDIN_FILENO)  // if standard input was closed, /dev/null took its number
  {
    dup2(null, STDIN_FILENO);
    close(null);
  }
}

ConsoleCutOff::~ConsoleCutOff()
{
  restore();
}

void ConsoleCutOff::restore()
{
  if (!state_)
  {
    return;
  }
  std::cout.rdbuf(state_->cout);
  std::cerr.rdbuf(state_->cerr);
  if (state_->keyboard >= 0)
  {
    dup2(state_->keyboard, STDIN_FILENO);
    close(state_->keyboard);
  }
  else
  {
    close(STDIN_FILENO);
  }
  std::clearerr(stdin);
  state_.reset();
}

GraphSlamEngine::GraphSlamEngine(const std::string& ini,
                                 const std::string& rawlog,
                                 NodeDecider& nodes,
                                 EdgeDecider& edges,
                                 GraphOptimizer& optimizer)
    : CGraphSlamEngine(ini, rawlog, "", nullptr, &nodes, &edges, &optimizer)
{
  restore();
  logging_enable_console_output = false;
  m_time_logger.setMinLoggingLevel(
      mrpt::system::LVL_ERROR);  // at other levels the destructor prints a table
}
}  // namespace dyslam
