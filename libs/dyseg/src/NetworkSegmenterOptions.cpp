// SPDX-License-Identifier: BSD-3-Clause
// Apart from the segmenter, so that its section is known in builds without libtorch too.
#include <dyslam/dyseg/NetworkSegmenter.h>

namespace dyslam
{
void NetworkSegmenterOptions::describe(OptionsVisitor& v)
{
  v.text("weights", weights, "file, or name of weights shipped with DySLAM");
  v.integer("first_gap", first_gap, 1, 20, "scans back to the one that is compared");
  v.integer("second_gap", second_gap, 0, 20,
            "scans back to a second one; none unless above first_gap");
  v.word("search", search, {"global", "prior", "auto"}, "search range of the static motion");
  v.word("combine", combine, {"mean", "max"}, "how the two probabilities are combined");
  v.real("threshold", threshold, 0.01, 0.99,
         "output of the network that is mapped to a probability of 0.5");
  v.integer("min_points", min_points, 0, 1000, "least points of a moving group");
  v.integer("iterations", iterations, 1, 12, "flow updates");
  v.integer("threads", threads, 1, 64, "of the network");
  v.word("device", device, {"cpu", "cuda"}, "of the network; cuda needs a libtorch with CUDA");
  v.flag("encode_ahead", encode_ahead,
         "encode the next scan beside this one, deskewed by an older prediction");
}
}  // namespace dyslam
