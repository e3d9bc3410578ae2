// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Trajectory.h>
#include <dyslam/formats/Bag.h>

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "BagLidars.h"
#include "BagMotion.h"
#include "BagScans.h"
#include "CloudCheck.h"
#include "HeldScans.h"
#include "TopicClocks.h"
#include "conversion/ScanSink.h"

namespace dyslam
{
/** What is converted of a bag, beside the sensors that the options name. */
struct BagContent
{
  std::string input;  //!< path of the bag, for messages
  Bag& bag;
  std::size_t scans = 0;              //!< topic of the first lidar
  std::vector<FurtherTopic> further;  //!< other lidars
  BagFrames frames;
  Trajectory truth;  //!< T_world_vehicle; empty: no true poses
};

/** Passes the scans of a bag, and what other sensors measured, to the sink. */
class BagReader
{
 public:
  /** content, options and sink outlive this. \throws UserError if what the options ask for is not
   * in the bag. */
  BagReader(const BagContent& content, const ScanConverterOptions& options, ScanSink& sink);

  /** Reads up to the end of the bag, or until the sink takes no more. Scans before damaged data are
   * passed on. \throws UserError */
  void read();
  /** Warnings about the scans of the first lidar. */
  [[nodiscard]] std::vector<std::string> warnings() const { return reader_->warnings(); }
  /** Adds notes and warnings about what was read. \param truth_topic topic of the true poses */
  void report(const std::string& truth_topic);

 private:
  struct FurtherReader
  {
    FurtherTopic topic;
    std::size_t number = 1;  //!< HeldScans::Entry::lidar
    std::unique_ptr<BagScans> reader;
    std::size_t scans = 0;
    CloudCheck clouds;
  };

  /** \param prefix of each line */
  void report(const BagScans& reader, const CloudCheck& clouds, const std::string& prefix);
  void reportClocks();
  void finish();
  [[nodiscard]] bool takeNext();
  void takeMessage();
  void hold(FurtherReader& lidar, std::vector<Scan> scans);
  void hold(std::vector<Scan> scans);
  void requireOtherLabel(const Scan& scan) const;

  const BagContent& content_;
  Bag& bag_;
  std::unique_ptr<BagScans> reader_;
  std::vector<FurtherReader> further_;
  ScanSink& sink_;
  BagMotion motion_;
  HeldScans held_;
  TopicClocks clocks_;
  CloudCheck clouds_;  //!< of the first lidar
  double scale_;       //!< RecordingOptions::scale
  BagMessage message_;
};
}  // namespace dyslam
