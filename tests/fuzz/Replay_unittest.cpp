// SPDX-License-Identifier: BSD-3-Clause
// Files that fuzzers found are refused, or read, in time and with little memory.
#include <dyslam/base/Error.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>

#include "Parsers.h"
#include "PeakMemory.h"
#include "RunProgram.h"
#include "TestFolder.h"

namespace fs = std::filesystem;

namespace dyslam::fuzz
{
namespace
{
std::vector<fs::path> filesIn(const fs::path& folder)
{
  std::vector<fs::path> files;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored))
  {
    files.push_back(entry.path());
  }
  return files;
}

/** Reads a file. \return error message; empty if there was no error */
std::string readCopy(const Parser& parser, const fs::path& file, const TestFolder& folder)
{
  const std::string path = folder.file(parser.file);
  fs::copy_file(file, path, fs::copy_options::overwrite_existing);
  try
  {
    parser.read(path);
  }
  catch (const UserError& error)
  {
    return error.what();
  }
  return "";
}
}  // namespace

TEST(FuzzReplay, WhatWasFoundIsReadOrRefusedInTime)
{
  const TestFolder folder;
  for (const Parser& parser : parsers())
  {
    for (const fs::path& file : filesIn(fs::path(DYSLAM_FUZZ_CORPUS) / parser.name))
    {
      SCOPED_TRACE(file.string());
      const auto begin = std::chrono::steady_clock::now();
      EXPECT_NO_THROW((void)readCopy(parser, file, folder));
      const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
      EXPECT_LT(seconds.count(), 5);
    }
  }
  EXPECT_LT(peakMegabytes(), 1000);
}

TEST(FuzzReplay, SeedsAreReadByTheirParsers)
{
  const TestFolder folder;
  ASSERT_EQ(0, runProgram("fuzz_seeds", folder.file("seeds"), folder.path()).code);
  for (const Parser& parser : parsers())
  {
    const auto seeds = filesIn(fs::path(folder.file("seeds")) / parser.name);
    EXPECT_FALSE(seeds.empty()) << parser.name;
    for (const fs::path& seed : seeds)
    {
      const std::string error = readCopy(parser, seed, folder);
      // MRPT has the XML of its calibrations only in its library, not in files.
      EXPECT_TRUE(error.empty() || parser.name == std::string("calibration_xml")) << error;
    }
  }
}
}  // namespace dyslam::fuzz
