// SPDX-License-Identifier: BSD-3-Clause
// Makes a long recording by repeating a part of a short one with continuing time stamps, for
// measurements of memory and speed.
#include <dyslam/io/RawlogSource.h>
#include <dyslam/io/RawlogWriter.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

namespace
{
using namespace dyslam;

struct Arguments
{
  std::string input, output;
  std::size_t first = 0, count = 0, scans = 0;
  bool onward = false;
};

std::vector<Frame> readPart(const Arguments& a)
{
  RawlogSourceOptions options;
  options.skip_first_n = static_cast<int>(a.first);
  options.only_first_n = static_cast<int>(a.count);
  RawlogSource source(a.input, options);
  std::vector<Frame> frames;
  while (frames.size() < a.count)
  {
    auto frame = source.next();
    if (!frame)
    {
      break;
    }
    frames.push_back(std::move(*frame));
  }
  return frames;
}

void writeRepeated(const Arguments& a, std::vector<Frame> part)
{
  const auto n = static_cast<double>(part.size());
  const double duration = (part.back().scan.stamp - part.front().scan.stamp) * n / (n - 1);
  const auto truth = [&](std::size_t i) { return part[i].T_world_vehicle_truth; };
  const bool has_truth = truth(0) && truth(1) && truth(part.size() - 1);
  Pose T_part = Pose::Identity();
  if (a.onward && has_truth)
  {
    const Pose step = truth(0)->inverse() * *truth(1);
    T_part = *truth(part.size() - 1) * step * truth(0)->inverse();
  }
  RawlogWriter writer(a.output);
  Pose T_world = Pose::Identity();
  for (std::size_t k = 0; k < a.scans; ++k)
  {
    const std::size_t i = k % part.size();
    T_world = k > 0 && i == 0 ? T_world * T_part : T_world;
    Scan scan = part[i].scan;
    scan.stamp += duration * static_cast<double>(k / part.size());
    std::optional<Pose> pose;
    if (truth(i))
    {
      pose = T_world * *truth(i);
    }
    writer.write(scan, pose);
  }
  writer.close();
}
}  // namespace

int main(int argc, char** argv)
{
  Arguments a;
  CLI::App app("Repeats a part of a recording");
  app.add_option("-i,--input", a.input, "rawlog")->required();
  app.add_option("-o,--output", a.output, "rawlog to write")->required();
  app.add_option("--first", a.first, "scan where the part begins");
  app.add_option("--count", a.count, "scans of the part")->required();
  app.add_option("--scans", a.scans, "scans to write")->required();
  app.add_flag("--onward", a.onward, "the true path goes on from its end, not from its start");
  CLI11_PARSE(app, argc, argv);
  try
  {
    std::vector<Frame> part = readPart(a);
    if (part.size() < 2)
    {
      throw std::runtime_error("the part has fewer than two scans");
    }
    writeRepeated(a, std::move(part));
  }
  catch (const std::exception& error)
  {
    std::fprintf(stderr, "repeat_recording: %s\n", error.what());
    return 1;
  }
  return 0;
}
