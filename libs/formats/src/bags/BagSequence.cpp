// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Printable.h>
#include <dyslam/formats/RecordingKind.h>

#include <algorithm>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "BagFormats.h"
#include "UnpackedBag.h"

namespace dyslam
{
namespace
{
std::unique_ptr<Bag> openFile(const BagFile& file)
{
  if (isPackedBag(file.path))
  {
    throw UserError(file.name + ": is compressed as a whole; unpack it first: " +
                    unpackCommand(file.path) + " " + shellWord(file.name));
  }
  const std::string ending = bagEnding(file.path);
  return ending == ".bag"   ? openRos1Bag(file)
         : ending == ".db3" ? openSqliteBag(file)
                            : openMcap(file);
}

/** The files of one recording: those with the same topics behind each other, in their order, and
 * those with different ones side by side, by the times of recording. So are the topics of a file
 * that has them behind each other. */
class BagSequence : public Bag
{
 public:
  BagSequence(const std::vector<std::string>& paths, const BagUnpackingProgress& unpacking)
  {
    requireRoomToUnpack(paths);
    for (const std::string& path : paths)
    {
      File file;
      file.source = {path, path};
      if (isZstdBag(path))
      {
        file.unpacked = std::make_unique<UnpackedBag>(path, unpacking);
        file.source.path = file.unpacked->path();
      }
      file.bag = openFile(file.source);
      const std::vector<BagTopic>& own = file.bag->topics();
      const auto overlapping = std::find_if(
          own.begin(), own.end(), [this](const BagTopic& topic) { return overlaps(topic); });
      if (overlapping != own.end())
      {
        warnings_.push_back(path + ": its messages of " + overlapping->name +
                            " begin before those of the parts before it end; if the folder holds "
                            "several recordings, give each of them by itself");
      }
      for (const BagTopic& topic : own)
      {
        file.common.push_back(include(topic));
      }
      files_.push_back(std::move(file));
    }
  }

  [[nodiscard]] const std::vector<BagTopic>& topics() const override { return topics_; }

  void select(const std::vector<std::size_t>& topics) override
  {
    taken_.reset();
    streams_.clear();
    for (const File& file : files_)
    {
      constexpr std::size_t most_topics = 16;  // the file is opened for each
      const std::vector<std::size_t> own = selectedIn(file, topics);
      if (own.size() < 2 || own.size() > most_topics || file.bag->isInOrder(own))
      {
        addStream(file, nullptr, own);
        continue;
      }
      for (const std::size_t topic : own)
      {
        addStream(file, openFile(file.source), {topic});
      }
    }
  }

  [[nodiscard]] bool next(BagMessage& message) override
  {
    if (taken_)  // its message was valid until now
    {
      const std::size_t moved = *taken_;
      taken_.reset();
      advance(streams_[moved]);
    }
    for (auto earliest = earliestStream(); earliest; earliest = earliestStream())
    {
      Stream& stream = streams_[*earliest];
      if (stream.message)
      {
        message = *stream.message;
        taken_ = earliest;
        return true;
      }
      advance(stream);
    }
    return false;
  }

  [[nodiscard]] double progress() const override
  {
    double sum = 0;
    for (const Stream& stream : streams_)
    {
      sum += stream.has_ended ? 1 : stream.bag->progress();
    }
    return streams_.empty() ? 1 : sum / static_cast<double>(streams_.size());
  }

  [[nodiscard]] std::vector<std::string> warnings() const override
  {
    std::vector<std::string> all = warnings_;
    for (const File& file : files_)
    {
      const auto own = file.bag->warnings();
      all.insert(all.end(), own.begin(), own.end());
    }
    return all;
  }

 private:
  struct File
  {
    BagFile source;
    std::unique_ptr<UnpackedBag> unpacked;
    std::unique_ptr<Bag> bag;
    std::vector<std::size_t> common;  //!< positions in topics_, by its own topic
  };

  /** Messages that are read in the order of a file. */
  struct Stream
  {
    Bag* bag = nullptr;
    std::unique_ptr<Bag> opened;         //!< the same, if it is only for this stream
    std::vector<std::size_t> common;     //!< File::common
    std::set<std::size_t> topics;        //!< positions in topics_
    std::vector<std::size_t> followers;  //!< later streams with one of these topics
    std::size_t awaited = 0;             //!< number of earlier ones that have not ended
    double begin = 0;                    //!< time of the first message, UNIX time [s]
    std::optional<BagMessage> message;   //!< the next one; nothing before the first was read
    bool has_ended = false;

    /** Time of the next message, UNIX time [s] */
    [[nodiscard]] double time() const { return message ? message->recorded : begin; }
  };

  /** \return position among the topics of all files so far; their number if it is new. */
  [[nodiscard]] std::size_t positionOf(const BagTopic& topic) const
  {
    const auto found =
        std::find_if(topics_.begin(), topics_.end(),
                     [&topic](const BagTopic& other) { return isSameTopic(topic, other); });
    return static_cast<std::size_t>(found - topics_.begin());
  }

  /** Whether a file's topic begins before that of the files so far ends. */
  [[nodiscard]] bool overlaps(const BagTopic& topic) const
  {
    constexpr double tolerance = 1;  // [s], of messages on their way to the recorder
    const std::size_t at = positionOf(topic);
    return at < topics_.size() && topic.messages > 0 && topic.first < topics_[at].last - tolerance;
  }

  /** \return the topic's position among those of all files. */
  std::size_t include(const BagTopic& topic)
  {
    const std::size_t at = positionOf(topic);
    if (at == topics_.size())
    {
      topics_.push_back(topic);
    }
    else
    {
      addMessages(MessageSpan{topic.messages, topic.first, topic.last}, topics_[at]);
    }
    return at;
  }

  /** The file's topics that are selected and have messages. */
  static std::vector<std::size_t> selectedIn(const File& file,
                                             const std::vector<std::size_t>& topics)
  {
    std::vector<std::size_t> own;
    for (std::size_t i = 0; i < file.common.size(); ++i)
    {
      if (file.bag->topics()[i].messages > 0 &&
          std::find(topics.begin(), topics.end(), file.common[i]) != topics.end())
      {
        own.push_back(i);
      }
    }
    return own;
  }

  /** \param opened the file once more; null: the file itself \param own topics of the file */
  void addStream(const File& file, std::unique_ptr<Bag> opened, const std::vector<std::size_t>& own)
  {
    if (own.empty())
    {
      return;
    }
    Stream stream;
    stream.bag = opened != nullptr ? opened.get() : file.bag.get();
    stream.opened = std::move(opened);
    stream.common = file.common;
    MessageSpan span;
    for (const std::size_t i : own)
    {
      const BagTopic& topic = file.bag->topics()[i];
      stream.topics.insert(file.common[i]);
      span.add(MessageSpan{topic.messages, topic.first, topic.last});
    }
    stream.begin = span.first;
    stream.bag->select(own);
    for (Stream& before : streams_)
    {
      const bool alike =
          std::any_of(stream.topics.begin(), stream.topics.end(),
                      [&before](std::size_t topic) { return before.topics.count(topic) > 0; });
      if (alike)
      {
        before.followers.push_back(streams_.size());
        ++stream.awaited;
      }
    }
    streams_.push_back(std::move(stream));
  }

  /** The stream with the next message; nothing at the end of all. */
  [[nodiscard]] std::optional<std::size_t> earliestStream() const
  {
    std::optional<std::size_t> earliest;
    for (std::size_t i = 0; i < streams_.size(); ++i)
    {
      const Stream& stream = streams_[i];
      if (!stream.has_ended && stream.awaited == 0 &&
          (!earliest || stream.time() < streams_[*earliest].time()))
      {
        earliest = i;
      }
    }
    return earliest;
  }

  void advance(Stream& stream)
  {
    stream.message.reset();
    BagMessage message;
    if (stream.bag->next(message))
    {
      message.topic = stream.common[message.topic];
      stream.message = std::move(message);
      return;
    }
    stream.has_ended = true;
    for (const std::size_t follower : stream.followers)
    {
      --streams_[follower].awaited;
    }
  }

  std::vector<File> files_;
  std::vector<BagTopic> topics_;
  std::vector<std::string> warnings_;
  std::vector<Stream> streams_;       //!< of the selected topics
  std::optional<std::size_t> taken_;  //!< stream whose message was passed on last
};
}  // namespace

std::unique_ptr<Bag> openParts(const std::vector<std::string>& paths,
                               const BagUnpackingProgress& unpacking)
{
  return std::make_unique<BagSequence>(paths, unpacking);
}
}  // namespace dyslam
