// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace dyslam
{
/** A time since 1970 in seconds, whether it is in seconds, milli-, micro- or nanoseconds. */
[[nodiscard]] double secondsOf(double time);

/** Times since 1970 out of file names such as 1317042145951199337.bin or cloud_1317042145.95.pcd,
 * in nano-, micro-, milliseconds or seconds by their size; nothing unless all names are such. Puts
 * the files in the order of these times, which differs from that of names such as 12.05 and 12.5.
 */
[[nodiscard]] std::vector<double> stampsFromNames(std::vector<std::string>& files);

/** Seconds from another start than 1970, such as a simulator's or that of the computer, out of file
 * names with a decimal point such as 12.300.pcd or cloud_5321.25.pcd; nothing unless all names are
 * such, one with milliseconds, and their median step is that of scans (5 ms to 2 s). Puts the files
 * in the order of these times. */
[[nodiscard]] std::vector<double> secondsFromNames(std::vector<std::string>& files);

/** Numbers at the end of file names such as 000024.bin or scan_24.pcd, which are equal before them;
 * nothing unless all names are such, with numbers that ascend, of at most nine digits after leading
 * zeros. */
[[nodiscard]] std::vector<int> numbersFromNames(const std::vector<std::string>& files);

/** A time in messages, without zeros at the end: "0.1". */
[[nodiscard]] std::string secondsText(double seconds);
}  // namespace dyslam
