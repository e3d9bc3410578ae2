// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace dyslam
{
/** Keeps freed memory in the process instead of giving it back to the system, and asks for huge
 * pages (2 MiB).
 *
 * Each scan frees and allocates the same megabytes. The system clears every new page, and each page
 * of 4 KiB costs a page fault: together up to a tenth of the processor time of a run. Reserves 1
 * GiB of address space; memory is taken as it is used. Call it at the start of a program. No effect
 * without glibc on Linux; no huge pages where `/sys/kernel/mm/transparent_hugepage/enabled` is
 * `never`.
 * \param arenas maximum number of malloc's arenas. With one, threads reuse each other's freed
 * memory, but wait for each other if they allocate often.
 */
void tuneHeap(int arenas = 1);
}  // namespace dyslam
