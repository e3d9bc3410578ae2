// SPDX-License-Identifier: BSD-3-Clause
#include "TrackLines.h"

#include <algorithm>
#include <string>

#include "PoseChecks.h"

namespace dyslam
{
int frameFrom(const TextFile& file)
{
  constexpr int last = 10000000;
  const int frame = file.integer(0);
  if (frame > last)
  {
    file.fail("the frame is above 10000000; frames are the numbers of the scans, from 0");
  }
  return frame;
}

LabelledBox readTrackLine(const TextFile& file, const char* box_columns)
{
  const bool has_score = file.fields().size() == 18;
  if (!has_score)
  {
    const std::string columns = "frame id type truncated occluded alpha left top right bottom " +
                                std::string(box_columns) + ", with or without score";
    file.requireFields(17, columns.c_str());
  }
  LabelledBox box;
  box.frame = frameFrom(file);
  box.type = std::string(file.fields()[2]);
  box.object_class = objectClassFromString(box.type);
  box.truncated = file.integerPart(3);
  box.occluded = file.integerPart(4);
  box.image_box = {file.number(6), file.number(7), file.number(8), file.number(9)};
  box.score = has_score ? file.number(17) : 1;
  return box;
}

CameraBox cameraBoxFrom(const TextFile& file, std::size_t first)
{
  CameraBox box;
  box.height = file.number(first);
  box.width = file.number(first + 1);
  box.length = file.number(first + 2);
  box.bottom = {file.number(first + 3), file.number(first + 4), file.number(first + 5)};
  box.ry = file.number(first + 6);
  requirePosition(file, box.bottom);
  return box;
}

std::string typeWord(const LabelledBox& box)
{
  std::string type = box.type.empty() ? toString(box.object_class) : box.type;
  std::replace_if(
      type.begin(), type.end(), [](unsigned char c) { return c <= ' ' || c == ',' || c == 0x7F; },
      '_');
  return type;
}
}  // namespace dyslam
