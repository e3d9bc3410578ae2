// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "RealData.h"

namespace dyslam
{
/** An empty folder for one test, removed behind it. */
class TestFolder
{
 public:
  TestFolder()
  {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    path_ = std::filesystem::temp_directory_path() / ("dyslam_" + std::to_string(getpid()) + "_" +
                                                      test->test_suite_name() + "_" + test->name());
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~TestFolder()
  {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TestFolder(const TestFolder&) = delete;
  TestFolder& operator=(const TestFolder&) = delete;

  [[nodiscard]] std::string file(const std::string& name) const { return (path_ / name).string(); }
  [[nodiscard]] std::string path() const { return path_.string(); }

  std::string write(const std::string& name, const std::string& content) const
  {
    std::filesystem::create_directories((path_ / name).parent_path());
    std::ofstream(path_ / name, std::ios::binary) << content;
    return file(name);
  }
  [[nodiscard]] std::string read(const std::string& name) const
  {
    std::ostringstream content;
    content << std::ifstream(path_ / name, std::ios::binary).rdbuf();
    return content.str();
  }

 private:
  std::filesystem::path path_;
};

/** The folder that a test works in, until it ends. */
class WorkingFolder
{
 public:
  explicit WorkingFolder(const std::string& folder) : before_(std::filesystem::current_path())
  {
    std::filesystem::current_path(folder);
  }
  ~WorkingFolder() { std::filesystem::current_path(before_); }
  WorkingFolder(const WorkingFolder&) = delete;
  WorkingFolder& operator=(const WorkingFolder&) = delete;

 private:
  std::filesystem::path before_;
};

/** The message of the UserError that `call` throws; fails the test if it throws none. */
template <typename Error, typename Call>
std::string messageOfError(Call&& call)
{
  try
  {
    call();
  }
  catch (const Error& error)
  {
    return error.what();
  }
  ADD_FAILURE() << "nothing was thrown";
  return {};
}

inline bool contains(const std::string& text, const std::string& part)
{
  return text.find(part) != std::string::npos;
}

/** Whether one of the lines contains a text. */
inline bool hasLine(const std::vector<std::string>& lines, const std::string& part)
{
  return std::any_of(lines.begin(), lines.end(),
                     [&part](const std::string& line) { return contains(line, part); });
}
}  // namespace dyslam
