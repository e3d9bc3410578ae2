// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/formats/Bag.h>
#include <dyslam/ros2/Ros2Domain.h>

#include <chrono>
#include <cstddef>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace dyslam
{
/** Whether an input is a topic of ROS 2, "ros2:/points", or the scans in a domain, "ros2:": see
 * isRos2Input(). \return the name of the topic; empty for the latter */
[[nodiscard]] std::string topicOfRos2Input(const std::string& input);

struct Ros2TopicsOptions
{
  std::string scans;                //!< topic of the first lidar; empty: any topic of scans
  std::vector<std::string> others;  //!< topics that are also needed
  bool transforms = false;          //!< read `/tf`, too, not only `/tf_static`
  bool all = false;                 //!< read all topics of types that DySLAM knows
  double first_wait = 10;           //!< longest wait for the needed topics [s]
  double least_look = 2;            //!< to find topics and transforms [s]
  double silence = 5;               //!< without scans, until it is told [s]
  std::function<bool()> stop;       //!< true: the end of the messages
  std::function<void(const std::string&)> warn;  //!< a line, at once
};

/** The topics of a ROS 2 domain, as a bag that grows.
 *
 * The constructor waits for the first messages of what is needed. Until selectLast(), this is a bag
 * with the messages that were received up to then, of scans, `/tf_static` and the named topics;
 * behind it, next() delivers these and all further ones, and waits for them until `stop` is true.
 * `messages`, `first` and `last` of the topics are those up to the end of the constructor; topics
 * of an IMU or a satellite receiver that were not asked for count as having one message.
 */
class Ros2Topics : public Bag
{
 public:
  /** \throws UserError if there is nothing of what is needed, or it is no scans. If `stop` is true
   * before, the topics are those that were found until then. */
  Ros2Topics(std::unique_ptr<Ros2Domain> domain, Ros2TopicsOptions options);

  [[nodiscard]] const std::vector<BagTopic>& topics() const override { return topics_; }
  void select(const std::vector<std::size_t>& topics) override;
  void selectLast(const std::vector<std::size_t>& topics) override;
  [[nodiscard]] bool next(BagMessage& message) override;
  [[nodiscard]] double progress() const override { return 0; }
  /** The messages of selected topics that were lost. \pre selectLast() */
  [[nodiscard]] std::vector<std::string> warnings() const override;

 private:
  using Clock = std::chrono::steady_clock;

  /** A topic whose silence is told. */
  struct Heard
  {
    Clock::time_point last;
    bool is_silent = false;
  };

  [[nodiscard]] bool isStopped() const { return options_.stop && options_.stop(); }
  [[nodiscard]] bool isNeeded(const std::string& name) const;
  [[nodiscard]] bool isRead(const BagTopic& topic) const;
  [[nodiscard]] bool foundAll() const;
  [[nodiscard]] bool foundScans() const;
  void lookAround();
  void addNewTopics();
  void keep(Ros2Message message);
  void countUnread();
  void requireMessages() const;
  [[nodiscard]] std::string place() const;
  bool deliver(Ros2Message message, BagMessage& delivered);
  void noteHeard(std::size_t topic);
  void noteSilence();
  void warn(std::size_t topic, const std::string& what) const;

  std::unique_ptr<Ros2Domain> domain_;
  Ros2TopicsOptions options_;
  std::vector<BagTopic> topics_;
  std::map<std::string, std::size_t> numbers_;  //!< of topics_, by name
  std::deque<Ros2Message> kept_;                //!< received before selectLast()
  std::size_t position_ = 0;                    //!< in kept_
  std::vector<bool> is_selected_;               //!< by topic
  Clock::time_point first_scan_;
  bool is_last_ = false;                //!< selectLast() was called
  bool has_ended_ = false;              //!< nothing more is received
  Ros2Message current_;                 //!< delivered last
  std::size_t delivered_ = 0;           //!< number of messages since the last select()
  std::map<std::size_t, Heard> heard_;  //!< selected topics of scans
};
}  // namespace dyslam
