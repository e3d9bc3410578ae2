// SPDX-License-Identifier: BSD-3-Clause
#include "FirstLidar.h"

namespace dyslam
{
FirstLidar::FirstLidar(const std::string& labels) : wanted_("sensor_label", labels) {}

bool FirstLidar::mayBe(const std::string& name, const FurtherLidars& further) const
{
  return wanted_.pattern().empty() ? !further.areNamed(name) : wanted_.fits(name);
}

bool FirstLidar::takes(const std::string& name, const FurtherLidars& further)
{
  met_.insert(name);
  if (!label_ && mayBe(name, further))
  {
    label_ = name;
  }
  return label_ == name;
}

bool FirstLidar::mayOwnTimeRing(const std::string& name, const FurtherLidars& further) const
{
  if (label_)
  {
    return label_ == name;
  }
  return !wanted_.pattern().empty() || !further.areNamed(name);
}

std::string FirstLidar::reasonForNone(const FurtherLidars& further) const
{
  if (met_.empty())
  {
    return "";
  }
  std::string known;
  for (const std::string& name : met_)
  {
    known += (known.empty() ? "'" : ", '") + name + "'";
  }
  if (wanted_.pattern().empty())
  {
    return "further_lidars = " + further.pattern() + " selects every lidar of the file, " + known +
           "; name the first one with sensor_label";
  }
  return "no 3D scan has a label like '" + wanted_.pattern() + "'; the file has " + known;
}
}  // namespace dyslam
