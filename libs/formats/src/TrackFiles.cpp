// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/PendingFile.h>
#include <dyslam/formats/TextFile.h>
#include <dyslam/formats/TrackFiles.h>

#include "PoseChecks.h"
#include "TrackLines.h"

namespace dyslam
{
std::vector<LabelledBox> readTracks(const std::string& path)
{
  TextFile file(path);
  std::vector<LabelledBox> boxes;
  while (file.next())
  {
    LabelledBox box = readTrackLine(file, "height width length x y z yaw");
    box.id = file.integer(1);
    box.box.size = {file.number(12), file.number(11), file.number(10)};
    box.box.centre = {file.number(13), file.number(14), file.number(15)};
    requirePosition(file, box.box.centre);
    box.box.yaw = file.number(16);
    boxes.push_back(box);
  }
  return boxes;
}

std::string trackLine(const LabelledBox& box)
{
  std::string text = std::to_string(box.frame) + ' ' + std::to_string(box.id) + ' ' +
                     typeWord(box) + ' ' + std::to_string(box.truncated) + ' ' +
                     std::to_string(box.occluded);
  const auto append = [&text](double value)
  {
    text += ' ';
    appendNumber(text, value, 9);
  };
  append(-10);  // alpha, the observation angle in the camera image: unknown
  for (int i = 0; i < 4; ++i)
  {
    append(box.image_box[i]);
  }
  const Box& b = box.box;
  for (const double value : {b.size.z(), b.size.y(), b.size.x(), b.centre.x(), b.centre.y(),
                             b.centre.z(), b.yaw, box.score})
  {
    append(value);
  }
  return text + '\n';
}

void writeTracks(const std::string& path, const std::vector<LabelledBox>& boxes)
{
  std::string text;
  for (const LabelledBox& box : boxes)
  {
    text += trackLine(box);
  }
  writeWhole(path, text);
}
}  // namespace dyslam
