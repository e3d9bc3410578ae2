// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Bytes.h>
#include <dyslam/benchmarks/DistanceCloud.h>
#include <dyslam/formats/CloudHeader.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>

namespace dyslam
{
std::array<std::uint8_t, 3> colourOfDistance(float distance, float largest)
{
  if (!std::isfinite(distance))
  {
    return {128, 128, 128};
  }
  // Blue, green, yellow, red, at equal steps.
  constexpr std::array<std::array<float, 3>, 4> colours{
      {{0, 64, 255}, {0, 200, 80}, {255, 220, 0}, {230, 0, 0}}};
  const float place =
      std::clamp(distance / largest, 0.F, 1.F) * static_cast<float>(colours.size() - 1);
  const auto low = std::min(static_cast<std::size_t>(place), colours.size() - 2);
  const float part = place - static_cast<float>(low);
  std::array<std::uint8_t, 3> colour{};
  for (std::size_t i = 0; i < colour.size(); ++i)
  {
    colour[i] = static_cast<std::uint8_t>(
        std::lround(colours[low][i] + part * (colours[low + 1][i] - colours[low][i])));
  }
  return colour;
}

std::string distancePly(const std::vector<Eigen::Vector3f>& points,
                        const std::vector<float>& distances)
{
  if (points.size() != distances.size())
  {
    throw std::invalid_argument("distancePly: " + std::to_string(points.size()) + " points, but " +
                                std::to_string(distances.size()) + " distances");
  }
  CloudHeader header;
  header.points = points.size();
  header.fields = {{"x"},
                   {"y"},
                   {"z"},
                   {"red", CloudFieldType::uint8},
                   {"green", CloudFieldType::uint8},
                   {"blue", CloudFieldType::uint8},
                   {"scalar_distance"}};
  std::string bytes = plyHeader(header);
  constexpr std::size_t size = 4 * sizeof(float) + 3;
  bytes.reserve(bytes.size() + size * points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    for (const float coordinate : points[i])
    {
      appendBytes(bytes, coordinate);
    }
    for (const std::uint8_t channel : colourOfDistance(distances[i]))
    {
      appendBytes(bytes, channel);
    }
    appendBytes(bytes, distances[i]);
  }
  return bytes;
}
}  // namespace dyslam
