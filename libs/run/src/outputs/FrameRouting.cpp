// SPDX-License-Identifier: BSD-3-Clause
#include "FrameRouting.h"

#include <algorithm>

namespace dyslam
{
namespace
{
/** Parts of a final frame for an output that gets final frames. */
FrameParts partsFor(WantedFrames wanted)
{
  switch (wanted)
  {
    case WantedFrames::causal:
      break;
    case WantedFrames::final_objects:
      return FrameParts::points;
    case WantedFrames::final_points:
      return FrameParts::intensity;
    case WantedFrames::final_scans:
      return FrameParts::all;
  }
  return FrameParts::none;
}

WantedFrames leastForFinal(const std::vector<WantedFrames>& wanted, FrameKind objects)
{
  if (objects == FrameKind::final)
  {
    return WantedFrames::final_objects;
  }
  const bool are_scans_held =
      std::find(wanted.begin(), wanted.end(), WantedFrames::final_scans) != wanted.end();
  return are_scans_held ? WantedFrames::final_points : WantedFrames::final_scans;
}
}  // namespace

FrameRouting::FrameRouting(const std::vector<WantedFrames>& wanted, FrameKind objects)
    : least_for_final_(leastForFinal(wanted, objects))
{
  for (const WantedFrames of_output : wanted)
  {
    if (kindFor(of_output) == FrameKind::final)
    {
      final_parts_ = std::max(final_parts_, partsFor(of_output));
    }
  }
}

FrameKind FrameRouting::kindFor(WantedFrames wanted) const
{
  return wanted >= least_for_final_ ? FrameKind::final : FrameKind::causal;
}
}  // namespace dyslam
