// SPDX-License-Identifier: BSD-3-Clause
#include "BagWriters.h"

#include <bzlib.h>
#include <dyslam/base/Bytes.h>
#include <libdeflate.h>
#include <lz4frame.h>
#include <sqlite3.h>
#include <zstd.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <stdexcept>

#include "RosMessageWriters.h"

namespace dyslam::test
{
namespace
{
void appendBlock(std::string& bytes, const std::string& block)
{
  appendBytes(bytes, static_cast<std::uint32_t>(block.size()));
  bytes += block;
}

void appendTime(std::string& bytes, double stamp)
{
  appendBytes(bytes, static_cast<std::uint32_t>(nanoseconds(stamp) / 1000000000U));
  appendBytes(bytes, static_cast<std::uint32_t>(nanoseconds(stamp) % 1000000000U));
}

std::string compressed(const std::string& name, const std::string& data)
{
  std::string result(data.size() * 2 + 1000, '\0');
  if (name == "none" || name.empty())
  {
    return data;
  }
  if (name == "bz2")
  {
    auto size = static_cast<unsigned>(result.size());
    BZ2_bzBuffToBuffCompress(result.data(), &size, const_cast<char*>(data.data()),
                             static_cast<unsigned>(data.size()), 9, 0, 0);
    result.resize(size);
  }
  else if (name == "lz4")
  {
    result.resize(
        LZ4F_compressFrame(result.data(), result.size(), data.data(), data.size(), nullptr));
  }
  else
  {
    result.resize(ZSTD_compress(result.data(), result.size(), data.data(), data.size(), 1));
  }
  return result;
}

void save(const std::string& path, const std::string& bytes)
{
  std::ofstream(path, std::ios::binary) << bytes;
}

// ---- ROS 1
std::string field(const std::string& name, const std::string& value)
{
  std::string bytes;
  appendBlock(bytes, name + "=" + value);
  return bytes;
}

template <typename T>
std::string number(const std::string& name, T value)
{
  std::string bytes;
  appendBytes(bytes, value);
  return field(name, bytes);
}

std::string timeField(double stamp)
{
  std::string bytes;
  appendTime(bytes, stamp);
  return field("time", bytes);
}

std::string record(std::uint8_t op, const std::string& fields, const std::string& data)
{
  std::string bytes;
  appendBlock(bytes, number("op", op) + fields);
  appendBlock(bytes, data);
  return bytes;
}

std::string connectionRecord(std::uint32_t id, const TestMessage& message)
{
  return record(7, number("conn", id) + field("topic", message.topic),
                field("topic", message.topic) + field("type", message.type) + field("md5sum", "*") +
                    field("message_definition", ""));
}

// ---- mcap
std::string mcapRecord(std::uint8_t op, const std::string& content)
{
  std::string bytes(1, static_cast<char>(op));
  appendBytes(bytes, static_cast<std::uint64_t>(content.size()));
  return bytes + content;
}

std::string ros2Type(const std::string& type)
{
  const auto slash = type.find('/');
  return type.substr(0, slash) + "/msg" + type.substr(slash);
}

std::string mcapDefinition(std::uint16_t id,
                           const TestMessage& message,
                           const std::string& encoding)
{
  std::string schema;
  appendBytes(schema, static_cast<std::uint16_t>(id + 1));
  appendBlock(schema, encoding == "cdr" ? ros2Type(message.type) : message.type);
  appendBlock(schema, encoding == "cdr" ? "ros2msg" : "ros1msg");
  appendBlock(schema, "");
  std::string channel;
  appendBytes(channel, id);
  appendBytes(channel, static_cast<std::uint16_t>(id + 1));
  appendBlock(channel, message.topic);
  appendBlock(channel, encoding);
  appendBlock(channel, "");
  return mcapRecord(3, schema) + mcapRecord(4, channel);
}

std::string mcapChunk(const std::string& records,
                      double first,
                      double last,
                      const std::string& compression)
{
  std::string content;
  appendBytes(content, nanoseconds(first));
  appendBytes(content, nanoseconds(last));
  appendBytes(content, static_cast<std::uint64_t>(records.size()));
  appendBytes(content, libdeflate_crc32(0, records.data(), records.size()));
  appendBlock(content, compression == "none" ? "" : compression);
  const std::string data = compressed(compression, records);
  appendBytes(content, static_cast<std::uint64_t>(data.size()));
  return mcapRecord(6, content + data);
}

void execute(sqlite3* database, const std::string& sql)
{
  if (sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK)
  {
    throw std::runtime_error(sqlite3_errmsg(database));
  }
}
}  // namespace

void writeRos1Bag(const std::string& path,
                  const std::vector<TestMessage>& messages,
                  const BagStyle& style)
{
  std::map<std::string, std::uint32_t> ids;
  std::string body;
  std::string definitions;
  for (std::size_t begin = 0; begin < messages.size(); begin += style.messages_per_chunk)
  {
    std::string chunk;
    std::map<std::uint32_t, std::pair<std::uint32_t, std::string>> index;
    const std::size_t end = std::min(messages.size(), begin + style.messages_per_chunk);
    for (std::size_t i = begin; i < end; ++i)
    {
      const TestMessage& m = messages[i];
      const auto [id, added] = ids.try_emplace(m.topic, static_cast<std::uint32_t>(ids.size()));
      if (added)
      {
        chunk += connectionRecord(id->second, m);
        definitions += connectionRecord(id->second, m);
      }
      auto& [count, entries] = index[id->second];
      ++count;
      appendTime(entries, m.stamp);
      appendBytes(entries, static_cast<std::uint32_t>(chunk.size()));
      chunk += record(2, number("conn", id->second) + timeField(m.stamp), m.data);
    }
    body += record(5,
                   field("compression", style.compression) +
                       number("size", static_cast<std::uint32_t>(chunk.size())),
                   compressed(style.compression, chunk));
    for (const auto& [id, entries] : index)
    {
      body += style.index ? record(4,
                                   number("ver", std::uint32_t{1}) + number("conn", id) +
                                       number("count", entries.first),
                                   entries.second)
                          : "";
    }
  }
  const std::size_t start = 4096 + 13;
  const std::string fields =
      number("index_pos", style.closed ? std::uint64_t{start + body.size()} : std::uint64_t{0}) +
      number("conn_count", static_cast<std::uint32_t>(ids.size())) +
      number("chunk_count", std::uint32_t{0});
  std::string head = record(3, fields, "");
  head = record(3, fields, std::string(4096 - head.size(), ' '));
  save(path, "#ROSBAG V2.0\n" + head + body + (style.closed ? definitions : ""));
}

void writeMcap(const std::string& path,
               const std::vector<TestMessage>& messages,
               const BagStyle& style,
               const std::string& encoding)
{
  const std::string magic = "\x89MCAP0\r\n";
  std::map<std::string, std::uint16_t> ids;
  std::string definitions;
  std::string text;
  appendBlock(text, "ros2");
  appendBlock(text, "test");
  std::string body = magic + mcapRecord(1, text);
  for (std::size_t begin = 0; begin < messages.size(); begin += style.messages_per_chunk)
  {
    std::string chunk;
    std::map<std::uint16_t, std::string> index;
    const std::size_t end = std::min(messages.size(), begin + style.messages_per_chunk);
    for (std::size_t i = begin; i < end; ++i)
    {
      const TestMessage& m = messages[i];
      const auto [id, added] = ids.try_emplace(m.topic, static_cast<std::uint16_t>(ids.size()));
      if (added)
      {
        chunk += mcapDefinition(id->second, m, encoding);
        definitions += mcapDefinition(id->second, m, encoding);
      }
      appendBytes(index[id->second], nanoseconds(m.stamp));
      appendBytes(index[id->second], static_cast<std::uint64_t>(chunk.size()));
      std::string content;
      appendBytes(content, id->second);
      appendBytes(content, std::uint32_t{0});
      appendBytes(content, nanoseconds(m.stamp));
      appendBytes(content, nanoseconds(m.stamp));
      chunk += mcapRecord(5, content + m.data);
    }
    body += style.chunks ? mcapChunk(chunk, messages[begin].stamp, messages[end - 1].stamp,
                                     style.compression)
                         : chunk;
    for (const auto& [id, entries] : index)
    {
      std::string content;
      appendBytes(content, id);
      appendBlock(content, entries);
      body += style.index && style.chunks ? mcapRecord(7, content) : "";
    }
  }
  if (style.closed)
  {
    body += mcapRecord(15, std::string(4, '\0')) + (style.index ? definitions : "") +
            mcapRecord(2, std::string(20, '\0')) + magic;
  }
  save(path, body);
}

void writeSqliteBag(const std::string& path, const std::vector<TestMessage>& messages, bool packed)
{
  std::filesystem::remove(path);
  sqlite3* database = nullptr;
  sqlite3_open(path.c_str(), &database);
  execute(database,
          "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, "
          "serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);"
          "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp "
          "INTEGER NOT NULL, data BLOB NOT NULL);"
          "CREATE INDEX timestamp_idx ON messages (timestamp ASC); BEGIN");
  std::map<std::string, int> ids;
  for (const TestMessage& m : messages)
  {
    const auto [id, added] = ids.try_emplace(m.topic, static_cast<int>(ids.size()) + 1);
    if (added)
    {
      execute(database, "INSERT INTO topics VALUES(" + std::to_string(id->second) + ",'" + m.topic +
                            "','" + ros2Type(m.type) + "','cdr','')");
    }
    const std::string data = packed ? compressed("zstd", m.data) : m.data;
    sqlite3_stmt* insert = nullptr;
    sqlite3_prepare_v2(database, "INSERT INTO messages(topic_id, timestamp, data) VALUES(?,?,?)",
                       -1, &insert, nullptr);
    sqlite3_bind_int(insert, 1, id->second);
    sqlite3_bind_int64(insert, 2, static_cast<std::int64_t>(nanoseconds(m.stamp)));
    sqlite3_bind_blob(insert, 3, data.data(), static_cast<int>(data.size()), SQLITE_TRANSIENT);
    sqlite3_step(insert);
    sqlite3_finalize(insert);
  }
  execute(database, "COMMIT");
  sqlite3_close(database);
}

bool holdsCdr(const std::string& path)
{
  return std::filesystem::path(path).extension() != ".bag";
}

std::string zstdOf(const std::string& data)
{
  return compressed("zstd", data);
}

void writeBag(const std::string& path, const std::vector<TestMessage>& messages)
{
  const std::string ending = std::filesystem::path(path).extension().string();
  if (ending == ".bag")
  {
    writeRos1Bag(path, messages);
  }
  else if (ending == ".db3")
  {
    writeSqliteBag(path, messages);
  }
  else
  {
    writeMcap(path, messages);
  }
}
}  // namespace dyslam::test
