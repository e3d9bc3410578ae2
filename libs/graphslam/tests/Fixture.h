// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Config.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace dyslam::test
{
/** A folder of its own for each test program, removed in the end. */
class WithFolder : public ::testing::Test
{
 protected:
  static void SetUpTestSuite()
  {
    folder_ =
        std::filesystem::temp_directory_path() / ("dyslam_graphslam_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  static void TearDownTestSuite() { std::filesystem::remove_all(folder_); }

  static std::string pathOf(const std::string& name) { return (folder_ / name).string(); }

  inline static std::filesystem::path folder_;
};

inline std::string contentOf(const std::filesystem::path& path)
{
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

inline std::string bundled(const std::string& name)
{
  return std::string(DYSLAM_SOURCE_DIR) + "/" + name;
}

/** Settings for campus16 by which any place that was left 4 m ago makes a loop, however poor, and
 * every loop is solved for. */
inline Config loopyConfig(int scans)
{
  Config config = Config::fromFile(bundled("share/dyslam/config_files/vlp16.ini"));
  config.set("input.only_first_n=" + std::to_string(scans));
  for (const char* assignment :
       {"backend.keyframe_distance=0.8", "backend.residual_to_optimise=0", "loop.min_path=4",
        "loop.min_support=0", "loop.interval=1", "loop.max_descriptor_distance=1",
        "loop.min_overlap=0.3", "loop.min_observability=0"})
  {
    config.set(assignment);
  }
  return config;
}
}  // namespace dyslam::test
