// SPDX-License-Identifier: BSD-3-Clause
#include "ScanLabels.h"

#include <cstdio>

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

/** Labels have 16 bits for the instance, of which 0 is none: numbers repeat in long recordings. */
std::uint16_t instanceOfTrack(int id)
{
  return static_cast<std::uint16_t>(1 + id % 65535);
}
}  // namespace

std::vector<Label> scanLabels(const Frame& frame)
{
  std::vector<Label> labels(frame.scan.size(), 0);
  for (std::size_t i = 0; i < frame.cloud.size(); ++i)
  {
    labels[frame.cloud.source[i]] = frame.isMoving(i) ? label_moving : label_static;
  }
  for (const auto& object : frame.objects)
  {
    if (object.detection < 0 || !object.reported)
    {
      continue;
    }
    const Label label = makeLabel(movingLabel(object.object_class), instanceOfTrack(object.id));
    for (const auto i : frame.detections[static_cast<std::size_t>(object.detection)].points)
    {
      labels[frame.cloud.source[i]] = frame.isMoving(i) ? label : labels[frame.cloud.source[i]];
    }
  }
  labelNearReturns(frame, labels);
  return labels;
}

std::string numberedPath(const std::string& folder,
                         const Frame& frame,
                         const std::string& extension)
{
  char number[32];
  std::snprintf(number, sizeof number, "/%06zu", frame.index);
  return folder + number + extension;
}
}  // namespace dyslam
