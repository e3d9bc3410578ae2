// SPDX-License-Identifier: BSD-3-Clause
// uses_<component>: exit code 0 if the installed library was compiled for the same sizes of types
// as this file.
#include <dyslam/base/Version.h>
#include <dyslam/core/Layout.h>

#include <cstdio>

#include "all_headers.h"

int main()
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
  return 0;
}
