// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/RuntimeModule.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

namespace dyslam
{
namespace
{
std::string errorOf(const std::string& module, const std::string& function)
{
  try
  {
    (void)runtimeModuleFunction(module, function, "dyseg.method: network");
  }
  catch (const UserError& error)
  {
    return error.what();
  }
  return "none";
}

TEST(RuntimeModule, GivesItsFunction)
{
  auto* square = runtimeModuleFunction<int(int)>("test", "dyslam_test_square", "the test");
  EXPECT_EQ(square(7), 49);
}

TEST(RuntimeModule, TheBuildForThisMachineIsTakenUnlessThePlainOneIsAskedFor)
{
  const auto cpu = []
  {
    return std::string(
        runtimeModuleFunction<const char*()>("cpu_test", "dyslam_test_cpu", "the test")());
  };
  ASSERT_EQ(setenv("DYSLAM_CPU", "baseline", 1), 0);
  EXPECT_EQ(cpu(), "baseline");
  ASSERT_EQ(unsetenv("DYSLAM_CPU"), 0);
#ifdef __x86_64__
  const bool has_v3 = __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0 &&
                      __builtin_cpu_supports("bmi2") != 0;
  EXPECT_EQ(cpu(), has_v3 ? "x86-64-v3" : "baseline");
#endif
}

/** Of a tree that was installed in another prefix than the configured one. */
TEST(RuntimeModule, IsFoundBesideTheSharedFiles)
{
  namespace fs = std::filesystem;
  const fs::path prefix = fs::path(testing::TempDir()) / "dyslam_prefix";
  fs::remove_all(prefix);
  fs::create_directories(prefix / "share" / "dyslam");
  for (const char* folder : {"lib", "lib64", "lib/x86_64-linux-gnu"})
  {
    fs::create_directories(prefix / folder / "dyslam");
    std::ofstream(prefix / folder / "dyslam" / "libdyslam-moved.so") << "a module";
  }
  EXPECT_EQ(runtimeModuleFile("moved"), "");
  const char* given = std::getenv("DYSLAM_SHARE");
  const std::string before = given != nullptr ? given : "";
  ASSERT_EQ(setenv("DYSLAM_SHARE", (prefix / "share" / "dyslam").c_str(), 1), 0);
  const std::string found = runtimeModuleFile("moved");
  const std::string error = errorOf("nothing", "dyslam_test_square");
  (void)(before.empty() ? unsetenv("DYSLAM_SHARE") : setenv("DYSLAM_SHARE", before.c_str(), 1));
  EXPECT_EQ(found.rfind((prefix / "lib").string(), 0), 0U) << found;
  EXPECT_EQ(fs::path(found).filename(), "libdyslam-moved.so");
  EXPECT_NE(error.find((prefix / "lib").string()), std::string::npos) << error;
  fs::remove_all(prefix);
}

TEST(RuntimeModule, EmptyVariablesCountAsNotSet)
{
  for (const char* variable : {"DYSLAM_SHARE", "DYSLAM_MODULES"})
  {
    const char* given = std::getenv(variable);
    const std::string before = given != nullptr ? given : "";
    (void)unsetenv(variable);
    const std::string file = runtimeModuleFile("test");
    const std::string error = errorOf("nothing", "dyslam_test_square");
    ASSERT_EQ(setenv(variable, "", 1), 0);
    EXPECT_EQ(runtimeModuleFile("test"), file) << variable;
    EXPECT_EQ(errorOf("nothing", "dyslam_test_square"), error) << variable;
    (void)(before.empty() ? unsetenv(variable) : setenv(variable, before.c_str(), 1));
  }
}

TEST(RuntimeModule, MissingOneNamesTheSettingAndTheFile)
{
  const std::string error = errorOf("nothing", "dyslam_test_square");
  EXPECT_EQ(error.find("dyseg.method: network needs libdyslam-nothing.so"), 0U) << error;
}

TEST(RuntimeModule, OfAnotherVersionIsRefused)
{
  const std::string error = errorOf("old_test", "dyslam_test_square");
  EXPECT_NE(error.find("libdyslam-old_test.so: is of version 0.0.0"), std::string::npos) << error;
}

TEST(RuntimeModule, MissingFunctionIsNamed)
{
  const std::string error = errorOf("test", "dyslam_test_cube");
  EXPECT_NE(error.find("has no function dyslam_test_cube"), std::string::npos) << error;
}
}  // namespace
}  // namespace dyslam
