// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Registry.h>
#include <dyslam/base/RuntimeModule.h>
#include <dyslam/dyseg/MovingSegmenter.h>
#include <dyslam/dyseg/NetworkSegmenter.h>
#include <dyslam/dyseg/ResidualSegmenter.h>

#include <algorithm>

namespace dyslam
{
namespace
{
using Segmenter = std::unique_ptr<MovingSegmenter>;
using Factory = Registry<MovingSegmenter>::Factory;

Factory residual(const ResidualSegmenterOptions& options)
{
  return [=](ThreadPool& pool) -> Segmenter
  { return std::make_unique<ResidualSegmenter>(options, pool); };
}

Factory network(const NetworkSegmenterOptions& given)
{
  return [=](ThreadPool& pool) -> Segmenter
  {
    NetworkSegmenterOptions options = given;
    options.threads = given.threads > 0 ? given.threads : pool.size();
    auto* make = runtimeModuleFunction<MakeNetworkSegmenter>(
        "networks", "dyslam_make_network_segmenter", "dyseg.method: network");
    return Segmenter(make(options));
  };
}

/** One row per segmenter. */
Registry<MovingSegmenter> segmenters()
{
  return Registry<MovingSegmenter>({
      {"none",
       [](ConfigLoader&) -> Factory { return [](ThreadPool&) -> Segmenter { return nullptr; }; }},
      {"residual",
       [](ConfigLoader& c) { return residual(c.get<ResidualSegmenterOptions>("residual")); }},
      {"network",
       [](ConfigLoader& c) { return network(c.get<NetworkSegmenterOptions>("dyseg_network")); },
       /*needs_networks=*/true},
  });
}
}  // namespace

void MovingSegmenterOptions::describe(OptionsVisitor& visitor)
{
  visitor.word("method", method, segmenterMethods(), "segmentation method for moving points");
  visitor.text(
      "labels", labels,
      "folder of an earlier run of the recording with --labels, or of another program's .label "
      "files: segmentation and odometry do without the points labelled moving");
  visitor.real("moving_threshold", moving_threshold, 0, 1,
               "moving probability above which the segmenter classifies a point as moving");
}

std::vector<std::string> segmenterMethods()
{
  return segmenters().names();
}

bool segmenterNeedsNetworks(const std::string& method)
{
  return segmenters().needsNetworks(method);
}

std::unique_ptr<MovingSegmenter> makeSegmenter(const std::string& method,
                                               ConfigLoader& config,
                                               ThreadPool& pool)
{
  return segmenters().make(method, "dyseg.method", config, pool);
}
}  // namespace dyslam
