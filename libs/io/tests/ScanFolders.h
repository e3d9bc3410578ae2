// SPDX-License-Identifier: BSD-3-Clause
// Folders of scans for the tests of the converters.
#pragma once

#include <dyslam/formats/ScanFiles.h>

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "SyntheticScans.h"
#include "TestFolder.h"

namespace dyslam
{
inline std::string number(std::size_t i, std::size_t digits)
{
  const std::string text = std::to_string(i);
  return std::string(digits - text.size(), '0') + text;
}

inline void makeFolderOf(const TestFolder& folder, const std::string& name)
{
  std::filesystem::create_directories(folder.file(name));
}

inline void writeBins(const TestFolder& folder,
                      const std::string& name,
                      std::size_t count,
                      std::size_t digits = 6)
{
  makeFolderOf(folder, name);
  for (std::size_t i = 0; i < count; ++i)
  {
    const Scan scan = someScan(i, 10 + i);
    writeBin(folder.file(name + "/" + number(i, digits) + ".bin"), scan.points, scan.intensity);
  }
}

/** A scan as nuScenes writes it: x y z intensity ring, 320 points on 32 rings. */
inline std::string fiveColumns(std::size_t seed)
{
  std::vector<float> values;
  for (std::size_t i = 0; i < 320; ++i)
  {
    const auto k = static_cast<float>(i + seed);
    values.insert(values.end(),
                  {3.3F + 0.1F * k, -2.7F, 0.01F * k, 255, static_cast<float>(i % 32)});
  }
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float)};
}
}  // namespace dyslam
