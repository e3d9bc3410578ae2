// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <iosfwd>
#include <string>
#include <string_view>

namespace dyslam
{
/** Unpacks `bz2`, `lz4` (frame format) or `zstd` data; `none` and the empty name copy them.
 *
 * The result grows with the data, so that a damaged size allocates nothing.
 * \param size that the result must have; 0: whatever it has.
 * \param place for messages. \throws UserError for damaged data, or a name that is none of these.
 */
[[nodiscard]] std::string decompressed(const std::string& compression,
                                       std::string_view data,
                                       std::uint64_t size,
                                       const std::string& place);

/** Unpacks a zstd file; ends early if `out` fails. \param progress is called again and again with
 * the fraction of the file that was read and the number of bytes that were unpacked
 * \throws UserError if the file can't be read or is damaged. */
void unpackZstdFile(const std::string& path,
                    std::ostream& out,
                    const std::function<void(double, std::uint64_t)>& progress);
/** The size that the header of a zstd file states for the unpacked data [bytes]; 0: it states none.
 * \throws UserError if the file can't be read. */
[[nodiscard]] std::uint64_t zstdContentSize(const std::string& path);
}  // namespace dyslam
