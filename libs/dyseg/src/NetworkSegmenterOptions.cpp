// SPDX-License-Identifier: BSD-3-Clause
// Separate from the segmenter, so that its ini section is also known in builds without libtorch.
#include <dyslam/dyseg/NetworkSegmenter.h>

namespace dyslam
{
void NetworkSegmenterOptions::describe(OptionsVisitor& v)
{
  v.text("weights", weights,
         "weights of the network: a file, or the name of those shipped with DySLAM");
  v.integer("first_gap", first_gap, 1, 20, "age of the earlier scan that is compared [scans]");
  v.word("search", search, {"global", "prior", "auto"},
         "search range of the static motion: all motions, around the prior, or all until first_gap "
         "scans (auto)");
  v.real("threshold", threshold, 0.01, 0.99,
         "output of the network that is mapped to a moving probability of 0.5");
  v.integer("min_points", min_points, 0, 1000, "least number of points in a moving group");
  v.integer("iterations", iterations, 1, 12, "iterations of the flow update");
  v.integer("threads", threads, 0, 64, "threads of the network; 0: those of pipeline.threads");
  v.word("device", device, {"cpu", "cuda"},
         "device of the network; cuda needs a libtorch with CUDA");
  v.flag("encode_ahead", encode_ahead,
         "encode each scan while the one before is processed, deskewed by an older prediction");
}
}  // namespace dyslam
