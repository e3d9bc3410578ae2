// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace dyslam
{
/** Keep freed memory in the process instead of giving it back to the system.
 *
 * A stream of scans frees and takes the same megabytes again and again; pages that come fresh from
 * the system must be cleared each time, a fifth of the time of a network's pass. For programs, at
 * their start; without effect where the C library is not glibc.
 */
void keepFreedMemory();
}  // namespace dyslam
