// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Layout.h>

namespace dyslam
{
Layout libraryLayout()
{
  return layout_here;
}
}  // namespace dyslam
