// SPDX-License-Identifier: BSD-3-Clause
// Times the parts of DyLO on scans of a folder: dylo_benchmark FOLDER [threads] [MODEL]
#include <dyslam/nets/DyloModel.h>
#include <torch/csrc/autograd/profiler.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>

namespace
{
std::vector<Eigen::Vector3f> readBin(const std::string& path)
{
  std::ifstream file(path, std::ios::binary);
  const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
  std::vector<Eigen::Vector3f> points(bytes.size() / 16);
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    std::copy_n(bytes.data() + 16 * i, 12, reinterpret_cast<char*>(points[i].data()));
  }
  return points;
}

void report(const char* name, int runs, const std::function<void()>& body)
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
}  // namespace

int main(int argc, char** argv)
{
  if (argc < 2)
  {
    std::puts("dylo_benchmark FOLDER [threads] [MODEL]");
    return 1;
  }
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(argv[1]))
  {
    if (entry.path().extension() == ".bin")
    {
      files.push_back(entry.path().string());
    }
  }
  std::sort(files.begin(), files.end());
  torch::set_num_threads(argc > 2 ? std::atoi(argv[2]) : 1);
  torch::manual_seed(1);
  using namespace dyslam;
  DyloNetwork network = argc > 3 ? loadDylo(argv[3]) : DyloNetwork(DyloNetworkOptions{});
  const torch::NoGradGuard no_grad;
  const auto points1 = readBin(files.at(1));
  const auto points2 = readBin(files.at(0));
  PreparedScan prepared = prepareScan(points1);
  ScanTensors tensors = toTensors(prepared);
  const EncodedScan scan2 = network->encode(toTensors(prepareScan(points2)));
  EncodedScan scan1 = network->encode(tensors);
  const PoseTensors start = PoseTensors::identity(torch::kFloat);
  constexpr int runs = 25;
  report("prepare", runs, [&] { prepared = prepareScan(points1); });
  report("to tensors", runs, [&] { tensors = toTensors(prepared); });
  report("encode", runs, [&] { scan1 = network->encode(tensors); });
  report("match", runs, [&] { (void)network->forward(scan1, scan2, start); });
  report("all", runs,
         [&] {
           (void)network->forward(network->encode(toTensors(prepareScan(points1))), scan2, start);
         });
  if (std::getenv("DYLO_TRACE") != nullptr)
  {
    const torch::autograd::profiler::RecordProfile trace(std::getenv("DYLO_TRACE"));
    for (int i = 0; i < 5; ++i)
    {
      (void)network->forward(network->encode(tensors), scan2, start);
    }
  }
  return 0;
}
