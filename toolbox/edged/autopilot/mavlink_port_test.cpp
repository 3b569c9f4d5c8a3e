// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/autopilot/mavlink_port.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "edged/autopilot/test_autopilot.hpp"
#include "edged/input_error.hpp"

namespace edged {
namespace {

using Bytes = std::vector<std::uint8_t>;
using std::chrono::seconds;
using testing::HasSubstr;

const Bytes kFrame = {0xFD, 0x0A, 0x0D, 0x11, 0x13, 0x00, 0xFF};  // with all that a terminal would translate

std::string refusal_of(const std::string& url) {
  try {
    const MavlinkPort port(url);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

TEST(MavlinkPort, UdpSendsAndReceivesTheAnswers) {
  const TestUdp autopilot;
  MavlinkPort port(autopilot.url());
  EXPECT_TRUE(port.receive().empty());
  EXPECT_TRUE(port.send(kFrame));
  autopilot.answer(Bytes{1, 2, 3});
  EXPECT_TRUE(port.wait(seconds(5)));
  EXPECT_EQ(port.receive(), (Bytes{1, 2, 3}));
  EXPECT_TRUE(port.send(kFrame));
  EXPECT_EQ(autopilot.receive(), kFrame);
}

TEST(MavlinkPort, UdpinAnswersWhoeverHasSentLast) {
  int number = 0;
  {
    const TestUdp free;
    number = std::stoi(free.port());
  }
  MavlinkPort port("udpin:127.0.0.1:" + std::to_string(number));
  EXPECT_FALSE(port.send(kFrame));
  EXPECT_THAT(port.failure(), HasSubstr("no autopilot has sent"));
  const TestUdp first, second;
  for (const TestUdp* autopilot : {&first, &second}) {
    autopilot->send(Bytes{7}, number);
    ASSERT_TRUE(port.wait(seconds(5)));
    EXPECT_EQ(port.receive(), Bytes{7});
    EXPECT_TRUE(port.send(kFrame));
    EXPECT_EQ(autopilot->receive(), kFrame);
  }
}

TEST(MavlinkPort, AnAddressWhereNobodyListensCostsMessagesOnly) {
  std::string url;
  {
    const TestUdp gone;
    url = gone.url();
  }
  MavlinkPort port(url);
  bool refused = false;
  for (int i = 0; i < 100 && !refused; ++i) {
    refused = !port.send(kFrame);
    port.wait(std::chrono::milliseconds(10));  // the refusal comes later
  }
  EXPECT_TRUE(refused);
  EXPECT_THAT(port.failure(), HasSubstr("refused"));
}

TEST(MavlinkPort, SerialTranslatesNothing) {
  const TestSerial autopilot;
  MavlinkPort port(autopilot.url());
  EXPECT_TRUE(port.send(kFrame));
  EXPECT_EQ(autopilot.receive(), kFrame);
  autopilot.send(kFrame);
  EXPECT_TRUE(port.wait(seconds(5)));
  EXPECT_EQ(port.receive(), kFrame);
}

TEST(MavlinkPort, ASerialLineThatIsFullLosesWholeFramesAndNoParts) {
  const TestSerial autopilot;
  MavlinkPort port(autopilot.url());
  Bytes frame(245);
  for (std::size_t i = 0; i < frame.size(); ++i) frame[i] = static_cast<std::uint8_t>(i);
  std::size_t taken = 0;
  while (taken < 100'000 && port.send(frame)) ++taken;
  EXPECT_LT(taken, 100'000U);
  EXPECT_FALSE(port.failure().empty());
  Bytes received;
  for (std::size_t wanted = frame.size() * taken; received.size() < wanted;) {
    const Bytes more = autopilot.receive();
    ASSERT_FALSE(more.empty());
    received.insert(received.end(), more.begin(), more.end());
    if (received.size() < wanted && port.send(frame)) wanted += frame.size();  // sends the rest, then another one
  }
  ASSERT_EQ(received.size() % frame.size(), 0U);
  for (std::size_t i = 0; i < received.size(); ++i) ASSERT_EQ(received[i], frame[i % frame.size()]) << i;
}

TEST(MavlinkPort, AnAutopilotThatIsUnpluggedCostsMessagesOnly) {
  TestSerial autopilot;
  MavlinkPort port(autopilot.url());
  autopilot.close();
  EXPECT_FALSE(port.send(kFrame));
  EXPECT_FALSE(port.failure().empty());
  EXPECT_TRUE(port.receive().empty());
}

TEST(MavlinkPort, RefusesWhatIsNoAddressInOneLineWithTheRemedy) {
  for (const char* url :
       {"", "udp", "udp:", "udp:14550", "tcp:127.0.0.1:5760", "udp:127.0.0.1:", "serial:/dev/ttyACM0"})
    EXPECT_THAT(refusal_of(url), HasSubstr("such as udp:127.0.0.1:14550")) << url;
  EXPECT_THAT(refusal_of("udp:127.0.0.1:abc"), HasSubstr("give the address and the port"));
  EXPECT_THAT(refusal_of("serial:/dev/null:921600"), HasSubstr("not a serial device"));
  EXPECT_THAT(refusal_of("serial:/dev/nothing:921600"), HasSubstr("plugged in"));
  EXPECT_THAT(refusal_of("serial:/dev/null:9601"), HasSubstr("921600"));
  const TestUdp taken;
  EXPECT_THAT(refusal_of("udpin:127.0.0.1:" + taken.port()), HasSubstr("another program"));
}

TEST(MavlinkPort, ReadsTheSlashesOfOtherPrograms) {
  const TestUdp autopilot;
  MavlinkPort port("udp://127.0.0.1:" + autopilot.port());
  EXPECT_TRUE(port.send(kFrame));
  EXPECT_EQ(autopilot.receive(), kFrame);
}

}  // namespace
}  // namespace edged
