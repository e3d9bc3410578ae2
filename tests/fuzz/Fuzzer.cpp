// SPDX-License-Identifier: BSD-3-Clause
// One program for each parser: DYSLAM_PARSER says which. Run it as any libFuzzer program.
#include <dyslam/base/Error.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "Parsers.h"

namespace
{
/** Folder of this process in a file system in memory. */
std::filesystem::path makeFolder()
{
  const auto folder = std::filesystem::path("/dev/shm") /
                      ("dyslam_fuzz_" DYSLAM_PARSER "_" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  std::atexit(
      []
      {
        std::error_code ignored;
        std::filesystem::remove_all(
            "/dev/shm/dyslam_fuzz_" DYSLAM_PARSER "_" + std::to_string(::getpid()), ignored);
      });
  return folder;
}
}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
  static const dyslam::fuzz::Parser& parser = dyslam::fuzz::parserNamed(DYSLAM_PARSER);
  static const std::string path = (makeFolder() / parser.file).string();
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (file == nullptr || std::fwrite(data, 1, size, file) != size || std::fclose(file) != 0)
  {
    std::perror(path.c_str());
    std::abort();
  }
  try
  {
    parser.read(path);
  }
  catch (const dyslam::UserError&)
  {
    // the expected error for a bad file
  }
  return 0;
}
