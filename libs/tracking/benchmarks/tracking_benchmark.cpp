// SPDX-License-Identifier: BSD-3-Clause
/** Run times of association and tracking on one thread; minimum of several runs. */
#include <dyslam/base/Assignment.h>
#include <dyslam/tracking/AdaptivePredictor.h>
#include <dyslam/tracking/Tracker.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <random>
#include <vector>

using namespace dyslam;

namespace
{
/** Minimum run time of `runs` calls [ms]. */
template <typename Work>
double minMs(int runs, Work&& work)
{
  std::vector<double> times;
  for (int run = 0; run < runs; ++run)
  {
    const auto start = std::chrono::steady_clock::now();
    work();
    times.push_back(
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
            .count());
  }
  return *std::min_element(times.begin(), times.end());
}

void timeAssignment(const char* name, const CostMatrix& cost)
{
  std::printf("%-28s shortest paths %7.2f ms, greedy %7.2f ms\n", name,
              minMs(7, [&] { (void)assignShortestPaths(cost); }),
              minMs(7, [&] { (void)assignGreedy(cost); }));
}

void timeTracker()
{
  std::mt19937 generator(2);
  std::normal_distribution<double> noise(0, 0.08);
  double worst = 0;
  Tracker tracker;
  constexpr int scans = 60;
  const double sum = minMs(
      1,
      [&]
      {
        for (int scan = 0; scan < scans; ++scan)
        {
          std::vector<Detection> detections(200);
          for (int i = 0; i < 200; ++i)
          {
            Detection& d = detections[static_cast<std::size_t>(i)];
            d.box.centre = {9.0 * (i / 10) - 90 + 0.1 * scan * (5 + i % 10) + noise(generator),
                            3.5 * (i % 10) + noise(generator), 0};
            d.box.size = {4.2, 1.8, 1.5};
            d.object_class = ObjectClass::car;
          }
          worst = std::max(
              worst,
              minMs(1, [&] { (void)tracker.update(0.1 * scan, detections, Pose::Identity()); }));
        }
      });
  std::printf("%-28s %.2f ms per scan, worst %.2f ms\n", "tracker, 200 objects", sum / scans,
              worst);
}
}  // namespace

int main()
{
  std::mt19937 generator(1);
  std::uniform_real_distribution<double> unit(0, 1);
  std::uniform_int_distribution<int> few(0, 4);
  CostMatrix cost(1000, 1000);
  std::generate(cost.data(), cost.data() + cost.size(), [&] { return unit(generator); });
  timeAssignment("1000 x 1000, real costs", cost);
  std::generate(cost.data(), cost.data() + cost.size(), [&] { return few(generator); });
  timeAssignment("1000 x 1000, five values", cost);
  std::generate(cost.data(), cost.data() + cost.size(),
                [&]
                {
                  const double c = unit(generator);
                  return c < 0.02 ? c : std::numeric_limits<double>::infinity();
                });
  timeAssignment("1000 x 1000, 98 % gated", cost);

  AdaptivePredictor predictor;
  int observation = 0;
  const double ms =
      minMs(5,
            [&]
            {
              for (int i = 0; i < 1000; ++i, ++observation)
              {
                predictor.add({0.1 * observation, {unit(generator) + observation, 0}});
                (void)predictor.predict(0.1 * observation + 0.1);
              }
            });
  std::printf("%-28s %.1f us per observation\n", "adaptive predictor", ms);
  timeTracker();
  return 0;
}
