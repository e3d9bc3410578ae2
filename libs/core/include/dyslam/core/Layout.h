// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>
#include <dyslam/core/Objects.h>

#include <cstddef>

namespace dyslam
{
/** Sizes in bytes that a library and its user must agree on. They depend on Eigen's alignment,
 * which other compiler flags (AVX) would change; the targets of dyslam pass it on. */
struct Layout
{
  std::size_t eigen_alignment = 0;
  std::size_t frame = 0;
  std::size_t detection = 0;
  std::size_t tracked_object = 0;
};

/** Layout in the translation unit that includes this; not inline, so that each has its own. */
constexpr Layout layout_here{EIGEN_MAX_ALIGN_BYTES, sizeof(Frame), sizeof(Detection),
                             sizeof(TrackedObject)};

/** Layout in the compiled library. */
[[nodiscard]] Layout libraryLayout();

/** \param program layout_here of a program that uses the library \throws std::logic_error if the
 * library has another: objects passed between them would be damaged. */
void requireLibraryLayout(const Layout& program);
}  // namespace dyslam
