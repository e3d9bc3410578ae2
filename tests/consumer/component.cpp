// SPDX-License-Identifier: BSD-3-Clause
// uses_<component> [folder]: exit code 0 if the installed library was compiled for the same sizes
// of types as this file, and, where a folder is given, if the shared settings are found there.
#include <dyslam/core/Layout.h>
#include <dyslam/core/SharedFiles.h>
#include <dyslam/core/Version.h>

#include <cstdio>
#include <string>

#include "all_headers.h"

int main(int argc, char** argv)
{
  const dyslam::Layout here = dyslam::layout_here;
  const dyslam::Layout library = dyslam::libraryLayout();
  std::printf("dyslam %s, alignment %zu, Frame %zu bytes here, %zu in the library\n",
              DYSLAM_VERSION, here.eigen_alignment, here.frame, library.frame);
  if (here.eigen_alignment != library.eigen_alignment || here.frame != library.frame ||
      here.detection != library.detection || here.tracked_object != library.tracked_object)
  {
    return 1;
  }
  if (argc > 1)
  {
    const std::string found = dyslam::findGivenOrShared("kitti64", "config_files", ".ini");
    std::printf("%s\n", found.c_str());
    return found.rfind(argv[1], 0) == 0 ? 0 : 2;
  }
  return 0;
}
