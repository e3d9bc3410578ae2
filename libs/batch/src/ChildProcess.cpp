// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/batch/ChildProcess.h>
#include <dyslam/batch/ControlGroup.h>
#include <fcntl.h>
#include <sched.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>
#include <sstream>
#include <thread>

namespace dyslam::batch
{
namespace
{
constexpr int not_started = 127;

/** Ends the child, which could not become the program, and writes the error number to the pipe. */
[[noreturn]] void reportAndEnd(int pipe)
{
  const int error = errno;
  [[maybe_unused]] const auto written = ::write(pipe, &error, sizeof error);
  ::_exit(not_started);
}

/** The child after fork(), where only async-signal-safe calls are allowed.
 * \param failure pipe for the number of an error */
[[noreturn]] void become(
    char* const* arguments, const char* log, const cpu_set_t* cores, pid_t parent, int failure)
{
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent)
  {
    ::_exit(not_started);
  }
  ::setpgid(0, 0);  // Ctrl-C reaches only the parent, which then ends this process
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE})
  {
    ::signal(signal, SIG_DFL);
  }
  const int out = ::open(log, O_WRONLY | O_CREAT | O_APPEND, 0666);
  const int in = ::open("/dev/null", O_RDONLY);
  if (out < 0 || in < 0 || ::dup2(in, 0) < 0 || ::dup2(out, 1) < 0 || ::dup2(out, 2) < 0)
  {
    reportAndEnd(failure);
  }
  if (CPU_COUNT(cores) > 0)
  {
    ::sched_setaffinity(0, sizeof *cores, cores);
  }
  ::execv(arguments[0], arguments);
  reportAndEnd(failure);
}

/** A pipe in which a child writes why it could not become the program; closed by exec(). */
class FailurePipe
{
 public:
  /** \throws UserError. */
  explicit FailurePipe(const std::string& program)
  {
    if (::pipe2(ends_, O_CLOEXEC | O_NONBLOCK) != 0)
    {
      throw UserError(program + ": cannot be started: " + std::strerror(errno));
    }
  }
  ~FailurePipe()
  {
    ::close(ends_[0]);
    ::close(ends_[1]);
  }
  FailurePipe(const FailurePipe&) = delete;
  FailurePipe& operator=(const FailurePipe&) = delete;

  [[nodiscard]] int writeEnd() const { return ends_[1]; }
  /** The error number that the child wrote; 0 if it became the program. */
  [[nodiscard]] int error() const
  {
    int number = 0;
    return ::read(ends_[0], &number, sizeof number) == sizeof number ? number : 0;
  }

 private:
  int ends_[2] = {-1, -1};
};
}  // namespace

ChildOutcome runChild(const ChildCommand& command, const std::function<bool()>& stop)
{
  if (command.words.empty() || ::access(command.words[0].c_str(), X_OK) != 0)
  {
    throw UserError((command.words.empty() ? "" : command.words[0]) +
                    ": is no program that can be run");
  }
  std::vector<char*> arguments;
  for (const std::string& word : command.words)
  {
    arguments.push_back(const_cast<char*>(word.c_str()));
  }
  arguments.push_back(nullptr);
  cpu_set_t cores;
  CPU_ZERO(&cores);
  for (const int core : command.cores)
  {
    CPU_SET(static_cast<std::size_t>(core), &cores);
  }
  const auto start = std::chrono::steady_clock::now();
  const FailurePipe failure(command.words[0]);
  const pid_t parent = ::getpid();
  const pid_t child = ::fork();
  if (child < 0)
  {
    throw UserError(command.words[0] + ": cannot be started: " + std::strerror(errno));
  }
  if (child == 0)
  {
    become(arguments.data(), command.log.c_str(), &cores, parent, failure.writeEnd());
  }
  int status = 0;
  struct rusage usage = {};
  pid_t ended = 0;
  while ((ended = ::wait4(child, &status, WNOHANG, &usage)) == 0)
  {
    if (stop && stop())
    {
      ::kill(-child, SIGKILL);  // the child and the processes that it has started
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  if (ended < 0)  // where SIGCHLD is ignored, the exit status is lost
  {
    throw UserError(command.words[0] + ": cannot wait for it: " + std::strerror(errno));
  }
  if (const int error = failure.error(); error != 0)
  {
    throw UserError(command.words[0] + ": cannot be run: " + std::strerror(error));
  }
  ChildOutcome outcome;
  outcome.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  outcome.signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  outcome.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  outcome.peak_memory = static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
  return outcome;
}

std::vector<int> usableCores()
{
  cpu_set_t set;
  CPU_ZERO(&set);
  if (::sched_getaffinity(0, sizeof set, &set) != 0)
  {
    return {};
  }
  std::vector<int> cores;
  for (int core = 0; core < CPU_SETSIZE; ++core)
  {
    if (CPU_ISSET(static_cast<std::size_t>(core), &set))
    {
      cores.push_back(core);
    }
  }
  return cores;
}

std::uint64_t availableMemory()
{
  std::uint64_t available = 0;
  std::ifstream info("/proc/meminfo");
  for (std::string line; std::getline(info, line);)
  {
    if (line.rfind("MemAvailable:", 0) == 0)
    {
      std::istringstream(line.substr(13)) >> available;
    }
  }
  available *= 1024;
  const auto left = memoryLeftByGroups("/");
  return left ? std::min(available, *left) : available;
}
}  // namespace dyslam::batch
