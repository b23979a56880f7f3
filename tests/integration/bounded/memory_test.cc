// Memory before admission: uploads that never end, calls that are reset as soon as they are begun.
#include <algorithm>
#include <atomic>
#include <fstream>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "client/api/client.h"
#include "tests/integration/bounded/raw_connection.h"
#include "tests/support/server_process.h"

namespace maploc::testing {
namespace {

constexpr auto npos = std::string::npos;
constexpr double kMaxMoreMib = 256;
constexpr char kLocalize[] = "/maploc.v1.LocalizationService/Localize";

enum Frame : char { kData = 0, kHeaders = 1, kReset = 3, kSettings = 4, kWindow = 8 };
constexpr char kEndOfHeaders = 4;

std::string BigEndian(std::uint32_t value, int bytes) {
  std::string text;
  for (int i = bytes - 1; i >= 0; --i) text.push_back(static_cast<char>(value >> (8 * i)));
  return text;
}

std::string Http2Frame(Frame type, char flags, std::uint32_t stream, const std::string& payload) {
  return BigEndian(static_cast<std::uint32_t>(payload.size()), 3) + static_cast<char>(type) +
         flags + BigEndian(stream, 4) + payload;
}

// Without compression.
std::string Header(const std::string& name, const std::string& value) {
  return std::string(1, '\0') + static_cast<char>(name.size()) + name +
         static_cast<char>(value.size()) + value;
}

std::string BeginOfCall(std::uint32_t stream) {
  return Http2Frame(kHeaders, kEndOfHeaders, stream,
                    Header(":method", "POST") + Header(":scheme", "http") +
                        Header(":path", kLocalize) + Header(":authority", "robot") +
                        Header("content-type", "application/grpc") + Header("te", "trailers"));
}

std::string BeginOfConnection() {
  return "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n" + Http2Frame(kSettings, 0, 0, "");
}

class MemoryTest : public ::testing::Test {
 protected:
  MemoryTest() : server_(folder_), address_(server_.Start()), client_(address_) {
    EXPECT_TRUE(client_.ListMaps().ok());
    idle_mib_ = ResidentMib();
  }
  ~MemoryTest() override { server_.Stop(); }

  double ResidentMib() const {
    std::ifstream status("/proc/" + std::to_string(server_.pid()) + "/status");
    std::string word;
    while (status >> word && word != "VmRSS:") continue;
    double kib = 0;
    status >> kib;
    return kib / 1024;
  }
  int port() const { return std::stoi(address_.substr(address_.rfind(':') + 1)); }
  // Asks all the while as a polite robot's operator would.
  void ExpectServedUntil(const std::atomic<bool>& end) const {
    while (!end) {
      const auto maps = client_.ListMaps();
      EXPECT_TRUE(maps.ok()) << maps.status().ToString();
      EXPECT_LT(ResidentMib() - idle_mib_, kMaxMoreMib);
    }
  }
  void ExpectMemoryIsGivenBack() const {
    EXPECT_TRUE(WaitFor([this] { return ResidentMib() - idle_mib_ < 100; })) << ResidentMib();
  }

  const TemporaryFolder folder_;
  ServerProcess server_;
  const std::string address_;
  const Client client_;
  double idle_mib_ = 0;
};

TEST_F(MemoryTest, CallsThatAreResetAtOnceCostLittle) {
  std::atomic<bool> end = false;
  std::vector<std::thread> attackers;
  for (int i = 0; i < 3; ++i) {
    attackers.emplace_back([this] {
      for (int calls = 0; calls < 100000;) {
        const RawConnection connection(port());
        bool open = connection.Send(BeginOfConnection());
        for (std::uint32_t stream = 1; open && calls < 100000; stream += 2, ++calls) {
          open =
              connection.Send(BeginOfCall(stream) + Http2Frame(kReset, 0, stream, BigEndian(8, 4)));
          connection.IsClosedByServer();  // drops what the server says
        }
      }
    });
  }
  std::thread robot([&] { ExpectServedUntil(end); });
  for (std::thread& attacker : attackers) attacker.join();
  end = true;
  robot.join();
  ExpectMemoryIsGivenBack();
}

TEST_F(MemoryTest, UploadsThatNeverEndAreEnded) {
  constexpr std::uint32_t kMessage = 19 << 20;
  const std::string piece = Http2Frame(kData, 0, 1, std::string(16384, 'x'));
  std::vector<RawConnection> uploads;
  std::atomic<bool> end = false;
  std::thread robot([&] { ExpectServedUntil(end); });
  for (int i = 0; i < 40; ++i) {
    const RawConnection& upload = uploads.emplace_back(port());
    bool open = upload.Send(BeginOfConnection() + BeginOfCall(1) +
                            Http2Frame(kData, 0, 1, '\0' + BigEndian(kMessage, 4)));
    for (std::uint32_t sent = 0; open && sent + 16384 < kMessage; sent += 16384) {
      open = upload.Send(piece);
      upload.IsClosedByServer();
    }
  }
  end = true;
  robot.join();
  EXPECT_TRUE(WaitFor(
      [&] { return std::ranges::count_if(uploads, &RawConnection::IsClosedByServer) >= 36; }));
  EXPECT_TRUE(WaitFor([&] { return folder_.Read("stderr").find("unfinished uploads") != npos; }))
      << "the log says so once they are ended";
  uploads.clear();
  ExpectMemoryIsGivenBack();
}

}  // namespace
}  // namespace maploc::testing
