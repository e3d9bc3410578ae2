// SPDX-License-Identifier: BSD-3-Clause
// Run times of the parts of DyLO on scans of a folder: dylo_benchmark FOLDER [threads] [MODEL]
#include <dyslam/base/Heap.h>
#include <dyslam/nets/DyloFile.h>

#include "Timing.h"

namespace
{
using namespace dyslam;

void timeParts(const timing::Arguments& a)
{
  const auto files = timing::scanFiles(a.folder, 2);
  torch::set_num_threads(a.threads);
  torch::manual_seed(1);
  DyloNetwork network = a.model.empty() ? DyloNetwork(DyloNetworkOptions{}) : loadDylo(a.model);
  const torch::NoGradGuard no_grad;
  const auto points1 = readBin(files.at(1)).points;
  const auto points2 = readBin(files.at(0)).points;
  PreparedScan prepared = prepareScan(points1);
  ScanTensors tensors = toTensors(prepared);
  const EncodedScan scan2 = network->encode(toTensors(prepareScan(points2)));
  EncodedScan scan1 = network->encode(tensors);
  const PoseTensors start = PoseTensors::identity(torch::kFloat);

  constexpr int runs = 25;
  timing::report("prepare", runs, [&] { prepared = prepareScan(points1); });
  timing::report("to tensors", runs, [&] { tensors = toTensors(prepared); });
  timing::report("encode", runs, [&] { scan1 = network->encode(tensors); });
  timing::report("match", runs, [&] { (void)network->forward(scan1, scan2, start); });
  timing::report(
      "all", runs,
      [&]
      { (void)network->forward(network->encode(toTensors(prepareScan(points1))), scan2, start); });
}
}  // namespace

int main(int argc, char** argv)
{
  tuneHeap();
  return timing::run(argc, argv, timeParts);
}
