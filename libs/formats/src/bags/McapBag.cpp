// SPDX-License-Identifier: BSD-3-Clause
#include "ChunkedBag.h"
#include "McapFormat.h"

namespace dyslam
{
namespace
{
constexpr std::uint64_t record_head = 9;          // opcode, length
constexpr std::uint64_t largest_run = 4U << 20U;  // of messages outside of chunks [bytes]

class McapBag : public ChunkedBag
{
 public:
  explicit McapBag(const BagFile& file) : ChunkedBag(file)
  {
    if (bytesAt(0, std::min<std::uint64_t>(size(), mcap_magic.size())) != mcap_magic)
    {
      throw UserError(name() + ": is not an mcap file (its first bytes are not those of one)");
    }
    std::uint64_t at = mcap_magic.size();
    bool whole = false;
    while (!whole && size() - at >= record_head)
    {
      const std::string head = bytesAt(at, record_head);
      ByteReader reader(head, place(at));
      const auto op = static_cast<McapOp>(reader.u8());
      const std::uint64_t length = reader.u64();
      if (length > size() - at - record_head)
      {
        break;
      }
      readTopLevel(op, at, length);
      whole = op == McapOp::footer;
      at += record_head + length;
    }
    endRun();
    if (!whole)
    {
      warnCutShort(at);
    }
    finishIndex();
  }

 protected:
  std::optional<Record> readRecord(ByteReader& chunk) override
  {
    const auto op = static_cast<McapOp>(chunk.u8());
    const std::string_view content = chunk.take(chunk.u64());
    if (op == McapOp::schema || op == McapOp::channel)
    {
      defineBy(op, content, chunk.place());
    }
    if (op != McapOp::message)
    {
      return std::nullopt;
    }
    ByteReader reader(content, chunk.place());
    Record record;
    record.connection = reader.u16();
    (void)reader.u32();  // sequence
    record.stamp = secondsOfNanoseconds(reader.u64());
    (void)reader.u64();  // published
    record.data = reader.take(reader.left());
    return record;
  }

 private:
  void readTopLevel(McapOp op, std::uint64_t at, std::uint64_t length)
  {
    const std::uint64_t content = at + record_head;
    if (op == McapOp::message)
    {
      if (run_.size > 0 && run_.size + record_head + length > largest_run)
      {
        endRun();
      }
      run_.offset = run_.size == 0 ? at : run_.offset;
      run_.size += record_head + length;
      return;
    }
    endRun();
    if (op == McapOp::schema || op == McapOp::channel)
    {
      defineBy(op, bytesAt(content, length), place(at));
    }
    else if (op == McapOp::chunk)
    {
      readChunk(at, length);
    }
    else if (op == McapOp::message_index)
    {
      readIndex(bytesAt(content, length), place(at));
    }
  }

  /** Messages outside of chunks are read as chunks without compression. */
  void endRun()
  {
    if (run_.size > 0)
    {
      beginChunk(run_);
    }
    run_ = Chunk();
  }

  void readChunk(std::uint64_t at, std::uint64_t length)
  {
    constexpr std::uint64_t longest_head = 256;  // five numbers and the name of a compression
    const std::string head = bytesAt(at + record_head, std::min(length, longest_head));
    ByteReader reader(head, place(at, "chunk"));
    (void)reader.u64();  // first time
    (void)reader.u64();  // last time
    Chunk chunk;
    chunk.unpacked = reader.u64();
    chunk.crc = reader.u32();
    chunk.compression = reader.block();
    chunk.size = reader.u64();
    chunk.offset = at + record_head + reader.at();
    if (chunk.size != length - reader.at())
    {
      reader.fail("damaged: its length and that of its data do not agree");
    }
    beginChunk(chunk);
  }

  void readIndex(const std::string& content, const std::string& where)
  {
    ByteReader reader(content, where);
    const std::uint32_t connection = reader.u16();
    ByteReader entries(reader.block(), where);
    MessageSpan span;
    while (entries.left() > 0)
    {
      span.add(secondsOfNanoseconds(entries.u64()));
      (void)entries.u64();  // offset in the chunk
    }
    addIndex(connection, span);
  }

  void defineBy(McapOp op, std::string_view content, const std::string& where)
  {
    ByteReader reader(content, where);
    const std::uint32_t id = reader.u16();
    if (op == McapOp::schema)
    {
      types_[id] = plainRosType(std::string(reader.block()));
      return;
    }
    const auto type = types_.find(reader.u16());
    BagTopic topic;
    topic.name = reader.block();
    topic.type = type == types_.end() ? "" : type->second;
    const std::string_view encoding = reader.block();
    topic.encoding = encoding == "cdr"    ? RosEncoding::cdr
                     : encoding == "ros1" ? RosEncoding::ros1
                                          : RosEncoding::other;
    define(id, topic);
  }

  Chunk run_;
  std::map<std::uint32_t, std::string> types_;  //!< by number of the schema
};
}  // namespace

std::unique_ptr<Bag> openMcap(const BagFile& file)
{
  return std::make_unique<McapBag>(file);
}
}  // namespace dyslam
