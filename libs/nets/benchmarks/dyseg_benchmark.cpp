// SPDX-License-Identifier: BSD-3-Clause
// Run times of the parts of DySeg on scans of a folder: dyseg_benchmark FOLDER [threads] [MODEL]
#include <dyslam/base/Heap.h>
#include <dyslam/nets/BevScan.h>
#include <dyslam/nets/DysegModel.h>

#include "Timing.h"

namespace
{
using namespace dyslam;

void timeParts(const timing::Arguments& a)
{
  const auto files = timing::scanFiles(a.folder, 11);
  const DysegModel model = a.model.empty()
                               ? DysegModel(DysegNetworkOptions{}, BevOptions{}, 1, a.threads)
                               : DysegModel(a.model, a.threads);
  const auto points = readBin(files.at(10)).points;
  const auto current = model.encode(points);
  const auto past = model.encode(readBin(files.at(9)).points);

  constexpr int runs = 15;
  timing::report("grid", runs, [&] { (void)makeBevScan(points, model.grid()); });
  timing::report("encode", runs, [&] { (void)model.encode(points); });
  RigidFlowFit motion;
  timing::report("match", runs, [&] { motion = model.match(*current, *past); });
  const PlanarPrior guess{motion.motion};
  timing::report("match past", runs, [&] { (void)model.match(*current, *past, &guess); });
  timing::report("segment", runs, [&] { (void)model.segment(*current, *past, motion); });
}
}  // namespace

int main(int argc, char** argv)
{
  tuneHeap();
  return timing::run(argc, argv, timeParts);
}
