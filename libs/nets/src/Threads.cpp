// SPDX-License-Identifier: BSD-3-Clause
#include <ATen/Parallel.h>
#include <dyslam/nets/Threads.h>

#include <algorithm>

namespace dyslam
{
void useTorchThreads(int threads)
{
  const int wanted = std::max(1, threads);
  // Setting it anew may start threads anew.
  if (at::get_num_threads() != wanted)
  {
    at::set_num_threads(wanted);
  }
}
}  // namespace dyslam
