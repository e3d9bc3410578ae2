// SPDX-License-Identifier: BSD-3-Clause
#include "PageValues.h"

#include <algorithm>
#include <cmath>

namespace dyslam
{
nlohmann::ordered_json rounded(double value, double step)
{
  if (!std::isfinite(value))
  {
    return {};
  }
  const double inverse = std::round(1 / step);
  const double result = std::round(value * inverse) / inverse;
  return result == 0 ? 0.0 : result;  // no -0.0
}

nlohmann::ordered_json rounded(const std::vector<double>& values, double step)
{
  auto json = nlohmann::ordered_json::array();
  for (const double value : values)
  {
    json.push_back(rounded(value, step));
  }
  return json;
}

nlohmann::ordered_json rounded(const Eigen::Vector3d& v, double step)
{
  return {rounded(v.x(), step), rounded(v.y(), step), rounded(v.z(), step)};
}

std::size_t stepFor(std::size_t count, std::size_t most)
{
  return std::max<std::size_t>(1, (count + most - 1) / most);
}

Trajectory everyNth(const Trajectory& trajectory, std::size_t step)
{
  Trajectory result;
  for (std::size_t i = 0; i < trajectory.size(); i += step)
  {
    result.push_back(trajectory[i].stamp, trajectory[i].pose);
  }
  return result;
}
}  // namespace dyslam
