// SPDX-License-Identifier: BSD-3-Clause
#include "ChunkedBag.h"

namespace dyslam
{
namespace
{
constexpr std::string_view ros1_magic = "#ROSBAG V2.0\n";

enum Ros1Op : std::uint8_t
{
  message_record = 0x02,
  bag_header = 0x03,
  index_data = 0x04,
  chunk_record = 0x05,
  connection = 0x07,
};

/** The fields `name=value` that open every record. */
class Fields
{
 public:
  Fields(std::string_view bytes, const std::string& place) : reader_(bytes, place)
  {
    while (reader_.left() > 0)
    {
      const std::string_view field = reader_.block();
      const auto equals = field.find('=');
      if (equals == std::string_view::npos)
      {
        reader_.fail("damaged: a field of the record's header has no name");
      }
      values_[std::string(field.substr(0, equals))] = field.substr(equals + 1);
    }
  }

  template <typename T>
  [[nodiscard]] T number(const char* name) const
  {
    ByteReader value(text(name), reader_.place() + ", field " + name);
    return value.number<T>();
  }
  [[nodiscard]] double time(const char* name) const
  {
    ByteReader value(text(name), reader_.place() + ", field " + name);
    return value.rosTime();
  }
  [[nodiscard]] std::string_view text(const char* name) const
  {
    const auto found = values_.find(name);
    if (found == values_.end())
    {
      reader_.fail(std::string("damaged: the record's header has no ") + name);
    }
    return found->second;
  }
  [[nodiscard]] bool has(const char* name) const { return values_.count(name) > 0; }

 private:
  ByteReader reader_;
  std::map<std::string, std::string_view, std::less<>> values_;
};

class Ros1Bag : public ChunkedBag
{
 public:
  explicit Ros1Bag(const BagFile& file) : ChunkedBag(file)
  {
    const std::string start = bytesAt(0, std::min<std::uint64_t>(size(), ros1_magic.size()));
    if (start != ros1_magic)
    {
      throw UserError(name() +
                      (start.rfind("#ROSBAG V1", 0) == 0
                           ? ": is a bag of version 1; convert it with 'rosbag migrate'"
                           : ": is not a ROS 1 bag (it does not begin with #ROSBAG V2.0)"));
    }
    try
    {
      for (std::uint64_t at = ros1_magic.size(); at < size();)
      {
        at = readTopLevel(at);
      }
    }
    catch (const CutShort& end)
    {
      warnCutShort(end.offset);
    }
    finishIndex();
  }

 protected:
  std::optional<Record> readRecord(ByteReader& chunk) override
  {
    const std::string where = chunk.place() + ", byte " + std::to_string(chunk.at());
    const Fields fields(chunk.block(), where);
    const std::string_view data = chunk.block();
    const auto op = fields.number<std::uint8_t>("op");
    if (op == connection)
    {
      defineBy(fields, data, chunk.place());
    }
    if (op != message_record)
    {
      return std::nullopt;
    }
    return Record{fields.number<std::uint32_t>("conn"), fields.time("time"), data};
  }

 private:
  struct CutShort
  {
    std::uint64_t offset;
  };

  [[nodiscard]] std::uint32_t lengthAt(std::uint64_t at, std::uint64_t record)
  {
    if (size() - at < 4)
    {
      throw CutShort{record};
    }
    const std::string bytes = bytesAt(at, 4);
    ByteReader reader(bytes, place(at));
    const std::uint32_t length = reader.u32();
    if (length > size() - at - 4)
    {
      throw CutShort{record};
    }
    return length;
  }

  /** \return where the next record begins. */
  std::uint64_t readTopLevel(std::uint64_t at)
  {
    const std::uint32_t header_size = lengthAt(at, at);
    const std::string header = bytesAt(at + 4, header_size);
    const Fields fields(header, place(at));
    const std::uint64_t data_at = at + 8 + header_size;
    const std::uint32_t data_size = lengthAt(data_at - 4, at);
    switch (fields.number<std::uint8_t>("op"))
    {
      case bag_header:
        if (fields.has("encryptor") && !fields.text("encryptor").empty())
        {
          throw UserError(name() +
                          ": is encrypted; rewrite it without encryption, with ROS's rosbag");
        }
        if (fields.number<std::uint64_t>("index_pos") == 0)
        {
          warn("was not closed by its recorder; what is whole is read");
        }
        break;
      case chunk_record:
      {
        if (data_size == 0)
        {
          break;  // begun by a recorder that was killed; its sizes were to follow
        }
        Chunk chunk;
        chunk.offset = data_at;
        chunk.size = data_size;
        chunk.compression = fields.text("compression");
        chunk.unpacked = fields.number<std::uint32_t>("size");
        beginChunk(chunk);
        break;
      }
      case index_data:
        readIndex(fields, bytesAt(data_at, data_size), place(data_at));
        break;
      case connection:
        defineBy(fields, bytesAt(data_at, data_size), place(data_at));
        break;
      default:
        break;
    }
    return data_at + data_size;
  }

  void readIndex(const Fields& fields, const std::string& data, const std::string& where)
  {
    constexpr std::size_t entry = 12;  // time, offset in the chunk
    const std::size_t count = data.size() / entry;
    if (fields.number<std::uint32_t>("count") != count)
    {
      throw UserError(where + ": damaged: the index announces another count than it has");
    }
    MessageSpan span;
    ByteReader reader(data, where);
    for (std::size_t i = 0; i < count; ++i)
    {
      span.add(reader.rosTime());
      (void)reader.u32();  // offset in the chunk
    }
    addIndex(fields.number<std::uint32_t>("conn"), span);
  }

  void defineBy(const Fields& fields, std::string_view data, const std::string& where)
  {
    const Fields definition(data, where);
    BagTopic topic;
    topic.name = fields.text("topic");
    topic.type = definition.text("type");
    topic.encoding = RosEncoding::ros1;
    define(fields.number<std::uint32_t>("conn"), topic);
  }
};
}  // namespace

std::unique_ptr<Bag> openRos1Bag(const BagFile& file)
{
  return std::make_unique<Ros1Bag>(file);
}
}  // namespace dyslam
