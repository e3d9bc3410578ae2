// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace dyslam
{
/** Keep freed memory in the process instead of giving it back to the system.
 *
 * Each scan frees and allocates the same megabytes; the system clears every new page, which takes a
 * fifth of the time of a network's forward pass. Call it at the start of a program. No effect
 * without glibc.
 */
void keepFreedMemory();
}  // namespace dyslam
