// SPDX-License-Identifier: BSD-3-Clause
// The main of every test program: a folder of its own for temporary files, an exit code that tells
// ctest of skips, and no skip for want of real data where DYSLAM_DATA_REQUIRED is set.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>

namespace
{
constexpr int exit_failed = 1;
constexpr int exit_skipped = 77;  // SKIP_RETURN_CODE in cmake/DySLAMTests.cmake

/** Notes whether a test was skipped because real data are missing. */
class RequireData : public testing::EmptyTestEventListener
{
 public:
  [[nodiscard]] bool missed() const { return missed_; }

 private:
  void OnTestPartResult(const testing::TestPartResult& result) override
  {
    if (result.skipped() && std::string(result.message()).find("DYSLAM_DATA") != std::string::npos)
    {
      missed_ = true;
    }
  }

  bool missed_ = false;
};

/** A temporary folder that is removed with its content at the end. */
class TemporaryFolder
{
 public:
  TemporaryFolder()
      : folder_(std::filesystem::temp_directory_path() /
                ("dyslam_tests_" + std::to_string(getpid())))
  {
    std::filesystem::create_directories(folder_);
    setenv("TMPDIR", folder_.c_str(), 1);
    setenv("TEST_TMPDIR", folder_.c_str(), 1);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder()
  {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }

 private:
  std::filesystem::path folder_;
};

int exitCode(int gtest_code, bool missed_data)
{
  const auto& unit = *testing::UnitTest::GetInstance();
  const char* required = std::getenv("DYSLAM_DATA_REQUIRED");
  if (missed_data && required != nullptr && *required != '\0')
  {
    std::puts("A test was skipped for want of data, and DYSLAM_DATA_REQUIRED is set: failed.");
    return exit_failed;
  }
  if (unit.test_to_run_count() == 0)
  {
    std::puts("No test of that name.");
    return exit_failed;
  }
  const bool all_skipped = unit.skipped_test_count() == unit.test_to_run_count();
  return gtest_code == 0 && all_skipped ? exit_skipped : gtest_code;
}
}  // namespace

int main(int argc, char** argv)
{
  testing::InitGoogleTest(&argc, argv);
  const TemporaryFolder temporary;
  auto* const data = new RequireData;  // owned by gtest
  testing::UnitTest::GetInstance()->listeners().Append(data);
  const int code = RUN_ALL_TESTS();
  return testing::GTEST_FLAG(list_tests) ? code : exitCode(code, data->missed());
}
