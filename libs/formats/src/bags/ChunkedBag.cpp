// SPDX-License-Identifier: BSD-3-Clause
#include "ChunkedBag.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <libdeflate.h>

#include <algorithm>
#include <filesystem>

#include "Decompression.h"

namespace dyslam
{
ChunkedBag::ChunkedBag(const BagFile& file) : name_(file.name), file_(openBinary(file.path))
{
  size_ = std::filesystem::file_size(file.path);
}

std::string ChunkedBag::place(std::uint64_t offset, const char* what) const
{
  return name_ + ": " + what + " at byte " + std::to_string(offset);
}

std::string ChunkedBag::bytesAt(std::uint64_t offset, std::uint64_t count)
{
  if (offset > size_ || count > size_ - offset)
  {
    throw UserError(place(offset) + ": the file ends before its end");
  }
  std::string bytes(count, '\0');
  file_.clear();
  file_.seekg(static_cast<std::streamoff>(offset));
  file_.read(bytes.data(), static_cast<std::streamsize>(count));
  requireReadable(file_, name_);
  if (static_cast<std::uint64_t>(file_.gcount()) != count)
  {
    throw UserError(place(offset) + ": cannot be read");
  }
  return bytes;
}

void ChunkedBag::define(std::uint32_t connection, const BagTopic& topic)
{
  if (topic_of_.count(connection) > 0)
  {
    return;
  }
  const auto found =
      std::find_if(topics_.begin(), topics_.end(),
                   [&topic](const BagTopic& other) { return isSameTopic(topic, other); });
  topic_of_[connection] = static_cast<std::size_t>(found - topics_.begin());
  if (found == topics_.end())
  {
    topics_.push_back(topic);
  }
}

void ChunkedBag::beginChunk(Chunk chunk)
{
  chunks_.push_back(std::move(chunk));
}

void ChunkedBag::addIndex(std::uint32_t connection, const MessageSpan& messages)
{
  if (!chunks_.empty() && messages.messages > 0)
  {
    chunks_.back().index[connection] = messages;
  }
}

void ChunkedBag::warnCutShort(std::uint64_t offset)
{
  warn("is cut short at byte " + std::to_string(offset) + "; what is whole is read");
  if (!chunks_.empty())
  {
    chunks_.back().index.clear();
  }
}

void ChunkedBag::finishIndex()
{
  for (Chunk& chunk : chunks_)
  {
    const auto known = [this](const auto& entry) { return topic_of_.count(entry.first) > 0; };
    if (chunk.index.empty() || !std::all_of(chunk.index.begin(), chunk.index.end(), known))
    {
      countByReading(chunk);
    }
  }
  for (const Chunk& chunk : chunks_)
  {
    for (const auto& [connection, span] : chunk.index)
    {
      addMessages(span, topics_[topic_of_.at(connection)]);
    }
  }
  select({});
}

void ChunkedBag::countByReading(Chunk& chunk)
{
  const std::string content = contentOf(chunk);
  ByteReader reader(content, place(chunk.offset, "chunk"));
  chunk.index.clear();
  while (reader.left() > 0)
  {
    const auto record = readRecord(reader);
    if (!record || topic_of_.count(record->connection) == 0)
    {
      continue;
    }
    chunk.index[record->connection].add(record->stamp);
  }
}

std::string ChunkedBag::contentOf(const Chunk& chunk)
{
  std::string content = decompressed(chunk.compression, bytesAt(chunk.offset, chunk.size),
                                     chunk.unpacked, place(chunk.offset, "chunk"));
  if (chunk.crc != 0 && libdeflate_crc32(0, content.data(), content.size()) != chunk.crc)
  {
    throw UserError(place(chunk.offset, "chunk") + ": damaged: its checksum is another");
  }
  return content;
}

void ChunkedBag::select(const std::vector<std::size_t>& topics)
{
  selected_ = {topics.begin(), topics.end()};
  next_chunk_ = 0;
  reader_.reset();
}

bool ChunkedBag::isInOrder(const std::vector<std::size_t>& topics) const
{
  constexpr double tolerance = 1;         // [s], of messages on their way to the recorder
  std::map<std::size_t, double> last_of;  // by topic [s]
  double last = 0;                        // of the chunks before [s]
  bool in_order = true;
  for (const Chunk& chunk : chunks_)
  {
    double last_of_chunk = last;
    for (const auto& [connection, span] : chunk.index)
    {
      const std::size_t topic = topic_of_.at(connection);
      if (std::find(topics.begin(), topics.end(), topic) == topics.end())
      {
        continue;
      }
      double& own_last = last_of[topic];
      if (span.first < own_last - tolerance)
      {
        return true;  // the recorder's clock was set, and times do not tell the order
      }
      own_last = std::max(own_last, span.last);
      in_order = in_order && span.first >= last - tolerance;
      last_of_chunk = std::max(last_of_chunk, span.last);
    }
    last = last_of_chunk;
  }
  return in_order;
}

bool ChunkedBag::holdsSelected(const Chunk& chunk) const
{
  return std::any_of(chunk.index.begin(), chunk.index.end(),
                     [this](const auto& entry)
                     { return selected_.count(topic_of_.at(entry.first)) > 0; });
}

bool ChunkedBag::openNextChunk()
{
  while (next_chunk_ < chunks_.size())
  {
    const Chunk& chunk = chunks_[next_chunk_++];
    if (holdsSelected(chunk))
    {
      content_ = contentOf(chunk);
      reader_.emplace(content_, place(chunk.offset, "chunk"));
      return true;
    }
  }
  return false;
}

bool ChunkedBag::next(BagMessage& message)
{
  while (true)
  {
    while (!reader_ || reader_->left() == 0)
    {
      if (!openNextChunk())
      {
        return false;
      }
    }
    const std::size_t at = reader_->at();
    const auto record = readRecord(*reader_);
    const auto topic = record ? topic_of_.find(record->connection) : topic_of_.end();
    if (topic == topic_of_.end() || selected_.count(topic->second) == 0)
    {
      continue;
    }
    message.topic = topic->second;
    message.recorded = record->stamp;
    message.data = record->data;
    const Chunk& chunk = chunks_[next_chunk_ - 1];
    const bool plain = chunk.compression.empty() || chunk.compression == "none";
    message.place = plain ? place(chunk.offset + at, "message")
                          : reader_->place() + ": message at its byte " + std::to_string(at);
    return true;
  }
}

double ChunkedBag::progress() const
{
  if (chunks_.empty())
  {
    return 1;
  }
  const double left = reader_ && !content_.empty() ? static_cast<double>(reader_->left()) /
                                                         static_cast<double>(content_.size())
                                                   : 0;
  return (static_cast<double>(next_chunk_) - left) / static_cast<double>(chunks_.size());
}
}  // namespace dyslam
