// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>

namespace dyslam
{
/** A folder of the real data, if DYSLAM_DATA names their folder and it contains the set. \param set
 * name of the subfolder; empty for all data */
inline std::optional<std::string> realDataFolder(const std::string& set = "")
{
  const char* all = std::getenv("DYSLAM_DATA");
  if (all == nullptr || *all == 0)
  {
    return std::nullopt;
  }
  const std::filesystem::path folder = std::filesystem::path(all) / set;
  return std::filesystem::is_directory(folder) ? std::optional<std::string>(folder.string())
                                               : std::nullopt;
}
}  // namespace dyslam

/** Skips the test without this set of real data. */
#define DYSLAM_REQUIRE_DATA(...)                                              \
  if (!dyslam::realDataFolder(__VA_ARGS__))                                   \
  {                                                                           \
    GTEST_SKIP() << "DYSLAM_DATA is not set, or has no folder " #__VA_ARGS__; \
  }                                                                           \
  static_assert(true)
