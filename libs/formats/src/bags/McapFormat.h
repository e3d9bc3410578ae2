// SPDX-License-Identifier: BSD-3-Clause
// What the reader and the writer of mcap files have in common. Format: https://mcap.dev/spec.
#pragma once

#include <cstdint>
#include <string_view>

namespace dyslam
{
/** The first and the last bytes of a file. */
inline constexpr std::string_view mcap_magic = "\x89MCAP0\r\n";

/** Kind of a record, its first byte. */
enum class McapOp : std::uint8_t
{
  header = 0x01,
  footer = 0x02,
  schema = 0x03,
  channel = 0x04,
  message = 0x05,
  chunk = 0x06,
  message_index = 0x07,
  chunk_index = 0x08,
  statistics = 0x0b,
  metadata = 0x0c,
  metadata_index = 0x0d,
  summary_offset = 0x0e,
  data_end = 0x0f,
};
}  // namespace dyslam
