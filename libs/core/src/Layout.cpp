// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Layout.h>

#include <stdexcept>
#include <string>

namespace dyslam
{
Layout libraryLayout()
{
  return layout_here;
}

void requireLibraryLayout(const Layout& program)
{
  const Layout library = libraryLayout();
  if (program.eigen_alignment != library.eigen_alignment || program.frame != library.frame ||
      program.detection != library.detection || program.tracked_object != library.tracked_object)
  {
    throw std::logic_error(
        "the program was compiled for another memory layout of Eigen's types than DySLAM's "
        "libraries: link the target dyslam::core, or define EIGEN_MAX_ALIGN_BYTES=" +
        std::to_string(library.eigen_alignment));
  }
}
}  // namespace dyslam
