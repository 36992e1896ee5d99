// A stranger on ROS 2's wire: eProsima's Fast DDS, which is most robots' middleware, without ROS.
//
//     peer DOMAIN LEASE plain|typed      LEASE: seconds of silence until others believe that it is gone
//
// It reads commands from stdin, a line each, and says what it does and sees as JSON, a line each:
//
//     writer odom|scan|light|echo QOS...     reader cmd_vel|stamped|ros_discovery_info QOS...
//         QOS: reliable best_effort volatile transient_local exclusive deadline (of 0.1 s)
//     drop NAME                              an endpoint goes
//     odom X Y    scan COUNT    light GREY   publish one
//     announce NODE                          say as ROS 2 does which node has these endpoints
//
// A Twist on cmd_vel is repeated on echo, if there is such a writer. Where it is `typed`, endpoints carry
// the hash of their type as since ROS 2 Iron. Everything stays on the loopback interface.
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>
#include <functional>
#include <iomanip>
#include <iostream>
#include <map>
#include <memory>
#include <mutex>
#include <sstream>
#include <string>

#include "ros2PubSubTypes.h"

namespace fast = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;
using Twist = geometry_msgs::msg::dds_::Twist_;
using TwistStamped = geometry_msgs::msg::dds_::TwistStamped_;
using Odometry = nav_msgs::msg::dds_::Odometry_;
using LaserScan = sensor_msgs::msg::dds_::LaserScan_;
using UInt8 = std_msgs::msg::dds_::UInt8_;
using Text = std_msgs::msg::dds_::String_;
using Log = rcl_interfaces::msg::dds_::Log_;
using Entities = rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_;
using Node = rmw_dds_common::msg::dds_::NodeEntitiesInfo_;
using Gid = rmw_dds_common::msg::dds_::Gid_;

static std::mutex out_lock;

static void say(const std::string& members) {
  std::lock_guard<std::mutex> guard(out_lock);
  std::cout << '{' << members << '}' << std::endl;
}

static std::string json_text(const std::string& text) {
  std::string all = "\"";
  for (char each : text) {
    if (each == '"' || each == '\\') all += '\\';
    all += each;
  }
  return all + '"';
}

template <typename Octets>
static std::string hex(const Octets& octets) {
  std::ostringstream text;
  for (unsigned octet : octets) text << std::hex << std::setw(2) << std::setfill('0') << octet;
  return text.str();
}

static std::array<uint8_t, 16> octets(const rtps::GUID_t& guid) {
  std::array<uint8_t, 16> all;
  std::copy_n(guid.guidPrefix.value, 12, all.begin());
  std::copy_n(guid.entityId.value, 4, all.begin() + 12);
  return all;
}

static Gid gid(const rtps::GUID_t& guid) {
  Gid made;
  made.data(octets(guid));
  return made;
}

static std::string numbers(const geometry_msgs::msg::dds_::Vector3_& vector) {
  std::ostringstream text;
  text << std::setprecision(17) << '[' << vector.x() << ',' << vector.y() << ',' << vector.z() << ']';
  return text.str();
}

template <typename Data>
static std::string word(const Data& data) {
  return std::string(data.begin(), data.end());
}

struct Kind {
  std::string topic, type, hash;
  std::function<fast::TopicDataType*()> make;
};

template <typename PubSubType>
static Kind kind(const std::string& topic, const std::string& type, const std::string& hash) {
  return {topic, type, hash, [] { return new PubSubType(); }};
}

static const std::map<std::string, Kind> kinds = {
    {"cmd_vel", kind<geometry_msgs::msg::dds_::Twist_PubSubType>(
                    "rt/cmd_vel", "geometry_msgs::msg::dds_::Twist_",
                    "9c45bf16fe0983d80e3cfe750d6835843d265a9a6c46bd2e609fcddde6fb8d2a")},
    {"echo", kind<geometry_msgs::msg::dds_::Twist_PubSubType>(
                 "rt/echo", "geometry_msgs::msg::dds_::Twist_",
                 "9c45bf16fe0983d80e3cfe750d6835843d265a9a6c46bd2e609fcddde6fb8d2a")},
    {"stamped", kind<geometry_msgs::msg::dds_::TwistStamped_PubSubType>(
                    "rt/stamped", "geometry_msgs::msg::dds_::TwistStamped_",
                    "5f0fcd4f81d5d06ad9b4c4c63e3ea51b82d6ae4d0558f1d475229b1121db6f64")},
    {"odom", kind<nav_msgs::msg::dds_::Odometry_PubSubType>(
                 "rt/odom", "nav_msgs::msg::dds_::Odometry_",
                 "3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0")},
    {"scan", kind<sensor_msgs::msg::dds_::LaserScan_PubSubType>(
                 "rt/scan", "sensor_msgs::msg::dds_::LaserScan_",
                 "64c191398013af96509d518dac71d5164f9382553fce5c1f8cca5be7924bd828")},
    {"light", kind<std_msgs::msg::dds_::UInt8_PubSubType>(
                  "rt/light", "std_msgs::msg::dds_::UInt8_",
                  "6138bd83d8c3569cb80a667db03cfc1629f529fee79d944c39c34e352e72f010")},
    {"state", kind<std_msgs::msg::dds_::String_PubSubType>(
                  "rt/lrp/state", "std_msgs::msg::dds_::String_",
                  "df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18")},
    {"rosout", kind<rcl_interfaces::msg::dds_::Log_PubSubType>(
                   "rt/rosout", "rcl_interfaces::msg::dds_::Log_",
                   "e28ce254ca8abc06abf92773b74602cdbf116ed34fbaf294fb9f81da9f318eac")},
    {"ros_discovery_info", kind<rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_PubSubType>(
                               "ros_discovery_info", "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_",
                               "91a0593bacdcc50ea9bdcf849a938b128412cc1ea821245c663bcd26f83c295e")},
};

// What others announce, word for word.
class Watch : public fast::DomainParticipantListener {
  void on_participant_discovery(fast::DomainParticipant*,
                                rtps::ParticipantDiscoveryInfo&& info) override {
    if (info.status == rtps::ParticipantDiscoveryInfo::DISCOVERED_PARTICIPANT)
      say("\"participant\":\"" + hex(octets(info.info.m_guid)) + "\",\"user_data\":\"" +
          word(info.info.m_userData) + '"');
  }
  void on_publisher_discovery(fast::DomainParticipant*, rtps::WriterDiscoveryInfo&& info) override {
    endpoint("their_writer", info.status == rtps::WriterDiscoveryInfo::DISCOVERED_WRITER, info.info);
  }
  void on_subscriber_discovery(fast::DomainParticipant*, rtps::ReaderDiscoveryInfo&& info) override {
    endpoint("their_reader", info.status == rtps::ReaderDiscoveryInfo::DISCOVERED_READER, info.info);
  }
  template <typename Data>
  static void endpoint(const std::string& what, bool is_new, Data& data) {
    if (is_new)
      say('"' + what + "\":\"" + data.topicName().to_string() + "\",\"type\":\"" +
          data.typeName().to_string() + "\",\"user_data\":\"" + word(data.m_qos.m_userData) +
          "\",\"gid\":\"" + hex(octets(data.guid())) + "\",\"reliable\":" +
          (data.m_qos.m_reliability.kind == fast::RELIABLE_RELIABILITY_QOS ? "true" : "false") +
          ",\"kept\":" + (data.m_qos.m_durability.kind == fast::VOLATILE_DURABILITY_QOS ? "false" : "true"));
  }
};

class Peer : public fast::DataReaderListener {
 public:
  Peer(uint32_t domain, double lease, bool typed) : typed_(typed) {
    fast::DomainParticipantQos qos;
    qos.transport().use_builtin_transports = false;
    auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
    udp->interfaceWhiteList.push_back("127.0.0.1");
    qos.transport().user_transports.push_back(udp);
    for (uint32_t participant = 0; participant < 8; ++participant) {
      rtps::Locator_t locator;
      rtps::IPLocator::setIPv4(locator, 127, 0, 0, 1);
      locator.port = 7400 + 250 * domain + 10 + 2 * participant;
      qos.wire_protocol().builtin.initialPeersList.push_back(locator);
    }
    auto& discovery = qos.wire_protocol().builtin.discovery_config;
    discovery.leaseDuration = eprosima::fastrtps::Duration_t(lease);
    discovery.leaseDuration_announcementperiod = eprosima::fastrtps::Duration_t(lease / 4);
    qos.user_data().setValue(bytes("enclave=/;"));
    participant_ = fast::DomainParticipantFactory::get_instance()->create_participant(
        domain, qos, &watch_, fast::StatusMask::none());
    publisher_ = participant_->create_publisher(fast::PUBLISHER_QOS_DEFAULT);
    subscriber_ = participant_->create_subscriber(fast::SUBSCRIBER_QOS_DEFAULT);
  }

  void obey(const std::string& line) {
    std::istringstream words(line);
    std::string verb, name;
    words >> verb;
    if (verb == "writer" || verb == "reader") {
      words >> name;
      const Kind& kind = kinds.at(name);
      auto* topic = topic_of(kind);
      if (verb == "writer") {
        fast::DataWriterQos qos;
        fill(qos, kind, words);
        writers_[name] = publisher_->create_datawriter(topic, qos);
        if (name == "echo") echo_ = writers_[name];
      } else {
        fast::DataReaderQos qos;
        fill(qos, kind, words);
        readers_[name] = subscriber_->create_datareader(topic, qos, this,
                                                        fast::StatusMask::data_available());
      }
    } else if (verb == "drop") {
      words >> name;
      if (auto writer = writers_.extract(name)) publisher_->delete_datawriter(writer.mapped());
      if (auto reader = readers_.extract(name)) subscriber_->delete_datareader(reader.mapped());
    } else if (verb == "odom") {
      Odometry odom;
      words >> odom.pose().pose().position().x() >> odom.pose().pose().position().y();
      odom.pose().pose().orientation().w() = 1;
      odom.header().frame_id() = "odom";
      odom.header().stamp().sec() = 1700000000;
      odom.header().stamp().nanosec() = 250000000;
      odom.pose().covariance()[35] = 0.5;
      writers_.at("odom")->write(&odom);
    } else if (verb == "scan") {
      int count = 0;
      words >> count;
      LaserScan scan;
      for (int index = 0; index < count; ++index) scan.ranges().push_back(index * 0.25f);
      writers_.at("scan")->write(&scan);
    } else if (verb == "light") {
      int grey = 0;
      words >> grey;
      UInt8 light;
      light.data(static_cast<uint8_t>(grey));
      writers_.at("light")->write(&light);
    } else if (verb == "announce") {
      words >> name;
      announce(name);
    }
    say("\"done\":\"" + line + '"');
  }

 private:
  void on_data_available(fast::DataReader* reader) override {
    fast::SampleInfo info;
    const std::string topic = reader->get_topicdescription()->get_name();
    const std::string got = "\"got\":\"" + topic + "\",";
    if (topic == "rt/cmd_vel") {
      Twist twist;
      while (reader->take_next_sample(&twist, &info) == ReturnCode_t::RETCODE_OK) {
        if (!info.valid_data) continue;
        say(got + "\"linear\":" + numbers(twist.linear()) + ",\"angular\":" + numbers(twist.angular()));
        if (auto* echo = echo_.load()) echo->write(&twist);
      }
    } else if (topic == "rt/stamped") {
      TwistStamped twist;
      while (reader->take_next_sample(&twist, &info) == ReturnCode_t::RETCODE_OK)
        if (info.valid_data)
          say(got + "\"linear\":" + numbers(twist.twist().linear()) + ",\"sec\":" +
              std::to_string(twist.header().stamp().sec()) + ",\"nanosec\":" +
              std::to_string(twist.header().stamp().nanosec()) + ",\"frame\":\"" +
              twist.header().frame_id() + '"');
    } else if (topic == "rt/lrp/state") {
      Text text;
      while (reader->take_next_sample(&text, &info) == ReturnCode_t::RETCODE_OK)
        if (info.valid_data) say(got + "\"data\":" + json_text(text.data()));
    } else if (topic == "rt/rosout") {
      Log log;
      while (reader->take_next_sample(&log, &info) == ReturnCode_t::RETCODE_OK)
        if (info.valid_data)
          say(got + "\"level\":" + std::to_string(log.level()) + ",\"name\":" + json_text(log.name()) +
              ",\"msg\":" + json_text(log.msg()) + ",\"file\":" + json_text(log.file()) + ",\"line\":" +
              std::to_string(log.line()) + ",\"sec\":" + std::to_string(log.stamp().sec()));
    } else {
      Entities entities;
      while (reader->take_next_sample(&entities, &info) == ReturnCode_t::RETCODE_OK)
        if (info.valid_data) say(got + told(entities));
    }
  }

  static std::string told(const Entities& entities) {
    std::string nodes;
    for (const auto& node : entities.node_entities_info_seq()) {
      nodes += (nodes.empty() ? "" : ",");
      nodes += "{\"namespace\":\"" + node.node_namespace() + "\",\"name\":\"" + node.node_name() + "\",\"readers\":[";
      for (size_t index = 0; index < node.reader_gid_seq().size(); ++index)
        nodes += (index ? ",\"" : "\"") + hex(node.reader_gid_seq()[index].data()) + '"';
      nodes += "],\"writers\":[";
      for (size_t index = 0; index < node.writer_gid_seq().size(); ++index)
        nodes += (index ? ",\"" : "\"") + hex(node.writer_gid_seq()[index].data()) + '"';
      nodes += "]}";
    }
    return "\"gid\":\"" + hex(entities.gid().data()) + "\",\"nodes\":[" + nodes + ']';
  }

  void announce(const std::string& name) {
    Entities entities;
    entities.gid(gid(participant_->guid()));
    Node node;
    node.node_namespace("/");
    node.node_name(name);
    for (const auto& each : writers_) node.writer_gid_seq().push_back(gid(each.second->guid()));
    for (const auto& each : readers_) node.reader_gid_seq().push_back(gid(each.second->guid()));
    entities.node_entities_info_seq().push_back(node);
    writers_.at("ros_discovery_info")->write(&entities);
  }

  static std::vector<uint8_t> bytes(const std::string& text) { return {text.begin(), text.end()}; }

  fast::Topic* topic_of(const Kind& kind) {
    if (auto* known = dynamic_cast<fast::Topic*>(participant_->lookup_topicdescription(kind.topic)))
      return known;
    fast::TypeSupport type(kind.make());
    type->setName(kind.type.c_str());
    type->auto_fill_type_information(false);
    type->auto_fill_type_object(false);
    type.register_type(participant_);
    return participant_->create_topic(kind.topic, kind.type, fast::TOPIC_QOS_DEFAULT);
  }

  template <typename Qos>
  void fill(Qos& qos, const Kind& kind, std::istringstream& words) const {
    qos.history().depth = 10;
    if (typed_) qos.user_data().setValue(bytes("typehash=RIHS01_" + kind.hash + ';'));
    for (std::string word; words >> word;) {
      if (word == "reliable") qos.reliability().kind = fast::RELIABLE_RELIABILITY_QOS;
      if (word == "best_effort") qos.reliability().kind = fast::BEST_EFFORT_RELIABILITY_QOS;
      if (word == "volatile") qos.durability().kind = fast::VOLATILE_DURABILITY_QOS;
      if (word == "transient_local") qos.durability().kind = fast::TRANSIENT_LOCAL_DURABILITY_QOS;
      if (word == "exclusive") qos.ownership().kind = fast::EXCLUSIVE_OWNERSHIP_QOS;
      if (word == "deadline") qos.deadline().period = eprosima::fastrtps::Duration_t(0.1);
    }
  }

  Watch watch_;
  bool typed_;
  std::atomic<fast::DataWriter*> echo_{nullptr};  // read on a thread of Fast DDS; it is never dropped
  fast::DomainParticipant* participant_;
  fast::Publisher* publisher_;
  fast::Subscriber* subscriber_;
  std::map<std::string, fast::DataWriter*> writers_;
  std::map<std::string, fast::DataReader*> readers_;
};

int main(int count, char** arguments) {
  if (count != 4) return 2;
  Peer peer(std::stoul(arguments[1]), std::stod(arguments[2]), std::string(arguments[3]) == "typed");
  say("\"ready\":true");
  for (std::string line; std::getline(std::cin, line);) peer.obey(line);
  std::_Exit(0);  // as a robot that is switched off
}
