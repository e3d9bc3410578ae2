// SPDX-License-Identifier: BSD-3-Clause
// Simulated scans per second with ground truth, without writing files.
//   sim_speed [threads=2] [scans=50] [repetitions=5]
// Prints the best repetition per world by wall time and by CPU time; on a busy machine
// only the CPU time is meaningful.
#include <dyslam/sim/Simulator.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>

int main(int argc, char** argv)
{
  using dyslam::sim::WorldKind;
  const int threads = argc > 1 ? std::atoi(argv[1]) : 2;
  const int scans = argc > 2 ? std::max(1, std::atoi(argv[2])) : 50;
  const int repetitions = argc > 3 ? std::max(1, std::atoi(argv[3])) : 5;
  std::printf("%d threads, %d scans of an HDL-64E (64 x 2083), best of %d\n", threads, scans,
              repetitions);
  for (const auto world : {WorldKind::urban, WorldKind::highway, WorldKind::campus})
  {
    dyslam::sim::SimulatorOptions options;
    options.world = world;
    options.traffic = 0.5;
    const auto made = dyslam::sim::makeWorld(options);
    double wall = 1e9, cpu = 1e9;
    std::size_t points = 0;
    for (int r = 0; r < repetitions; ++r)
    {
      dyslam::sim::Simulator simulator(made, options, threads);
      points = 0;
      const auto start = std::chrono::steady_clock::now();
      const std::clock_t cpu_start = std::clock();
      for (int i = 0; i < scans; ++i)
      {
        points += simulator.next().scan.size();
      }
      const double seconds =
          std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      wall = std::min(wall, seconds / scans);
      cpu = std::min(cpu, static_cast<double>(std::clock() - cpu_start) / CLOCKS_PER_SEC / scans);
    }
    std::printf("%-8s %7zu points a scan  %6.1f scans/s  %6.1f ms of processor time a scan\n",
                toString(world).c_str(), points / static_cast<std::size_t>(scans), 1 / wall,
                1000 * cpu);
  }
  return 0;
}
