// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/StateArchive.h>
#include <dyslam/mapping/HindsightLabels.h>

#include <optional>
#include <utility>

#include "MovingPointClassifier.h"
#include "ScanWindow.h"

namespace dyslam
{
void HindsightOptions::describe(OptionsVisitor& v)
{
  v.flag("hindsight", hindsight, "label moving points from earlier and later scans");
  v.integer("window", window, 1, 1000,
            "number of scans used before, and after, the scan that is labelled");
  v.integer("history", history, 0, 100000,
            "number of scans before the window of which every eighth is used");
  v.real("voxel_size", voxel_size, 0.01, 10, "side of the voxels that accumulate evidence [m]");
  v.real("segment_gap", segment_gap, 0.01, 10,
         "side of the cells that are clustered to segments [m]");
  v.real("margin", margin, 0.01, 10,
         "least distance that a ray ends behind a voxel to observe it as free [m]");
  v.real("moving_threshold", moving_threshold, 0, 1,
         "moving probability above which a point is moving in labels, map and replay");
  v.real("ground_clearance", ground_clearance, 0, 10,
         "height above ground up to which returns are ground [m]");
}

struct HindsightLabels::Impl
{
  Impl(const HindsightOptions& options, int threads)
      : window(options.window, options.history), classifier(options, threads)
  {
  }

  void decideNext(const Use& use);

  ScanWindow window;
  MovingPointClassifier classifier;
};

/** Decides the current scan of the window and outputs its frame, if that was kept. */
void HindsightLabels::Impl::decideNext(const Use& use)
{
  std::optional<Frame> frame = window.takeFrame();
  if (frame)
  {
    classifier.label(*frame, window);
    for (TrackedObject& object : frame->objects)
    {
      object.reported = object.reported || window.isEverReported(object.id);
    }
  }
  window.advance();
  if (frame)
  {
    use(std::move(*frame));
  }
}

HindsightLabels::HindsightLabels(const HindsightOptions& options, int threads)
{
  validate(options, "labels");
  impl_ = std::make_unique<Impl>(options, threads);
}
HindsightLabels::~HindsightLabels() = default;

void HindsightLabels::add(const Frame& frame, FrameParts kept, const Use& use)
{
  impl_->window.add(frame, kept);
  if (impl_->window.isComplete())
  {
    impl_->decideNext(use);
  }
}

void HindsightLabels::finish(const Use& use)
{
  while (impl_->window.hasCurrent())
  {
    impl_->decideNext(use);
  }
}

void HindsightLabels::exchangeState(StateArchive& archive)
{
  archive(impl_->window, impl_->classifier);
}
}  // namespace dyslam
