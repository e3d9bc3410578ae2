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

#include "BagFormats.h"

namespace dyslam
{
namespace fs = std::filesystem;

namespace
{
/** The parts of one recording behind each other. */
class BagSequence : public Bag
{
 public:
  explicit BagSequence(const std::vector<std::string>& paths)
  {
    for (const std::string& path : paths)
    {
      parts_.push_back(openBag(path));
      std::vector<std::size_t> common;
      for (const BagTopic& topic : parts_.back()->topics())
      {
        common.push_back(include(topic));
      }
      common_.push_back(std::move(common));
    }
  }

  [[nodiscard]] const std::vector<BagTopic>& topics() const override { return topics_; }

  void select(const std::vector<std::size_t>& topics) override
  {
    current_ = 0;
    for (std::size_t i = 0; i < parts_.size(); ++i)
    {
      std::vector<std::size_t> own;
      for (std::size_t j = 0; j < common_[i].size(); ++j)
      {
        if (std::find(topics.begin(), topics.end(), common_[i][j]) != topics.end())
        {
          own.push_back(j);
        }
      }
      parts_[i]->select(own);
    }
  }

  [[nodiscard]] bool next(BagMessage& message) override
  {
    for (; current_ < parts_.size(); ++current_)
    {
      if (parts_[current_]->next(message))
      {
        message.topic = common_[current_][message.topic];
        return true;
      }
    }
    return false;
  }

  [[nodiscard]] double progress() const override
  {
    const double part = current_ < parts_.size() ? parts_[current_]->progress() : 0;
    return (static_cast<double>(current_) + part) / static_cast<double>(parts_.size());
  }

  [[nodiscard]] std::vector<std::string> warnings() const override
  {
    std::vector<std::string> all;
    for (const auto& part : parts_)
    {
      const auto own = part->warnings();
      all.insert(all.end(), own.begin(), own.end());
    }
    return all;
  }

 private:
  /** \return the topic's position among those of all parts. */
  std::size_t include(const BagTopic& topic)
  {
    const auto found =
        std::find_if(topics_.begin(), topics_.end(),
                     [&topic](const BagTopic& other) { return isSameTopic(topic, other); });
    if (found == topics_.end())
    {
      topics_.push_back(topic);
      return topics_.size() - 1;
    }
    addMessages(MessageSpan{topic.messages, topic.first, topic.last}, *found);
    return static_cast<std::size_t>(found - topics_.begin());
  }

  std::vector<std::unique_ptr<Bag>> parts_;
  std::vector<BagTopic> topics_;
  std::vector<std::vector<std::size_t>> common_;  //!< positions in topics_, by part and its topic
  std::size_t current_ = 0;
};

std::vector<std::string> partsIn(const std::string& folder)
{
  const auto parts = listFiles(folder, isBagFile);
  for (const std::string& part : parts)
  {
    if (lowerExtension(part) != lowerExtension(parts.front()))
    {
      throw UserError(folder + ": holds bags of two kinds (" + lowerExtension(parts.front()) +
                      " and " + lowerExtension(part) + "); give the one that is meant");
    }
  }
  return parts;
}

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
    return std::make_unique<BagSequence>(partsIn(path));
  }
  if (isPackedBag(path))
  {
    throw UserError(path + ": is compressed as a whole; unpack it first: zstd -d " + path);
  }
  const std::string ending = lowerExtension(path);
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
