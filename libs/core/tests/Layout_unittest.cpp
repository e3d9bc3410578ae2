// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Layout.h>
#include <gtest/gtest.h>

#include <stdexcept>

namespace dyslam
{
TEST(Layout, ThatOfAProgramMustBeThatOfTheLibrary)
{
  EXPECT_NO_THROW(requireLibraryLayout(layout_here));
  Layout avx = layout_here;
  avx.eigen_alignment = 2 * layout_here.eigen_alignment;
  EXPECT_THROW(requireLibraryLayout(avx), std::logic_error);
  Layout longer = layout_here;
  longer.tracked_object += 16;
  EXPECT_THROW(requireLibraryLayout(longer), std::logic_error);
}
}  // namespace dyslam
