// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/formats/Bag.h>
#include <dyslam/formats/ProgramLines.h>
#include <dyslam/formats/RecordingKind.h>
#include <dyslam/formats/TextFile.h>
#include <dyslam/io/LiveRecorder.h>
#include <dyslam/io/OptionError.h>
#include <dyslam/packets/PacketSource.h>
#include <dyslam/packets/UdpReceiver.h>
#include <dyslam/ros2/Ros2Topics.h>

#include <cstddef>
#include <memory>
#include <utility>

#include "CaptureConverter.h"
#include "ScanSink.h"
#include "bags/BagConverter.h"

namespace dyslam
{
namespace
{
/** The scans of the lidar, from the first one on, for which it waits. */
PacketSource receiveFirst(const std::string& input,
                          const ScanConverterOptions& options,
                          const LiveRecorderHooks& hooks)
{
  UdpReceiverOptions of_receiver;
  of_receiver.stop = hooks.stop;
  of_receiver.warn = hooks.warn;
  auto receiver = std::make_unique<UdpReceiver>(UdpAddress::fromText(input), of_receiver);
  if (hooks.listening)
  {
    hooks.listening("packets on " + receiver->name());
  }
  return PacketSource(std::move(receiver), packetSourceOptions(options));
}

ConversionResult recordPackets(const std::string& input,
                               const std::string& output,
                               const ScanConverterOptions& options,
                               const LiveRecorderHooks& hooks,
                               const ConversionProgress& progress)
{
  PacketSource source = receiveFirst(input, options, hooks);
  ScanSink sink(output, options, progress);
  return sink.fill(
      [&]
      {
        convertPackets(source, sink, options);
        return sink.close();
      });
}

std::string placeOf(const Ros2DomainOptions& domain)
{
  return "ROS 2, domain " + std::to_string(domain.id);
}

/** The topics that the options ask for, from the first messages on, for which it waits.
 * \param options those of the recording, with the topic of the input */
std::unique_ptr<Ros2Topics> joinTopics(const std::string& input,
                                       const ScanConverterOptions& options,
                                       const LiveRecorderHooks& hooks)
{
  const auto of_domain = Ros2DomainOptions::fromEnvironment();
  Ros2TopicsOptions wanted;
  wanted.scans = options.topic;
  for (const std::string& topic : {options.imu_topic, options.odometry_topic, options.gnss_topic})
  {
    if (!topic.empty())
    {
      wanted.others.push_back(topic);
    }
  }
  for (const std::string& further : options.further_topics)
  {
    wanted.others.push_back(splitFurtherTopic(further).topic);
  }
  wanted.transforms = !options.base_frame.empty();
  wanted.stop = hooks.stop;
  wanted.warn = hooks.warn;
  auto domain = openRos2Domain("--input " + input, of_domain);
  if (hooks.listening)
  {
    hooks.listening((wanted.scans.empty() ? "scans" : "messages of " + wanted.scans) + " (" +
                    placeOf(of_domain) + ")");
  }
  return std::make_unique<Ros2Topics>(std::move(domain), wanted);
}

ConversionResult recordTopics(const std::string& input,
                              const std::string& output,
                              ScanConverterOptions options,
                              const LiveRecorderHooks& hooks,
                              const ConversionProgress& progress)
{
  const std::string topic = topicOfRos2Input(input);
  if (!topic.empty() && !options.topic.empty() && options.topic != topic)
  {
    throw UserError(input + ": --topic " + options.topic + " is another topic; give one of them");
  }
  options.topic = topic.empty() ? options.topic : topic;
  const auto topics = joinTopics(input, options, hooks);
  ScanSink sink(output, options, progress);
  const auto convert = [&]
  {
    convertMessages(placeOf(Ros2DomainOptions::fromEnvironment()), *topics, sink, options,
                    hooks.vehicle_frame);
    for (const std::string& warning : topics->warnings())
    {
      sink.warn(warning);
    }
    return sink.close();
  };
  try
  {
    return sink.fill(convert);
  }
  catch (const OptionError& error)
  {
    throw UserError(error.what() +
                    std::string(error.flag() == "--list" ? " (scans2rawlog -i ros2: --list)" : ""));
  }
}
}  // namespace

ConversionResult recordLive(const std::string& input,
                            const std::string& output,
                            const ScanConverterOptions& options,
                            const LiveRecorderHooks& hooks)
{
  ScanConverterOptions growing = options;
  growing.growing = true;
  validate(growing, "scans2rawlog");
  growing.requireAllFitting(recordingKind(input));
  requireNoInput(output, growing.files());
  for (const std::string& file : growing.files())
  {
    (void)openBinary(file);  // before the user waits for packets
  }
  std::size_t recorded = 0;
  const ConversionProgress progress = [&](double, std::size_t scans)
  {
    recorded = scans;
    if (hooks.recorded)
    {
      hooks.recorded(scans);
    }
  };
  try
  {
    return isRos2Input(input) ? recordTopics(input, output, growing, hooks, progress)
                              : recordPackets(input, output, growing, hooks, progress);
  }
  catch (const UserError&)
  {
    if (recorded == 0 && hooks.stop && hooks.stop())
    {
      throw UserError(stoppedMessage(input, stopReason("before the first scan")));
    }
    throw;
  }
}

std::string listLiveTopics(const std::function<bool()>& stop)
{
  Ros2TopicsOptions all;
  all.all = true;
  all.stop = stop;
  Ros2Topics topics(openRos2Domain("--list", Ros2DomainOptions::fromEnvironment()), all);
  return listingOf(topics);
}
}  // namespace dyslam
