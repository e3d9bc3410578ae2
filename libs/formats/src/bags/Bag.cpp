// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Printable.h>
#include <dyslam/formats/Bag.h>
#include <dyslam/formats/RecordingKind.h>
#include <dyslam/formats/RosMessages.h>
#include <dyslam/formats/RosPackets.h>
#include <dyslam/formats/ScanFiles.h>

#include <algorithm>
#include <filesystem>

#include "BagFormats.h"

namespace dyslam
{
namespace fs = std::filesystem;

namespace
{
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
    if (isPackedBag(part) && !isZstdBag(part))
    {
      throw UserError(part +
                      ": is compressed as a whole, as may be other parts; unpack them "
                      "first: " +
                      unpackCommand(part) + " " + shellWord(folder) + "/*" +
                      fs::path(part).extension().string());
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
void addScanCells(Bag& bag,
                  const std::vector<RosScanTopic>& scans,
                  std::size_t topic,
                  std::vector<std::string>& cells)
{
  const auto scan =
      std::find_if(scans.begin(), scans.end(),
                   [&](const RosScanTopic& candidate)
                   { return bag.topics()[candidate.topic].name == bag.topics()[topic].name; });
  if (scan == scans.end())
  {
    const std::string option = motionOption(bag.topics()[topic]);
    cells.insert(cells.end(),
                 {"-", isMapOdometry(bag, topic) ? "map  <- result of a SLAM, no wheel odometry"
                       : option.empty()          ? "-"
                                                 : "-  <- for " + option});
    return;
  }
  cells.push_back(scan->packets ? "packets" : std::to_string(scan->points));
  cells.push_back((scan->frame.empty() ? "-" : scan->frame) +
                  (scan == scans.begin() ? "  <- taken without --topic" : ""));
}
}  // namespace

std::string plainRosType(std::string type)
{
  const auto at = type.find("/msg/");
  return at == std::string::npos ? type : type.erase(at, 4);
}

std::unique_ptr<Bag> openBag(const std::string& path, const BagUnpackingProgress& unpacking)
{
  return openParts(fs::is_directory(path) ? bagParts(path) : std::vector<std::string>{path},
                   unpacking);
}

std::string listingOf(Bag& bag)
{
  const std::vector<RosScanTopic> scans = scanTopics(bag);
  std::vector<std::vector<std::string>> rows{
      {"topic", "type", "messages", "rate [1/s]", "points", "frame"}};
  MessageSpan whole;
  for (std::size_t i = 0; i < bag.topics().size(); ++i)
  {
    const BagTopic& topic = bag.topics()[i];
    const double span = topic.last - topic.first;
    rows.push_back({topic.name, topic.type + (topic.encoding == RosEncoding::other ? " (?)" : ""),
                    std::to_string(topic.messages),
                    topic.messages > 1 && span > 0
                        ? formatted("%.2f", static_cast<double>(topic.messages - 1) / span)
                        : "-"});
    addScanCells(bag, scans, i, rows.back());
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
  return text + formatted("duration %.2f s", whole.last - whole.first) +
         formatted(", from %.3f s since 1970\n", whole.first) + sensorPosesOf(bag, scans);
}
}  // namespace dyslam
