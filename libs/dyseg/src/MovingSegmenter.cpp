// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/dyseg/MovingSegmenter.h>
#include <dyslam/dyseg/NetworkSegmenter.h>
#include <dyslam/dyseg/ResidualSegmenter.h>
#include <dyslam/dyseg/TemporalFilter.h>

namespace dyslam
{
void MovingSegmenterOptions::describe(OptionsVisitor& visitor)
{
  visitor.word("method", method, segmenterMethods(), "what finds the moving points");
  visitor.flag("filter", filter, "gather the answers of several scans where they lie; needs poses");
}

void NetworkSegmenterOptions::describe(OptionsVisitor& v)
{
  v.text("weights", weights, "file, or name of weights that come with DySLAM");
  v.integer("first_gap", first_gap, 1, 20, "scans back to the one compared with");
  v.integer("second_gap", second_gap, 0, 20,
            "scans back to a second one; not above first_gap: none");
  v.word("guess", guess, {"none", "prediction", "settled"}, "of the static motion");
  v.word("combine", combine, {"mean", "max"}, "of the two answers");
  v.real("threshold", threshold, 0.01, 0.99,
         "of the network's answer; becomes 0.5 of what is handed on");
  v.integer("min_points", min_points, 0, 1000, "of the smallest moving group");
  v.integer("iterations", iterations, 1, 12, "flow updates");
  v.integer("threads", threads, 1, 64, "of the network");
}

std::vector<std::string> segmenterMethods()
{
  return {"none", "residual", "network"};
}

namespace
{
std::unique_ptr<MovingSegmenter> makeNetworkSegmenter(
    [[maybe_unused]] const NetworkSegmenterOptions& options)
{
#ifdef DYSLAM_HAVE_TORCH
  return std::make_unique<NetworkSegmenter>(options);
#else
  throw UserError(
      "dyseg.method: network needs a build with libtorch; use residual or none, or install "
      "libtorch-dev and build again");
#endif
}
}  // namespace

std::unique_ptr<MovingSegmenter> makeSegmenter(ConfigLoader& config, ThreadPool& pool)
{
  const auto options = config.get<MovingSegmenterOptions>("dyseg");
  const auto residual = config.get<ResidualSegmenterOptions>("residual");
  const auto network = config.get<NetworkSegmenterOptions>("dyseg_network");
  const auto filter = config.get<TemporalFilterOptions>("dyseg_filter");
  std::unique_ptr<MovingSegmenter> segmenter;
  if (options.method == "residual")
  {
    segmenter = std::make_unique<ResidualSegmenter>(residual, pool);
  }
  if (options.method == "network")
  {
    segmenter = makeNetworkSegmenter(network);
  }
  if (segmenter && options.filter)
  {
    segmenter = std::make_unique<TemporalFilter>(filter, std::move(segmenter));
  }
  return segmenter;
}
}  // namespace dyslam
