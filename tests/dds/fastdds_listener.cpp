// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// fastdds_listener NAME: prints what comes below the topic NAME as lines of JSON until it is told to end
// (SIGTERM). Fast DDS and types that its own generator made of ros.idl: nothing here is cairn's.
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <string>
#include <thread>

#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>

#include "rosPubSubTypes.h"

namespace {

using namespace eprosima::fastdds::dds;

volatile std::sig_atomic_t is_over = 0;
std::mutex printing;

void print(const std::string& line) {
  const std::lock_guard<std::mutex> lock(printing);
  std::puts(line.c_str());
  std::fflush(stdout);
}

std::string number(double value) {
  char text[40];
  std::snprintf(text, sizeof(text), "%.9g", value);
  return text;
}

std::string head_of(const char* topic, std_msgs::msg::dds_::Header_& header) {
  return std::string(R"({"topic": ")") + topic + R"(", "stamp_ns": )" +
         std::to_string(header.stamp().sec() * 1000000000LL + header.stamp().nanosec()) +
         R"(, "frame_id": ")" + header.frame_id() + "\"";
}

void show(vision_msgs::msg::dds_::Detection3DArray_& message) {
  std::string line = head_of("objects", message.header()) + R"(, "objects": [)";
  const char* comma = "";
  for (auto& found : message.detections()) {
    auto& at = found.results()[0].pose().pose().position();
    auto& size = found.bbox().size();
    line += std::string(comma) + R"({"id": ")" + found.id() + R"(", "score": )" +
            number(found.results()[0].hypothesis().score()) + R"(, "class": ")" +
            found.results()[0].hypothesis().class_id() + R"(", "position": [)" + number(at.x()) + ", " +
            number(at.y()) + ", " + number(at.z()) + R"(], "size": [)" + number(size.x()) + ", " +
            number(size.y()) + ", " + number(size.z()) + "]}";
    comma = ", ";
  }
  print(line + "]}");
}

void show(stereo_msgs::msg::dds_::DisparityImage_& message) {
  std::size_t holes = 0;
  double sum = 0;
  for (std::size_t i = 0; i + 4 <= message.image().data().size(); i += 4) {
    float value = 0;
    std::memcpy(&value, message.image().data().data() + i, 4);
    if (value != value)
      ++holes;
    else
      sum += value;
  }
  print(head_of("disparity", message.header()) + R"(, "width": )" + std::to_string(message.image().width()) +
        R"(, "height": )" + std::to_string(message.image().height()) + R"(, "encoding": ")" +
        message.image().encoding() + R"(", "f": )" + number(message.f()) + R"(, "t": )" +
        number(message.t()) + R"(, "holes": )" + std::to_string(holes) + R"(, "sum": )" + number(sum) + "}");
}

void show(nav_msgs::msg::dds_::OccupancyGrid_& message) {
  std::size_t occupied = 0;
  for (const std::uint8_t cell : message.data()) occupied += cell == 100 ? 1 : 0;
  print(head_of("grid", message.header()) + R"(, "resolution": )" + number(message.info().resolution()) +
        R"(, "width": )" + std::to_string(message.info().width()) + R"(, "height": )" +
        std::to_string(message.info().height()) + R"(, "occupied": )" + std::to_string(occupied) + "}");
}

template <class Message>
class Listener : public DataReaderListener {
 public:
  void on_data_available(DataReader* reader) override {
    Message message;
    SampleInfo info;
    while (reader->take_next_sample(&message, &info) == ReturnCode_t::RETCODE_OK)
      if (info.valid_data) show(message);
  }
};

template <class Message, class Type>
void listen(DomainParticipant& participant, Subscriber& subscriber, const std::string& topic) {
  TypeSupport type(new Type());
  type.register_type(&participant);
  Topic* const made = participant.create_topic("rt" + topic, type.get_type_name(), TOPIC_QOS_DEFAULT);
  DataReaderQos qos = DATAREADER_QOS_DEFAULT;
  qos.reliability().kind = RELIABLE_RELIABILITY_QOS;
  qos.history().kind = KEEP_ALL_HISTORY_QOS;
  qos.endpoint().history_memory_policy = eprosima::fastrtps::rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  static Listener<Message> listener;
  if (made == nullptr || subscriber.create_datareader(made, qos, &listener) == nullptr) {
    std::fprintf(stderr, "fastdds_listener: no reader on %s\n", topic.c_str());
    std::exit(1);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const char* const domain = std::getenv("ROS_DOMAIN_ID");
  if (argc != 2 || domain == nullptr) {
    std::fprintf(stderr, "fastdds_listener: expected a topic's name, and ROS_DOMAIN_ID\n");
    return 2;
  }
  std::signal(SIGTERM, [](int) { is_over = 1; });
  DomainParticipantQos qos = PARTICIPANT_QOS_DEFAULT;
  auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
  udp->interfaceWhiteList.push_back("127.0.0.1");
  udp->receiveBufferSize = 4 << 20;
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports.push_back(udp);
  DomainParticipant* const participant =
      DomainParticipantFactory::get_instance()->create_participant(std::strtoul(domain, nullptr, 10), qos);
  if (participant == nullptr) return 1;
  Subscriber* const subscriber = participant->create_subscriber(SUBSCRIBER_QOS_DEFAULT);
  const std::string name = argv[1];
  listen<vision_msgs::msg::dds_::Detection3DArray_, vision_msgs::msg::dds_::Detection3DArray_PubSubType>(
      *participant, *subscriber, name + "/objects");
  listen<stereo_msgs::msg::dds_::DisparityImage_, stereo_msgs::msg::dds_::DisparityImage_PubSubType>(
      *participant, *subscriber, name + "/disparity");
  listen<nav_msgs::msg::dds_::OccupancyGrid_, nav_msgs::msg::dds_::OccupancyGrid_PubSubType>(
      *participant, *subscriber, name + "/grid");
  while (is_over == 0) std::this_thread::sleep_for(std::chrono::milliseconds(50));
  std::_Exit(0);
}
