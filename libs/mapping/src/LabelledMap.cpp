// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/mapping/LabelledMap.h>

#include <cstdint>
#include <stdexcept>

#include "InBox.h"

namespace dyslam
{
namespace
{
constexpr double cube_size = 0.1;   // [m]
constexpr double box_margin = 0.1;  // margin by which boxes are widened to each side [m]
constexpr double clearance = 0.25;  // height over a box's lower side up to which it is ground [m]

bool isOfObject(const Eigen::Vector3d& p, const Box& box)
{
  return isInBox(box, p, {box_margin, box_margin, 0}) &&
         p.z() - box.center.z() > clearance - 0.5 * box.size.z();
}

void labelObjects(const Frame& frame, std::vector<Label>& labels)
{
  for (const auto& object : frame.objects)
  {
    for (std::size_t i = 0; i < labels.size() && object.dynamic; ++i)
    {
      if (isOfObject(frame.T_odom_vehicle * frame.cloud.points[i].cast<double>(), object.box))
      {
        labels[i] = label_moving;
      }
    }
  }
}
}  // namespace

void LabelledMap::add(const Frame& frame, const std::vector<Label>& given)
{
  if (!given.empty() && given.size() != frame.cloud.size())
  {
    throw std::invalid_argument("LabelledMap: one label per point of the cloud is needed");
  }
  std::vector<Label> labels =
      given.empty() ? std::vector<Label>(frame.cloud.size(), label_static) : given;
  labelObjects(frame, labels);
  const auto inverse = static_cast<float>(1.0 / cube_size);
  for (std::size_t i = 0; i < labels.size(); ++i)
  {
    if (isIgnoredLabel(labels[i]))
    {
      continue;
    }
    const Eigen::Vector3f p =
        (frame.T_odom_vehicle * frame.cloud.points[i].cast<double>()).cast<float>();
    const auto next = static_cast<std::uint32_t>(points_.size());
    const auto found = index_.findOrInsert(voxelKey(voxelCell(p, inverse)), next);
    if (found == next)
    {
      points_.push_back(p);
      labels_.push_back(labels[i]);
    }
    else if (!isMovingLabel(labels[i]))
    {
      labels_[found] = labels[i];
    }
  }
}
}  // namespace dyslam
