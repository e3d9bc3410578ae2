// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace dyslam
{
/** Sets torch's number of threads, which all networks of a program share: each network asks for its
 * own before it runs. Below 1 counts as 1. */
void useTorchThreads(int threads);
}  // namespace dyslam
