// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/formats/Bag.h>

#include <fstream>
#include <map>
#include <optional>
#include <set>

#include "BagFormats.h"
#include "ByteReader.h"

namespace dyslam
{
/** Base class of ROS 1 bags and mcap files, which have messages in chunks that may be compressed,
 * an index after each chunk, and definitions of the topics in the chunks and again at the end. */
class ChunkedBag : public Bag
{
 public:
  [[nodiscard]] const std::vector<BagTopic>& topics() const override { return topics_; }
  void select(const std::vector<std::size_t>& topics) override;
  [[nodiscard]] bool next(BagMessage& message) override;
  [[nodiscard]] bool isInOrder(const std::vector<std::size_t>& topics) const override;
  [[nodiscard]] double progress() const override;
  [[nodiscard]] std::vector<std::string> warnings() const override { return warnings_; }

 protected:
  /** A part of the file with messages. */
  struct Chunk
  {
    std::uint64_t offset = 0;  //!< offset of the data, which may be compressed
    std::uint64_t size = 0;
    std::string compression = "none";
    std::uint64_t unpacked = 0;  //!< size of the data without compression; 0: unknown
    std::uint32_t crc = 0;       //!< CRC-32 of the data without compression; 0: unknown
    std::map<std::uint32_t, MessageSpan> index;  //!< messages by connection
  };

  explicit ChunkedBag(const BagFile& file);

  /** One record of a chunk; nothing unless it is a message. Definitions are noted by define(). */
  struct Record
  {
    std::uint32_t connection = 0;
    double stamp = 0;  //!< recording time, UNIX time [s]
    std::string_view data;
  };
  virtual std::optional<Record> readRecord(ByteReader& chunk) = 0;

  /** Notes the topic of a connection (ROS 1) or channel (mcap); once is enough. */
  void define(std::uint32_t connection, const BagTopic& topic);
  void beginChunk(Chunk chunk);
  /** Notes the messages of a connection in the newest chunk. */
  void addIndex(std::uint32_t connection, const MessageSpan& messages);
  /** Counts the messages; chunks without an index are read for this. To be called once, at last. */
  void finishIndex();

  /** Reads `count` bytes from an offset. \throws UserError if the file is shorter. */
  [[nodiscard]] std::string bytesAt(std::uint64_t offset, std::uint64_t count);
  [[nodiscard]] std::uint64_t size() const { return size_; }
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] std::string place(std::uint64_t offset, const char* what = "record") const;
  void warn(const std::string& what) { warnings_.push_back(name_ + ": " + what); }
  /** The file ends too early: the newest chunk's index may lack entries. */
  void warnCutShort(std::uint64_t offset);

 private:
  [[nodiscard]] bool openNextChunk();
  [[nodiscard]] std::string contentOf(const Chunk& chunk);
  void countByReading(Chunk& chunk);
  [[nodiscard]] bool holdsSelected(const Chunk& chunk) const;

  std::string name_;  //!< BagFile::name
  std::ifstream file_;
  std::uint64_t size_ = 0;
  std::vector<BagTopic> topics_;
  std::map<std::uint32_t, std::size_t> topic_of_;  //!< index of the topic by connection
  std::vector<Chunk> chunks_;
  std::set<std::size_t> selected_;
  std::vector<std::string> warnings_;

  std::size_t next_chunk_ = 0;
  std::string content_;  //!< content of the current chunk
  std::optional<ByteReader> reader_;
};
}  // namespace dyslam
