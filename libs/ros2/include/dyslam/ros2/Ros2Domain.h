// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace dyslam
{
/** Beginning of the names of topics that DySLAM publishes, but for `/tf`. */
constexpr const char* own_topics = "/dyslam/";

/** A topic of ROS 2 that others publish. */
struct Ros2Topic
{
  std::string name;            //!< such as "/velodyne_points"
  std::string type;            //!< "sensor_msgs/PointCloud2", as BagTopic::type
  std::size_t publishers = 0;  //!< number of them at present
};

struct Ros2Message
{
  std::string topic;
  double received = 0;  //!< time of reception, UNIX time [s]
  std::string data;     //!< CDR, after the four bytes that name the encoding
};

/** Publishes one topic while it exists. It must not outlive its domain. One thread at a time. */
class Ros2Publisher
{
 public:
  Ros2Publisher() = default;
  virtual ~Ros2Publisher() = default;
  Ros2Publisher(const Ros2Publisher&) = delete;
  Ros2Publisher& operator=(const Ros2Publisher&) = delete;

  /** Hands a message over; another thread sends it. \param data as Ros2Message::data */
  virtual void publish(const std::string& data) = 0;
  /** Number of subscriptions at present. */
  [[nodiscard]] virtual std::size_t subscriptions() const = 0;
};

/** What a topic is published with. */
struct Ros2PublisherOptions
{
  std::string topic;
  std::string type;       //!< as Ros2Topic::type, or with "/msg/" in it
  bool latched = false;   //!< later subscribers get the last message, too: transient local
  bool reliable = true;   //!< else best effort
  std::size_t depth = 5;  //!< number of messages that are kept until all have them
};

/** A domain of ROS 2, spoken to by its network protocol (DDS), without ROS.
 *
 * Messages are received by threads of the middleware from subscribe() on, and wait here, up to 1
 * GiB. One thread at a time may use it.
 */
class Ros2Domain
{
 public:
  Ros2Domain() = default;
  virtual ~Ros2Domain() = default;
  Ros2Domain(const Ros2Domain&) = delete;
  Ros2Domain& operator=(const Ros2Domain&) = delete;

  [[nodiscard]] virtual unsigned id() const = 0;
  /** The topics that were found so far, also those whose publishers have left, by name. */
  [[nodiscard]] virtual std::vector<Ros2Topic> topics() const = 0;
  /** Receives a topic as its publishers offer it: reliably, and with its last message if it is
   * latched. Also one that has no publisher yet. */
  virtual void subscribe(const std::string& topic) = 0;
  /** What was received of it so far stays. */
  virtual void unsubscribe(const std::string& topic) = 0;
  /** Takes the next message, in the order of reception. \return false if none came in this time */
  [[nodiscard]] virtual bool receive(Ros2Message& message, std::chrono::milliseconds wait) = 0;
  /** Number of messages of a topic that did not arrive, or for which there was no room. */
  [[nodiscard]] virtual std::size_t lost(const std::string& topic) const = 0;
  /** \throws UserError if it cannot be published. */
  [[nodiscard]] virtual std::unique_ptr<Ros2Publisher> advertise(
      const Ros2PublisherOptions& options) = 0;
};

struct Ros2DomainOptions
{
  unsigned id = 0;
  bool localhost_only = false;  //!< only within this computer

  /** As the environment states: ROS_DOMAIN_ID, and ROS_LOCALHOST_ONLY=1 or
   * ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST. \throws UserError for an invalid domain. */
  [[nodiscard]] static Ros2DomainOptions fromEnvironment();
};

/** Joins a domain, by the runtime module `ros2`, which has the middleware. \param needed_by the
 * option that asks for it, for the message \throws UserError if the module is missing, or if the
 * domain cannot be joined. */
[[nodiscard]] std::unique_ptr<Ros2Domain> openRos2Domain(const std::string& needed_by,
                                                         const Ros2DomainOptions& options);

/** The function `dyslam_open_ros2_domain` of the module. \throws UserError */
using OpenRos2Domain = Ros2Domain*(const Ros2DomainOptions& options);
}  // namespace dyslam
