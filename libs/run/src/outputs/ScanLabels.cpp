// SPDX-License-Identifier: BSD-3-Clause
#include "ScanLabels.h"

#include "NearReturns.h"

namespace dyslam
{
namespace
{
/** SemanticKITTI's moving class of an object. */
std::uint16_t movingLabel(ObjectClass object_class)
{
  switch (object_class)
  {
    case ObjectClass::car:
    case ObjectClass::van:
      return 252;
    case ObjectClass::cyclist:
      return 253;
    case ObjectClass::pedestrian:
      return 254;
    case ObjectClass::motorcyclist:
      return 255;
    case ObjectClass::bus:
      return 257;
    case ObjectClass::truck:
      return 258;
    case ObjectClass::unknown:
      break;
  }
  return semanticOf(label_moving);
}
}  // namespace

std::uint16_t instanceOfTrack(int id)
{
  // 16 bits, where 0 is no object: numbers repeat in long recordings.
  return static_cast<std::uint16_t>(1 + id % 65535);
}

Label labelOf(const TrackedObject& object)
{
  return makeLabel(movingLabel(object.object_class), instanceOfTrack(object.id));
}

std::vector<std::uint32_t> sourcesOf(const Frame& frame, const TrackedObject& object)
{
  std::vector<std::uint32_t> sources;
  for (const std::uint32_t i : frame.pointsOf(object))
  {
    sources.push_back(frame.cloud.source[i]);
  }
  return sources;
}

std::vector<Label> scanLabels(const Frame& frame)
{
  std::vector<Label> labels(frame.scan.size(), 0);
  for (std::size_t i = 0; i < frame.cloud.size(); ++i)
  {
    labels[frame.cloud.source[i]] = frame.isMoving(i) ? label_moving : label_static;
  }
  for (const auto& object : frame.objects)
  {
    if (!object.reported)
    {
      continue;
    }
    const Label label = labelOf(object);
    for (const std::uint32_t i : sourcesOf(frame, object))
    {
      labels[i] = isMovingLabel(labels[i]) ? label : labels[i];
    }
  }
  labelNearReturns(frame, labels);
  return labels;
}
}  // namespace dyslam
