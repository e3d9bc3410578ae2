// SPDX-License-Identifier: BSD-3-Clause
#include "BagWriters.h"

#include <bzlib.h>
#include <libdeflate.h>
#include <lz4frame.h>
#include <sqlite3.h>
#include <zstd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <stdexcept>

namespace dyslam::test
{
namespace
{
template <typename T>
void append(std::string& bytes, T value)
{
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

void appendBlock(std::string& bytes, const std::string& block)
{
  append(bytes, static_cast<std::uint32_t>(block.size()));
  bytes += block;
}

std::uint64_t nanoseconds(double stamp)
{
  const double whole = std::floor(stamp);
  return static_cast<std::uint64_t>(whole) * 1000000000U +
         static_cast<std::uint64_t>(std::llround((stamp - whole) * 1e9));
}

void appendTime(std::string& bytes, double stamp)
{
  append(bytes, static_cast<std::uint32_t>(nanoseconds(stamp) / 1000000000U));
  append(bytes, static_cast<std::uint32_t>(nanoseconds(stamp) % 1000000000U));
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

void putPose(MessageBytes& message, const Pose& pose)
{
  const Eigen::Quaterniond q(pose.rotation());
  for (const double value : {pose.translation().x(), pose.translation().y(), pose.translation().z(),
                             q.x(), q.y(), q.z(), q.w()})
  {
    message.put(value);
  }
}

void putVector(MessageBytes& message, const Eigen::Vector3d& vector)
{
  message.put(vector.x()).put(vector.y()).put(vector.z());
}

/** `count` numbers, all zero but the first. */
void putCovariance(MessageBytes& message, double first, int count)
{
  for (int i = 0; i < count; ++i)
  {
    message.put(i == 0 ? first : 0.0);
  }
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
  append(bytes, value);
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
  append(bytes, static_cast<std::uint64_t>(content.size()));
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
  append(schema, static_cast<std::uint16_t>(id + 1));
  appendBlock(schema, encoding == "cdr" ? ros2Type(message.type) : message.type);
  appendBlock(schema, encoding == "cdr" ? "ros2msg" : "ros1msg");
  appendBlock(schema, "");
  std::string channel;
  append(channel, id);
  append(channel, static_cast<std::uint16_t>(id + 1));
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
  append(content, nanoseconds(first));
  append(content, nanoseconds(last));
  append(content, static_cast<std::uint64_t>(records.size()));
  append(content, libdeflate_crc32(0, records.data(), records.size()));
  appendBlock(content, compression == "none" ? "" : compression);
  const std::string data = compressed(compression, records);
  append(content, static_cast<std::uint64_t>(data.size()));
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

MessageBytes& MessageBytes::text(const std::string& value)
{
  return block(cdr_ ? value + '\0' : value);
}

MessageBytes& MessageBytes::block(const std::string& value)
{
  put(static_cast<std::uint32_t>(value.size()));
  bytes_ += value;
  return *this;
}

MessageBytes& MessageBytes::header(double stamp, const std::string& frame)
{
  if (!cdr_)
  {
    put(std::uint32_t{7});
  }
  put(static_cast<std::uint32_t>(nanoseconds(stamp) / 1000000000U));
  put(static_cast<std::uint32_t>(nanoseconds(stamp) % 1000000000U));
  return text(frame);
}

std::string pointCloud2(bool cdr,
                        double stamp,
                        const std::vector<CloudField>& fields,
                        std::uint32_t rows,
                        const std::string& frame)
{
  const auto sizeOf = [](std::uint8_t type) -> std::uint32_t {
    return type == 2 ? 1 : type == 4 ? 2 : type == 8 ? 8 : 4;
  };
  MessageBytes message(cdr);
  const auto points = static_cast<std::uint32_t>(fields.front().values.size());
  message.header(stamp, frame).put(rows).put(points / rows);
  message.put(static_cast<std::uint32_t>(fields.size()));
  std::uint32_t step = 3;  // drivers leave gaps, too
  std::vector<std::uint32_t> offsets;
  for (const CloudField& f : fields)
  {
    offsets.push_back(step);
    message.text(f.name).put(step).put(f.type).put(std::uint32_t{1});
    step += sizeOf(f.type);
  }
  std::string data(static_cast<std::size_t>(points) * step, '\0');
  for (std::size_t i = 0; i < fields.size(); ++i)
  {
    for (std::size_t j = 0; j < points; ++j)
    {
      std::string value;
      const double v = fields[i].values[j];
      switch (fields[i].type)
      {
        case 2:
          append(value, static_cast<std::uint8_t>(v));
          break;
        case 4:
          append(value, static_cast<std::uint16_t>(v));
          break;
        case 6:
          append(value, static_cast<std::uint32_t>(v));
          break;
        case 7:
          append(value, static_cast<float>(v));
          break;
        default:
          append(value, v);
      }
      data.replace(j * step + offsets[i], value.size(), value);
    }
  }
  message.put(std::uint8_t{0}).put(step).put(step * (points / rows)).block(data);
  return message.put(std::uint8_t{1}).bytes();
}

std::vector<CloudField> velodyneFields(const Scan& scan)
{
  std::vector<CloudField> fields{{"x", 7, {}},         {"y", 7, {}},    {"z", 7, {}},
                                 {"intensity", 7, {}}, {"ring", 4, {}}, {"time", 7, {}}};
  for (std::size_t i = 0; i < scan.size(); ++i)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      fields[static_cast<std::size_t>(axis)].values.push_back(scan.points[i][axis]);
    }
    fields[3].values.push_back(scan.intensity[i]);
    fields[4].values.push_back(scan.ring[i]);
    fields[5].values.push_back(scan.time[i]);
  }
  return fields;
}

std::string velodyneScan(bool cdr,
                         double stamp,
                         const std::vector<std::pair<double, std::string>>& packets)
{
  MessageBytes message(cdr);
  message.header(stamp, "velodyne").put(static_cast<std::uint32_t>(packets.size()));
  for (const auto& [received, bytes] : packets)
  {
    message.put(static_cast<std::uint32_t>(nanoseconds(received) / 1000000000U));
    message.put(static_cast<std::uint32_t>(nanoseconds(received) % 1000000000U));
    for (const char byte : bytes)
    {
      message.put(byte);
    }
  }
  return message.bytes();
}

std::string hesaiMessage(bool cdr,
                         double stamp,
                         const std::vector<std::pair<double, std::string>>& packets,
                         HesaiMessage kind)
{
  constexpr std::size_t room = 1500;
  MessageBytes message(cdr);
  message.header(stamp, "hesai").put(static_cast<std::uint32_t>(packets.size()));
  for (const auto& [received, bytes] : packets)
  {
    const bool has_stamp = kind != HesaiMessage::udp_frame || received == packets.front().first;
    const std::uint64_t time = has_stamp ? nanoseconds(received) : 0;
    message.put(static_cast<std::uint32_t>(time / 1000000000U));
    message.put(static_cast<std::uint32_t>(time % 1000000000U));
    if (kind != HesaiMessage::pandar_scan)
    {
      message.block(bytes);
    }
    else
    {
      for (const char byte : bytes + std::string(room - bytes.size(), '\0'))
      {
        message.put(byte);
      }
    }
    if (kind != HesaiMessage::nebula_packets)
    {
      message.put(static_cast<std::uint32_t>(bytes.size()));
    }
  }
  return message.bytes();
}

std::string ousterPacketMessage(bool cdr, const std::string& packet)
{
  return MessageBytes(cdr).block(packet).bytes();
}

std::string stringMessage(bool cdr, const std::string& text)
{
  return MessageBytes(cdr).text(text).bytes();
}

std::string poseStamped(bool cdr, double stamp, const Pose& pose)
{
  MessageBytes message(cdr);
  message.header(stamp, "map");
  putPose(message, pose);
  return message.bytes();
}

std::string odometry(bool cdr,
                     double stamp,
                     const Pose& pose,
                     const Eigen::Vector3d& linear,
                     const Eigen::Vector3d& angular)
{
  MessageBytes message(cdr);
  message.header(stamp, "odom").text("base_link");
  putPose(message, pose);
  putCovariance(message, 0, 36);
  putVector(message, linear);
  putVector(message, angular);
  putCovariance(message, 0, 36);
  return message.bytes();
}

std::string twistStamped(bool cdr,
                         double stamp,
                         const Eigen::Vector3d& linear,
                         const Eigen::Vector3d& angular,
                         bool with_covariance)
{
  MessageBytes message(cdr);
  message.header(stamp, "base_link");
  putVector(message, linear);
  putVector(message, angular);
  putCovariance(message, 0.1, with_covariance ? 36 : 0);
  return message.bytes();
}

std::string imu(bool cdr, double stamp, const ImuValues& values)
{
  MessageBytes message(cdr);
  message.header(stamp, values.frame);
  for (const double value : {0.0, 0.0, 0.0, 1.0})
  {
    message.put(value);
  }
  putCovariance(message, -1, 9);
  putVector(message, values.angular_velocity);
  putCovariance(message, values.angular_velocity_variance, 9);
  putVector(message, values.acceleration);
  putCovariance(message, values.acceleration_variance, 9);
  return message.bytes();
}

std::string navSatFix(bool cdr, double stamp, const FixValues& values)
{
  MessageBytes message(cdr);
  message.header(stamp, values.frame);
  message.put(static_cast<std::int8_t>(values.status));
  message.put(static_cast<std::uint16_t>(1));
  message.put(values.latitude).put(values.longitude).put(values.altitude);
  for (int i = 0; i < 9; ++i)
  {
    message.put(i % 4 != 0 ? 0.0 : (i == 8 ? 4 : 1) * values.variance);
  }
  message.put(static_cast<std::uint8_t>(values.variance > 0 ? 2 : 0));
  return message.bytes();
}

std::string transforms(bool cdr,
                       double stamp,
                       const std::vector<std::pair<std::string, Pose>>& children)
{
  MessageBytes message(cdr);
  message.put(static_cast<std::uint32_t>(children.size()));
  for (const auto& [child, pose] : children)
  {
    message.header(stamp, "map").text(child);
    putPose(message, pose);
  }
  return message.bytes();
}

std::string livoxMessage(bool cdr, const Scan& scan)
{
  MessageBytes message(cdr);
  const auto count = static_cast<std::uint32_t>(scan.size());
  message.header(scan.stamp, "livox").put(nanoseconds(scan.stamp)).put(count);
  message.put(std::uint8_t{1}).put(std::uint8_t{0}).put(std::uint8_t{0}).put(std::uint8_t{0});
  message.put(count);
  for (std::size_t i = 0; i < scan.size(); ++i)
  {
    message.put(static_cast<std::uint32_t>(std::lround(scan.time[i] * 1e9)));
    message.put(scan.points[i].x()).put(scan.points[i].y()).put(scan.points[i].z());
    message.put(static_cast<std::uint8_t>(scan.intensity[i])).put(std::uint8_t{16});
    message.put(static_cast<std::uint8_t>(scan.ring[i]));
  }
  return message.bytes();
}

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
      append(entries, static_cast<std::uint32_t>(chunk.size()));
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
      append(index[id->second], nanoseconds(m.stamp));
      append(index[id->second], static_cast<std::uint64_t>(chunk.size()));
      std::string content;
      append(content, id->second);
      append(content, std::uint32_t{0});
      append(content, nanoseconds(m.stamp));
      append(content, nanoseconds(m.stamp));
      chunk += mcapRecord(5, content + m.data);
    }
    body += style.chunks ? mcapChunk(chunk, messages[begin].stamp, messages[end - 1].stamp,
                                     style.compression)
                         : chunk;
    for (const auto& [id, entries] : index)
    {
      std::string content;
      append(content, id);
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
