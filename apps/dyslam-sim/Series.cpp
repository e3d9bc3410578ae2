// SPDX-License-Identifier: BSD-3-Clause
#include "Series.h"

#include <dyslam/base/Error.h>

#include <limits>
#include <string>

namespace dyslam::sim
{
std::vector<NamedRecording> seriesOf(const Arguments& a, const Recording& first)
{
  std::vector<NamedRecording> series;
  for (int i = 0; i < a.count; ++i)
  {
    NamedRecording one;
    one.recording = first;
    SimulatorOptions& o = one.recording.simulator;
    const bool same_world = o.traffic_seed >= 0;
    int& seed = same_world ? o.traffic_seed : o.seed;
    if (seed > std::numeric_limits<int>::max() - i)
    {
      throw UserError("--count: the seeds from " + std::to_string(seed) + " on end at " +
                      std::to_string(std::numeric_limits<int>::max()) +
                      "; choose a smaller one, or fewer recordings");
    }
    seed += i;
    one.name = a.world + "_" + toString(o.sensor) + "_" + std::to_string(o.seed) +
               (same_world ? "_" + std::to_string(o.traffic_seed) : "");
    one.recording.output = first.output + "/" + one.name + ".rawlog";
    series.push_back(one);
  }
  return series;
}
}  // namespace dyslam::sim
