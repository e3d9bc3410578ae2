// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
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
}  // namespace dyslam
