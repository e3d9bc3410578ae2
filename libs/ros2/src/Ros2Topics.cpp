// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Printable.h>
#include <dyslam/base/Words.h>
#include <dyslam/formats/RecordingKind.h>
#include <dyslam/formats/RosMessages.h>
#include <dyslam/formats/RosPackets.h>
#include <dyslam/ros2/Ros2Topics.h>

#include <algorithm>
#include <utility>

namespace dyslam
{
namespace
{
constexpr std::chrono::milliseconds stop_check(100);  //!< between two looks at `stop`
/** Of several topics of scans that which sends the most in this time is taken [s]. */
constexpr double comparison = 1;

double secondsSince(std::chrono::steady_clock::time_point start)
{
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

bool hasScans(const BagTopic& topic)
{
  return RosScanDecoder::reads(topic) || packetMakerOf(topic).has_value();
}

bool isTransforms(const BagTopic& topic, const std::string& name)
{
  const std::string end = "/" + name;
  return topic.type == "tf2_msgs/TFMessage" && topic.name.size() >= end.size() &&
         topic.name.compare(topic.name.size() - end.size(), end.size(), end) == 0;
}

bool isOfMotion(const BagTopic& topic)
{
  return isRosImu(topic) || isRosTwist(topic) || isRosFix(topic);
}

/** "/a, /b" */
std::string namesOf(const std::vector<BagTopic>& topics)
{
  std::string names;
  for (const BagTopic& topic : topics)
  {
    appendWord(names, topic.name);
  }
  return names;
}
}  // namespace

std::string topicOfRos2Input(const std::string& input)
{
  const std::string name = input.substr(input.find(':') + 1);
  return name.empty() || name.front() == '/' ? name : "/" + name;
}

Ros2Topics::Ros2Topics(std::unique_ptr<Ros2Domain> domain, Ros2TopicsOptions options)
    : domain_(std::move(domain)), options_(std::move(options))
{
  lookAround();
  countUnread();
  is_selected_.assign(topics_.size(), false);
  if (!isStopped())
  {
    requireMessages();
  }
}

bool Ros2Topics::isNeeded(const std::string& name) const
{
  const auto& others = options_.others;
  return name == options_.scans || std::find(others.begin(), others.end(), name) != others.end();
}

bool Ros2Topics::isRead(const BagTopic& topic) const
{
  const bool may_be_scans = hasScans(topic) && options_.scans.empty();
  // An Ouster's packets come with those of its IMU and with its metadata.
  const bool is_ouster =
      packetMakerOf(topic) == PacketMaker::ouster || topic.type == "std_msgs/String";
  const bool is_asked = options_.all && (hasScans(topic) || isOfMotion(topic));
  return isNeeded(topic.name) || may_be_scans || is_ouster || is_asked ||
         isTransforms(topic, "tf_static") ||
         ((options_.transforms || options_.all) && isTransforms(topic, "tf"));
}

bool Ros2Topics::foundScans() const
{
  if (options_.scans.empty())
  {
    const bool any =
        std::any_of(topics_.begin(), topics_.end(),
                    [](const BagTopic& topic) { return hasScans(topic) && topic.messages > 0; });
    return any && secondsSince(first_scan_) > comparison;
  }
  const auto found = numbers_.find(options_.scans);
  // A topic of another type is an error, for which nothing has to be waited for.
  return found != numbers_.end() &&
         (topics_[found->second].messages > 0 || !hasScans(topics_[found->second]));
}

bool Ros2Topics::foundAll() const
{
  const bool has_others =
      std::all_of(options_.others.begin(), options_.others.end(),
                  [this](const std::string& name)
                  {
                    const auto found = numbers_.find(name);
                    return found != numbers_.end() && (topics_[found->second].messages > 0 ||
                                                       !hasScans(topics_[found->second]));
                  });
  const bool has_transforms =
      std::all_of(topics_.begin(), topics_.end(),
                  [](const BagTopic& topic)
                  { return topic.messages > 0 || !isTransforms(topic, "tf_static"); });
  return has_others && has_transforms && (options_.all ? !topics_.empty() : foundScans());
}

void Ros2Topics::lookAround()
{
  const auto begin = Clock::now();
  Ros2Message message;
  while (!isStopped())
  {
    addNewTopics();
    if (domain_->receive(message, stop_check))
    {
      keep(std::move(message));
    }
    const double waited = secondsSince(begin);
    if (waited > options_.first_wait || (waited > options_.least_look && foundAll()))
    {
      return;
    }
  }
}

void Ros2Topics::addNewTopics()
{
  for (const Ros2Topic& found : domain_->topics())
  {
    // What this run or another one publishes is no input.
    const bool is_own = found.name.rfind(own_topics, 0) == 0 && !isNeeded(found.name);
    if ((is_own && !options_.all) || !numbers_.emplace(found.name, topics_.size()).second)
    {
      continue;
    }
    BagTopic topic;
    topic.name = found.name;
    topic.type = found.type;
    topic.encoding = RosEncoding::cdr;
    topics_.push_back(topic);
    if (isRead(topic))
    {
      domain_->subscribe(topic.name);
    }
  }
}

void Ros2Topics::keep(Ros2Message message)
{
  const auto number = numbers_.find(message.topic);
  if (number == numbers_.end())
  {
    return;
  }
  BagTopic& topic = topics_[number->second];
  topic.first = topic.messages == 0 ? message.received : topic.first;
  topic.last = message.received;
  ++topic.messages;
  if (hasScans(topic) && first_scan_ == Clock::time_point())
  {
    first_scan_ = Clock::now();
  }
  kept_.push_back(std::move(message));
}

/** Notes to the user name the sensors that could be used, too: those with messages. */
void Ros2Topics::countUnread()
{
  for (BagTopic& topic : topics_)
  {
    if (!isRead(topic) && (isRosImu(topic) || isRosFix(topic)))
    {
      topic.messages = 1;
    }
  }
}

std::string Ros2Topics::place() const
{
  return "ROS 2, domain " + std::to_string(domain_->id());
}

/** \throws UserError if there is no message of a topic of scans that is needed. */
void Ros2Topics::requireMessages() const
{
  const std::string within = formatted(" within %g s", options_.first_wait);
  if (topics_.empty())
  {
    throw UserError(place() + ": found no topic" + within +
                    "; check that the publishers run, ROS_DOMAIN_ID (here and theirs), "
                    "ROS_LOCALHOST_ONLY, and that the network and its firewall let multicast and "
                    "UDP ports from 7400 on through");
  }
  if (options_.all)
  {
    return;
  }
  if (!options_.scans.empty() && numbers_.count(options_.scans) == 0)
  {
    std::vector<BagTopic> scans;
    std::copy_if(topics_.begin(), topics_.end(), std::back_inserter(scans), hasScans);
    throw UserError(place() + ": " + options_.scans + ": has no publisher" + within +
                    (scans.empty() ? "; no topic has scans; there are " + namesOf(topics_)
                                   : "; topics with scans are " + namesOf(scans)));
  }
  std::vector<BagTopic> mute;
  bool any = false;
  for (const BagTopic& topic : topics_)
  {
    any = any || (hasScans(topic) && topic.messages > 0);
    const bool is_needed = isNeeded(topic.name) || options_.scans.empty();
    if (is_needed && hasScans(topic) && topic.messages == 0)
    {
      mute.push_back(topic);
    }
  }
  if (!mute.empty() && (!any || !options_.scans.empty()))
  {
    throw UserError(
        place() + ": no messages of " + namesOf(mute) + within +
        ", though there is a publisher; is the lidar on, and does a firewall drop UDP?");
  }
}

void Ros2Topics::select(const std::vector<std::size_t>& topics)
{
  is_selected_.assign(topics_.size(), false);
  for (const std::size_t topic : topics)
  {
    is_selected_[topic] = true;
  }
  position_ = 0;
  delivered_ = 0;
}

void Ros2Topics::selectLast(const std::vector<std::size_t>& topics)
{
  select(topics);
  is_last_ = true;
  for (std::size_t i = 0; i < topics_.size(); ++i)
  {
    if (!is_selected_[i])
    {
      domain_->unsubscribe(topics_[i].name);
      continue;
    }
    if (hasScans(topics_[i]))
    {
      heard_[i].last = Clock::now();
    }
  }
}

bool Ros2Topics::next(BagMessage& message)
{
  while (position_ < kept_.size())
  {
    Ros2Message& kept = kept_[position_];
    if (is_last_)
    {
      Ros2Message taken = std::move(kept);
      kept_.pop_front();
      if (deliver(std::move(taken), message))
      {
        return true;
      }
      continue;
    }
    ++position_;
    if (deliver(kept, message))
    {
      return true;
    }
  }
  Ros2Message received;
  while (is_last_)
  {
    if (!has_ended_ && isStopped())
    {
      has_ended_ = true;
      for (const BagTopic& topic : topics_)
      {
        domain_->unsubscribe(topic.name);
      }
    }
    const bool any =
        domain_->receive(received, has_ended_ ? std::chrono::milliseconds(0) : stop_check);
    if (any && deliver(std::move(received), message))
    {
      noteHeard(message.topic);
      return true;
    }
    if (!any && has_ended_)
    {
      return false;
    }
    noteSilence();
  }
  return false;
}

/** \return false if the message is of a topic that is not selected */
bool Ros2Topics::deliver(Ros2Message message, BagMessage& delivered)
{
  const auto number = numbers_.find(message.topic);
  if (number == numbers_.end() || !is_selected_[number->second])
  {
    return false;
  }
  current_ = std::move(message);
  ++delivered_;
  delivered.topic = number->second;
  delivered.recorded = current_.received;
  delivered.data = current_.data;
  delivered.place = place() + ": message " + std::to_string(delivered_);
  return true;
}

void Ros2Topics::noteHeard(std::size_t topic)
{
  const auto heard = heard_.find(topic);
  if (heard == heard_.end())
  {
    return;
  }
  if (heard->second.is_silent)
  {
    warn(topic, formatted("messages again, after %.0f s", secondsSince(heard->second.last)));
  }
  heard->second = {Clock::now(), false};
}

void Ros2Topics::noteSilence()
{
  for (auto& [topic, heard] : heard_)
  {
    const double seconds = secondsSince(heard.last);
    if (!heard.is_silent && seconds > options_.silence)
    {
      heard.is_silent = true;
      warn(topic, formatted("no messages for %.0f s; the recording goes on when they come again",
                            seconds));
    }
  }
}

void Ros2Topics::warn(std::size_t topic, const std::string& what) const
{
  if (options_.warn)
  {
    options_.warn(topics_[topic].name + ": " + what);
  }
}

std::vector<std::string> Ros2Topics::warnings() const
{
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < topics_.size(); ++i)
  {
    const std::size_t lost = is_last_ && is_selected_[i] ? domain_->lost(topics_[i].name) : 0;
    if (lost > 0)
    {
      lines.push_back(topics_[i].name + ": " + counted(lost, "message") +
                      " lost on the way: a network or computer that is too busy, or socket buffers "
                      "that are too small (sudo sysctl -w net.core.rmem_max=33554432)");
    }
  }
  return lines;
}
}  // namespace dyslam
