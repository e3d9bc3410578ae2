// SPDX-License-Identifier: BSD-3-Clause
// Run times of the parts of DySeg on scans of a folder: dyseg_benchmark FOLDER [threads] [MODEL]
#include <dyslam/base/Heap.h>
#include <dyslam/nets/BevScan.h>
#include <dyslam/nets/DysegModel.h>

#include <cstdlib>

#include "Timing.h"

int main(int argc, char** argv)
{
  dyslam::tuneHeap();
  if (argc < 2)
  {
    std::puts("dyseg_benchmark FOLDER_OF_BIN_FILES [threads] [MODEL]");
    return 1;
  }
  using namespace dyslam;
  const auto files = timing::scanFiles(argv[1], 11);
  const int threads = argc > 2 ? timing::threadsOf(argv[2]) : 1;
  const DysegModel model = argc > 3 ? DysegModel(argv[3], threads)
                                    : DysegModel(DysegNetworkOptions{}, BevOptions{}, 1, threads);
  const auto points = dyslam::readBin(files.at(10)).points;
  const auto current = model.encode(points);
  const auto past = model.encode(dyslam::readBin(files.at(9)).points);

  constexpr int runs = 15;
  timing::report("grid", runs, [&] { (void)makeBevScan(points, model.grid()); });
  timing::report("encode", runs, [&] { (void)model.encode(points); });
  RigidFlowFit motion;
  timing::report("match", runs, [&] { motion = model.match(*current, *past); });
  const PlanarPrior guess{motion.motion};
  timing::report("match past", runs, [&] { (void)model.match(*current, *past, &guess); });
  timing::report("segment", runs, [&] { (void)model.segment(*current, *past, motion); });
  return 0;
}
