// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Error.h>
#include <dyslam/formats/ScanFiles.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

/** Common parts of the networks' benchmarks. */
namespace timing
{
/** The .bin files of a folder, sorted by name. \throws UserError if there are fewer than `needed`.
 */
inline std::vector<std::string> scanFiles(const std::string& folder, std::size_t needed)
{
  std::vector<std::string> files = dyslam::listBinFiles(folder);
  if (files.size() < needed)
  {
    throw dyslam::UserError(folder + ": holds " + std::to_string(files.size()) +
                            " scans (*.bin), " + std::to_string(needed) +
                            " are needed; name another folder");
  }
  return files;
}

struct Arguments
{
  std::string folder;  //!< folder of .bin files
  int threads = 1;
  std::string model;  //!< file of weights; empty: random ones
};

/** Main function of a benchmark: `body` with the arguments FOLDER [threads] [MODEL].
 * \return exit code; 1 after an error that the user can fix, which is printed */
inline int run(int argc, char** argv, const std::function<void(const Arguments&)>& body)
{
  if (argc < 2)
  {
    std::fprintf(stderr, "%s FOLDER_OF_BIN_FILES [threads] [MODEL]\n", argv[0]);
    return 1;
  }
  try
  {
    Arguments arguments;
    arguments.folder = argv[1];
    arguments.threads = argc > 2 ? std::atoi(argv[2]) : 1;
    arguments.model = argc > 3 ? argv[3] : "";
    if (arguments.threads < 1)
    {
      throw dyslam::UserError(std::string(argv[2]) + ": not a number of threads; give 1 or more");
    }
    body(arguments);
    return 0;
  }
  catch (const dyslam::UserError& error)
  {
    std::fprintf(stderr, "%s: %s\n", argv[0], error.what());
    return 1;
  }
}

/** Prints the median and minimum wall time of `runs` calls. */
inline void report(const char* name, int runs, const std::function<void()>& body)
{
  std::vector<double> times;
  for (int i = 0; i < runs; ++i)
  {
    const auto begin = std::chrono::steady_clock::now();
    body();
    times.push_back(
        1e3 * std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  }
  std::sort(times.begin(), times.end());
  std::printf("%-12s median %7.2f ms  min %7.2f ms\n", name, times[times.size() / 2], times[0]);
}
}  // namespace timing
