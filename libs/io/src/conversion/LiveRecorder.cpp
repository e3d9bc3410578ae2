// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/formats/ProgramLines.h>
#include <dyslam/formats/TextFile.h>
#include <dyslam/io/LiveRecorder.h>
#include <dyslam/packets/PacketSource.h>
#include <dyslam/packets/UdpReceiver.h>

#include <cstddef>
#include <memory>
#include <utility>

#include "CaptureConverter.h"
#include "ScanSink.h"

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
    hooks.listening(receiver->name());
  }
  return PacketSource(std::move(receiver), packetSourceOptions(options));
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
  growing.requireAllFitting(RecordingKind::network);
  requireNoInput(output, growing.files());
  for (const std::string& file : growing.files())
  {
    (void)openBinary(file);  // before the user waits for packets
  }
  std::size_t recorded = 0;
  try
  {
    PacketSource source = receiveFirst(input, growing, hooks);
    ScanSink sink(output, growing,
                  [&](double, std::size_t scans)
                  {
                    recorded = scans;
                    if (hooks.recorded)
                    {
                      hooks.recorded(scans);
                    }
                  });
    return sink.fill(
        [&]
        {
          convertPackets(source, sink, growing);
          return sink.close();
        });
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
}  // namespace dyslam
