// SPDX-License-Identifier: BSD-3-Clause
// uses_base [folder]: exit code 0 if, where a folder is given, the shared settings are found there.
#include <dyslam/base/SharedFiles.h>
#include <dyslam/base/Version.h>

#include <cstdio>
#include <string>

#include "all_headers.h"

int main(int argc, char** argv)
{
  std::printf("dyslam %s\n", DYSLAM_VERSION);
  if (argc > 1)
  {
    const std::string found = dyslam::findGivenOrShared("kitti64", "config_files", ".ini");
    std::printf("%s\n", found.c_str());
    return found.rfind(argv[1], 0) == 0 ? 0 : 2;
  }
  return 0;
}
