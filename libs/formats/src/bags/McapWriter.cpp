// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Bytes.h>
#include <dyslam/base/Error.h>
#include <dyslam/base/PendingFile.h>
#include <dyslam/base/Version.h>
#include <dyslam/formats/BagWriter.h>
#include <libdeflate.h>
#include <zstd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <map>
#include <new>
#include <utility>
#include <vector>

#include "McapFormat.h"

namespace dyslam
{
namespace
{
constexpr std::size_t mcap_chunk_size = std::size_t{4}
                                        << 20U;  // from which a chunk is written [bytes]
constexpr int mcap_zstd_level = 1;               // of zstd

/** The content of a record while it is put together. */
class McapRecord
{
 public:
  template <typename Number>
  McapRecord& put(Number value)
  {
    appendBytes(content_, value);
    return *this;
  }
  /** A text, an array or a map: its length, then its bytes. */
  McapRecord& block(std::string_view bytes)
  {
    put(static_cast<std::uint32_t>(bytes.size()));
    content_ += bytes;
    return *this;
  }
  [[nodiscard]] const std::string& content() const { return content_; }

  /** The whole record. */
  [[nodiscard]] std::string as(McapOp op) const
  {
    std::string record(1, static_cast<char>(op));
    appendBytes(record, static_cast<std::uint64_t>(content_.size()));
    return record + content_;
  }

 private:
  std::string content_;
};

/** Keys and values, as in records of channels and metadata. */
std::string textMapOf(const std::vector<std::pair<std::string, std::string>>& entries)
{
  McapRecord map;
  for (const auto& [key, value] : entries)
  {
    map.block(key).block(value);
  }
  return map.content();
}

/** The quality of service as rosbag2 of ROS 2 Humble writes it: reliable, keeping the last, and
 * without limits of time. */
std::string qosOf(bool latched)
{
  const std::string unlimited = "\n    sec: 9223372036\n    nsec: 854775807";
  return std::string("- history: 1\n  depth: ") + (latched ? "1" : "10") +
         "\n  reliability: 1\n  durability: " + (latched ? "1" : "2") +
         "\n  deadline:" + unlimited + "\n  lifespan:" + unlimited + "\n  liveliness: 1" +
         "\n  liveliness_lease_duration:" + unlimited +
         "\n  avoid_ros_namespace_conventions: false";
}

/** A topic with what was written of it. */
struct WrittenChannel
{
  std::string definition;   //!< its record
  bool is_defined = false;  //!< the record was written
  std::uint64_t messages = 0;
};

/** Where the messages of a channel are in a chunk: times and offsets. */
using ChannelIndex = std::vector<std::pair<std::uint64_t, std::uint64_t>>;
}  // namespace

struct BagWriter::Impl
{
  explicit Impl(const std::string& path)
      : pending(path),
        file(pending.temporary(), std::ios::binary | std::ios::trunc),
        zstd(ZSTD_createCCtx(), ZSTD_freeCCtx)
  {
    if (!zstd)
    {
      throw std::bad_alloc();
    }
    requireWritten();
    append(mcap_magic);
    append(McapRecord().block("ros2").block("dyslam " DYSLAM_VERSION).as(McapOp::header));
    // By this record rosbag2 of later versions takes the numbers of qosOf() for what they are.
    metadata_at = position;
    metadata = McapRecord()
                   .block("rosbag2")
                   .block(textMapOf({{"ROS_DISTRO", "humble"}}))
                   .as(McapOp::metadata);
    append(metadata);
  }

  /** \throws UserError if the last output failed. */
  void requireWritten() const
  {
    if (!file)
    {
      throw UserError(pending.path() + ": cannot be written: " +
                      (errno != 0 ? std::strerror(errno) : "unknown reason"));
    }
  }

  /** Writes to the file. \throws UserError. */
  void append(std::string_view bytes)
  {
    errno = 0;
    file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    requireWritten();
    position += bytes.size();
    crc = libdeflate_crc32(crc, bytes.data(), bytes.size());
  }

  [[nodiscard]] std::string compressed(const std::string& data) const
  {
    std::string result(ZSTD_compressBound(data.size()), '\0');
    const std::size_t size = ZSTD_compressCCtx(zstd.get(), result.data(), result.size(),
                                               data.data(), data.size(), mcap_zstd_level);
    if (ZSTD_isError(size) != 0)
    {
      throw UserError(pending.path() + ": cannot be compressed: " + ZSTD_getErrorName(size));
    }
    result.resize(size);
    return result;
  }

  /** Writes the chunk with the indexes of its messages. */
  void endChunk()
  {
    if (chunk.empty())
    {
      return;
    }
    const std::string data = compressed(chunk);
    const std::uint64_t begin = position;
    McapRecord record;
    record.put(chunk_first).put(last).put(static_cast<std::uint64_t>(chunk.size()));
    record.put(libdeflate_crc32(0, chunk.data(), chunk.size()));
    record.block("zstd").put(static_cast<std::uint64_t>(data.size()));
    // Head and data of the record are written one after the other, to copy no data.
    std::string head(1, static_cast<char>(McapOp::chunk));
    appendBytes(head, static_cast<std::uint64_t>(record.content().size() + data.size()));
    append(head + record.content());
    append(data);
    const std::uint64_t end = position;
    McapRecord offsets;
    for (const auto& [channel, messages] : indexes)
    {
      McapRecord entries;
      for (const auto& [time, offset] : messages)
      {
        entries.put(time).put(offset);
      }
      offsets.put(channel).put(position);
      append(McapRecord().put(channel).block(entries.content()).as(McapOp::message_index));
    }
    McapRecord index;
    index.put(chunk_first).put(last).put(begin).put(end - begin).block(offsets.content());
    index.put(position - end).block("zstd").put(static_cast<std::uint64_t>(data.size()));
    index.put(static_cast<std::uint64_t>(chunk.size()));
    chunk_indexes += index.as(McapOp::chunk_index);
    ++chunks;
    chunk.clear();
    indexes.clear();
  }

  [[nodiscard]] std::string statistics() const
  {
    std::uint64_t messages = 0;
    std::uint32_t used = 0;
    McapRecord counts;
    for (std::size_t i = 0; i < channels.size(); ++i)
    {
      if (channels[i].messages > 0)
      {
        messages += channels[i].messages;
        ++used;
        counts.put(static_cast<std::uint16_t>(i + 1)).put(channels[i].messages);
      }
    }
    McapRecord record;
    record.put(messages).put(static_cast<std::uint16_t>(written_schemas.size())).put(used);
    record.put(std::uint32_t{0}).put(std::uint32_t{1}).put(chunks);  // attachments, metadata
    record.put(first).put(last).block(counts.content());
    return record.as(McapOp::statistics);
  }

  /** Records of the summary, each group with its kind. */
  [[nodiscard]] std::vector<std::pair<McapOp, std::string>> summary() const
  {
    std::string of_schemas;
    std::string of_channels;
    for (const std::uint16_t schema : written_schemas)
    {
      of_schemas += schemas.at(schema - 1U).second;
    }
    for (const WrittenChannel& channel : channels)
    {
      of_channels += channel.is_defined ? channel.definition : "";
    }
    McapRecord of_metadata;
    of_metadata.put(metadata_at).put(static_cast<std::uint64_t>(metadata.size())).block("rosbag2");
    return {{McapOp::schema, of_schemas},
            {McapOp::channel, of_channels},
            {McapOp::statistics, statistics()},
            {McapOp::metadata_index, of_metadata.as(McapOp::metadata_index)},
            {McapOp::chunk_index, chunk_indexes}};
  }

  void writeEnd()
  {
    endChunk();
    append(McapRecord().put(crc).as(McapOp::data_end));
    crc = 0;  // from here on that of the summary
    const std::uint64_t summary_at = position;
    std::string offsets;
    for (const auto& [op, records] : summary())
    {
      if (!records.empty())
      {
        McapRecord offset;
        offset.put(op).put(position).put(static_cast<std::uint64_t>(records.size()));
        offsets += offset.as(McapOp::summary_offset);
        append(records);
      }
    }
    const std::uint64_t offsets_at = position;
    append(offsets);
    std::string footer(1, static_cast<char>(McapOp::footer));
    appendBytes(footer, std::uint64_t{20});  // length of the three numbers
    appendBytes(footer, summary_at);
    appendBytes(footer, offsets_at);
    append(footer);
    append(McapRecord().put(crc).content());
    append(mcap_magic);
  }

  PendingFile pending;
  std::ofstream file;
  std::unique_ptr<ZSTD_CCtx, decltype(&ZSTD_freeCCtx)> zstd;
  std::uint64_t position = 0;  //!< in the file [bytes]
  std::uint32_t crc = 0;       //!< of the section so far
  std::uint64_t metadata_at = 0;
  std::string metadata;
  std::vector<std::pair<std::string, std::string>> schemas;  //!< types with their records
  std::vector<std::uint16_t> written_schemas;                //!< numbers, in the order of the file
  std::vector<std::uint16_t> schema_of;                      //!< by channel, from 0
  std::vector<WrittenChannel> channels;
  std::string chunk;
  std::map<std::uint16_t, ChannelIndex> indexes;  //!< of the chunk, by channel
  std::string chunk_indexes;
  std::uint32_t chunks = 0;
  std::uint64_t chunk_first = 0;  //!< time of the chunk's first message [ns]
  std::uint64_t first = 0;        //!< time of the first message [ns]
  std::uint64_t last = 0;         //!< time of the last message [ns]
  bool any = false;
};

BagWriter::BagWriter(const std::string& path) : impl_(std::make_unique<Impl>(path)) {}
BagWriter::~BagWriter() = default;

std::size_t BagWriter::addTopic(const BagWriterTopic& topic)
{
  Impl& file = *impl_;
  const auto known =
      std::find_if(file.schemas.begin(), file.schemas.end(),
                   [&topic](const auto& schema) { return schema.first == topic.type; });
  const auto schema = static_cast<std::uint16_t>(known - file.schemas.begin() + 1);
  if (known == file.schemas.end())
  {
    McapRecord record;
    record.put(schema).block(topic.type).block("ros2msg").block(topic.definition);
    file.schemas.emplace_back(topic.type, record.as(McapOp::schema));
  }
  const auto channel = static_cast<std::uint16_t>(file.channels.size() + 1);
  McapRecord record;
  record.put(channel).put(schema).block(topic.name).block("cdr");
  record.block(textMapOf({{"offered_qos_profiles", qosOf(topic.latched)}}));
  file.channels.push_back({record.as(McapOp::channel), false, 0});
  file.schema_of.push_back(schema);
  return file.channels.size() - 1;
}

void BagWriter::write(std::size_t topic, std::uint64_t published, std::string_view data)
{
  Impl& file = *impl_;
  WrittenChannel& channel = file.channels.at(topic);
  const std::uint64_t time = std::max(published, file.last);
  file.first = file.any ? file.first : time;
  file.chunk_first = file.chunk.empty() ? time : file.chunk_first;
  file.last = time;
  file.any = true;
  if (!channel.is_defined)
  {
    const std::uint16_t schema = file.schema_of[topic];
    std::vector<std::uint16_t>& written = file.written_schemas;
    if (std::find(written.begin(), written.end(), schema) == written.end())
    {
      written.push_back(schema);
      file.chunk += file.schemas[schema - 1U].second;
    }
    file.chunk += channel.definition;
    channel.is_defined = true;
  }
  const auto number = static_cast<std::uint16_t>(topic + 1);
  file.indexes[number].emplace_back(time, file.chunk.size());
  McapRecord head;
  head.put(number).put(static_cast<std::uint32_t>(channel.messages++)).put(time).put(published);
  file.chunk += static_cast<char>(McapOp::message);
  appendBytes(file.chunk, static_cast<std::uint64_t>(head.content().size() + data.size()));
  file.chunk += head.content();
  file.chunk += data;
  if (file.chunk.size() >= mcap_chunk_size)
  {
    file.endChunk();
  }
}

void BagWriter::close()
{
  impl_->writeEnd();
  errno = 0;
  impl_->file.close();
  impl_->requireWritten();
  impl_->pending.commit();
}
}  // namespace dyslam
