// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/formats/Bag.h>
#include <dyslam/formats/RecordingKind.h>
#include <dyslam/formats/RosMessages.h>
#include <dyslam/formats/RosPackets.h>
#include <dyslam/formats/ScanFiles.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <set>
#include <utility>

#include "BagFormats.h"

namespace dyslam
{
namespace fs = std::filesystem;

namespace
{
/** The parts of one recording: those with the same topics behind each other, in their order, those
 * with different ones side by side, by the times of recording. */
class BagSequence : public Bag
{
 public:
  explicit BagSequence(const std::vector<std::string>& paths)
  {
    for (const std::string& path : paths)
    {
      Part part;
      part.bag = openBag(path);
      const std::vector<BagTopic>& own = part.bag->topics();
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
        part.common.push_back(include(topic));
      }
      parts_.push_back(std::move(part));
    }
  }

  [[nodiscard]] const std::vector<BagTopic>& topics() const override { return topics_; }

  void select(const std::vector<std::size_t>& topics) override
  {
    std::vector<std::set<std::size_t>> selected;  // by part, of those with messages
    taken_ = nullptr;
    for (std::size_t i = 0; i < parts_.size(); ++i)
    {
      selected.push_back(selectIn(parts_[i], topics));
      for (std::size_t before = 0; before < i; ++before)
      {
        const bool alike = std::any_of(selected[i].begin(), selected[i].end(),
                                       [&others = selected[before]](std::size_t topic)
                                       { return others.count(topic) > 0; });
        if (alike)
        {
          parts_[before].followers.push_back(i);
          ++parts_[i].awaited;
        }
      }
    }
  }

  [[nodiscard]] bool next(BagMessage& message) override
  {
    if (taken_ != nullptr)  // its message was valid until now
    {
      advance(*std::exchange(taken_, nullptr));
    }
    for (Part* earliest = earliestPart(); earliest != nullptr; earliest = earliestPart())
    {
      if (earliest->message)
      {
        message = *earliest->message;
        taken_ = earliest;
        return true;
      }
      advance(*earliest);
    }
    return false;
  }

  [[nodiscard]] double progress() const override
  {
    double sum = 0;
    for (const Part& part : parts_)
    {
      sum += part.has_ended ? 1 : part.bag->progress();
    }
    return sum / static_cast<double>(parts_.size());
  }

  [[nodiscard]] std::vector<std::string> warnings() const override
  {
    std::vector<std::string> all = warnings_;
    for (const Part& part : parts_)
    {
      const auto own = part.bag->warnings();
      all.insert(all.end(), own.begin(), own.end());
    }
    return all;
  }

 private:
  struct Part
  {
    std::unique_ptr<Bag> bag;
    std::vector<std::size_t> common;     //!< positions in topics_, by its own topic
    std::vector<std::size_t> followers;  //!< later parts with a selected topic of this one
    std::size_t awaited = 0;             //!< number of earlier ones that have not ended
    double begin = 0;                    //!< time of its first selected message, UNIX time [s]
    std::optional<BagMessage> message;   //!< the next one; nothing before the first was read
    bool has_ended = false;

    /** Time of its next message, UNIX time [s] */
    [[nodiscard]] double time() const { return message ? message->recorded : begin; }
  };

  /** \return position among the topics of all parts so far; their number if it is new. */
  [[nodiscard]] std::size_t positionOf(const BagTopic& topic) const
  {
    const auto found =
        std::find_if(topics_.begin(), topics_.end(),
                     [&topic](const BagTopic& other) { return isSameTopic(topic, other); });
    return static_cast<std::size_t>(found - topics_.begin());
  }

  /** Whether a part's topic begins before that of the parts so far ends. */
  [[nodiscard]] bool overlaps(const BagTopic& topic) const
  {
    constexpr double tolerance = 1;  // [s], of messages on their way to the recorder
    const std::size_t at = positionOf(topic);
    return at < topics_.size() && topic.messages > 0 && topic.first < topics_[at].last - tolerance;
  }

  /** \return the topic's position among those of all parts. */
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

  /** \return the selected topics of which the part has messages, as positions in topics_. */
  static std::set<std::size_t> selectIn(Part& part, const std::vector<std::size_t>& topics)
  {
    std::set<std::size_t> selected;
    std::vector<std::size_t> own;
    MessageSpan span;
    for (std::size_t i = 0; i < part.common.size(); ++i)
    {
      const BagTopic& topic = part.bag->topics()[i];
      if (topic.messages > 0 &&
          std::find(topics.begin(), topics.end(), part.common[i]) != topics.end())
      {
        own.push_back(i);
        selected.insert(part.common[i]);
        span.add(MessageSpan{topic.messages, topic.first, topic.last});
      }
    }
    part.bag->select(own);
    part.followers.clear();
    part.awaited = 0;
    part.begin = span.first;
    part.message.reset();
    part.has_ended = own.empty();
    return selected;
  }

  /** The part with the next message; null at the end of all. */
  [[nodiscard]] Part* earliestPart()
  {
    Part* earliest = nullptr;
    for (Part& part : parts_)
    {
      if (!part.has_ended && part.awaited == 0 &&
          (earliest == nullptr || part.time() < earliest->time()))
      {
        earliest = &part;
      }
    }
    return earliest;
  }

  void advance(Part& part)
  {
    part.message.reset();
    BagMessage message;
    if (part.bag->next(message))
    {
      message.topic = part.common[message.topic];
      part.message = std::move(message);
      return;
    }
    part.has_ended = true;
    for (const std::size_t follower : part.followers)
    {
      --parts_[follower].awaited;
    }
  }

  std::vector<Part> parts_;
  std::vector<BagTopic> topics_;
  std::vector<std::string> warnings_;
  Part* taken_ = nullptr;  //!< part whose message was passed on last
};

/** Whether a file is a copy of a bag beside it: packed, or as it was before rosbag rewrote it. */
bool isCopy(const fs::path& part)
{
  const fs::path original = fs::path(part).replace_extension();  // drive.db3, drive.orig
  return (isPackedBag(part.string()) && fs::exists(original)) ||
         (original.extension() == ".orig" &&
          fs::exists(fs::path(original).replace_extension(part.extension())));
}

}  // namespace

std::vector<std::string> bagParts(const std::string& folder)
{
  auto parts = listFiles(folder, isBagFile);
  parts.erase(std::remove_if(parts.begin(), parts.end(), isCopy), parts.end());
  for (const std::string& part : parts)
  {
    if (isPackedBag(part))
    {
      throw UserError(part +
                      ": is compressed as a whole, as may be other parts; unpack them "
                      "first: zstd -d " +
                      folder + "/*.zstd");
    }
    if (bagEnding(part) != bagEnding(parts.front()))
    {
      throw UserError(folder + ": holds bags of two kinds (" + bagEnding(parts.front()) + " and " +
                      bagEnding(part) + "); give the one that is meant");
    }
  }
  return parts;
}

namespace
{
std::string row(const std::vector<std::string>& cells, const std::vector<std::size_t>& widths)
{
  std::string line;
  for (std::size_t i = 0; i < cells.size(); ++i)
  {
    const std::string space(widths[i] - cells[i].size(), ' ');
    // Names are set left, numbers right; nothing follows the last.
    line += i + 1 == cells.size() ? cells[i] : (i < 2 ? cells[i] + space : space + cells[i]) + "  ";
  }
  return line + "\n";
}

/** The option of scans2rawlog that adds the topic's samples to the scans; empty if none does. \pre
 * it is no topic of scans: packets of an Ouster are then of its IMU */
std::string motionOption(const BagTopic& topic)
{
  const bool of_imu = packetMakerOf(topic) == PacketMaker::ouster && topic.messages > 0;
  return isRosImu(topic) || of_imu ? "--imu-topic"
         : isRosTwist(topic)       ? "--odometry-topic"
         : isRosFix(topic)         ? "--gnss-topic"
                                   : "";
}

/** Points and frame of a topic of scans, the frame with a mark at that taken without --topic, or
 * the option that takes the topic. */
void addScanCells(const Bag& bag,
                  const std::vector<RosScanTopic>& scans,
                  const BagTopic& topic,
                  std::vector<std::string>& cells)
{
  const auto scan = std::find_if(scans.begin(), scans.end(),
                                 [&](const RosScanTopic& candidate)
                                 { return bag.topics()[candidate.topic].name == topic.name; });
  if (scan == scans.end())
  {
    const std::string option = motionOption(topic);
    cells.insert(cells.end(), {"-", option.empty() ? "-" : "-  <- for " + option});
    return;
  }
  cells.push_back(scan->packets ? "packets" : std::to_string(scan->points));
  cells.push_back((scan->frame.empty() ? "-" : scan->frame) +
                  (scan == scans.begin() ? "  <- taken without --topic" : ""));
}

std::string fixed(double value, const char* format)
{
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  return text;
}
}  // namespace

std::string plainRosType(std::string type)
{
  const auto at = type.find("/msg/");
  return at == std::string::npos ? type : type.erase(at, 4);
}

std::unique_ptr<Bag> openBag(const std::string& path)
{
  if (fs::is_directory(path))
  {
    return std::make_unique<BagSequence>(bagParts(path));
  }
  if (isPackedBag(path))
  {
    throw UserError(path + ": is compressed as a whole; unpack it first: zstd -d " + path);
  }
  const std::string ending = bagEnding(path);
  return ending == ".bag"   ? openRos1Bag(path)
         : ending == ".db3" ? openSqliteBag(path)
                            : openMcap(path);
}

std::string listingOf(Bag& bag)
{
  const std::vector<RosScanTopic> scans = scanTopics(bag);
  std::vector<std::vector<std::string>> rows{
      {"topic", "type", "messages", "rate [1/s]", "points", "frame"}};
  MessageSpan whole;
  for (const BagTopic& topic : bag.topics())
  {
    const double span = topic.last - topic.first;
    rows.push_back({topic.name, topic.type + (topic.encoding == RosEncoding::other ? " (?)" : ""),
                    std::to_string(topic.messages),
                    topic.messages > 1 && span > 0
                        ? fixed(static_cast<double>(topic.messages - 1) / span, "%.2f")
                        : "-"});
    addScanCells(bag, scans, topic, rows.back());
    whole.add(MessageSpan{topic.messages, topic.first, topic.last});
  }
  std::vector<std::size_t> widths(rows.front().size(), 0);
  for (const auto& cells : rows)
  {
    for (std::size_t i = 0; i < cells.size(); ++i)
    {
      widths[i] = std::max(widths[i], cells[i].size());
    }
  }
  std::string text;
  for (const auto& cells : rows)
  {
    text += row(cells, widths);
  }
  return text + fixed(whole.last - whole.first, "duration %.2f s") +
         fixed(whole.first, ", from %.3f s since 1970\n") + sensorPosesOf(bag, scans);
}
}  // namespace dyslam
