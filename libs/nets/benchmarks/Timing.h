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
/** The .bin files of a folder, sorted by name. Exits with a message if there are fewer than
 * `needed`. */
inline std::vector<std::string> scanFiles(const std::string& folder, std::size_t needed)
{
  std::vector<std::string> files;
  try
  {
    files = dyslam::listBinFiles(folder);
  }
  catch (const dyslam::UserError& error)
  {
    std::fprintf(stderr, "%s\n", error.what());
    std::exit(1);
  }
  if (files.size() < needed)
  {
    std::fprintf(stderr, "%s: holds %zu scans (*.bin), %zu are needed; name another folder\n",
                 folder.c_str(), files.size(), needed);
    std::exit(1);
  }
  return files;
}

/** Parses a number of threads. Exits with a message if it is invalid. */
inline int threadsOf(const char* word)
{
  const int threads = std::atoi(word);
  if (threads < 1)
  {
    std::fprintf(stderr, "%s: not a number of threads; give 1 or more\n", word);
    std::exit(1);
  }
  return threads;
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
