// SPDX-License-Identifier: BSD-3-Clause
#include "CalibEntries.h"

#include <dyslam/base/Error.h>
#include <dyslam/formats/TextFile.h>

#include <algorithm>

#include "PoseChecks.h"

namespace dyslam
{
Pose poseFromRows(const std::vector<double>& values, std::size_t columns, const std::string& what)
{
  Pose pose = Pose::Identity();
  for (std::size_t i = 0; i < 3 * columns; ++i)
  {
    pose.matrix()(static_cast<int>(i / columns), static_cast<int>(i % columns)) = values[i];
  }
  if (!isRotation(pose.linear()))
  {
    throw UserError(what +
                    " is not a rotation: its rows must be unit vectors at right angles, with a "
                    "determinant of 1");
  }
  if (const std::string error = positionError(pose.translation()); !error.empty())
  {
    throw UserError(what + ": " + error);
  }
  return orthonormalised(pose);
}

CalibEntries::CalibEntries(const std::string& path) : path_(path)
{
  TextFile file(path, " \t\r:");
  while (file.next())
  {
    const std::string key(file.fields().front());
    if (key != "calib_time")  // a date
    {
      entries_[key] = file.numbers(1);
    }
  }
}

const std::vector<double>* CalibEntries::find(std::initializer_list<const char*> keys,
                                              std::size_t size) const
{
  for (const char* key : keys)
  {
    const auto it = entries_.find(key);
    if (it != entries_.end())
    {
      if (it->second.size() != size)
      {
        throw UserError(path_ + ": " + key + " has " + std::to_string(it->second.size()) +
                        " numbers, needs " + std::to_string(size));
      }
      return &it->second;
    }
  }
  return nullptr;
}

const std::vector<double>& CalibEntries::numbers(std::initializer_list<const char*> keys,
                                                 std::size_t size) const
{
  const auto* values = find(keys, size);
  if (values == nullptr)
  {
    throw UserError(path_ + ": has no " + *keys.begin());
  }
  return *values;
}

Pose CalibEntries::pose(std::initializer_list<const char*> keys, std::size_t columns) const
{
  const std::vector<double>& values = numbers(keys, 3 * columns);
  const auto* const key =
      std::find_if(keys.begin(), keys.end(), [this](const char* one) { return has(one); });
  return poseFromRows(values, columns, path_ + ": the matrix of " + *key);
}
}  // namespace dyslam
