// Start and stop: port file, health, reflection, stores that cannot be served.
#include <future>
#include <sstream>

#include <sys/fsuid.h>
#include <sys/stat.h>

#include "tests/integration/service/service_fixture.h"
#include "tests/support/byte_stream.h"

namespace maploc::testing {
namespace {

const std::string kListServices("\x3a\x00", 2);  // ServerReflectionRequest.list_services

class LifecycleTest : public ServiceTest {};

TEST_F(LifecycleTest, ThePortFileTellsThePortWhileItServes) {
  EXPECT_EQ(ReadFile(options_.port_file), std::to_string(server_->port()) + "\n");
  ASSERT_TRUE(server_->Shutdown().ok());
  EXPECT_FALSE(std::filesystem::exists(options_.port_file));
}

// As probes ask: of the server as a whole, or of a service by its name.
TEST_F(LifecycleTest, HealthTurnsNotServingAtTheEnd) {
  const std::string name = "maploc.v1.LocalizationService";
  const std::string by_name = "\x0a" + std::string(1, static_cast<char>(name.size())) + name;
  ByteStream whole(Address(), "/grpc.health.v1.Health/Watch", "");
  ByteStream named(Address(), "/grpc.health.v1.Health/Watch", by_name);
  EXPECT_EQ(whole.Read(), kServing);
  EXPECT_EQ(named.Read(), kServing);
  auto stop = std::async(std::launch::async, [this] { return server_->Shutdown(); });
  EXPECT_EQ(whole.Read(), kNotServing);
  EXPECT_EQ(named.Read(), kNotServing);
  EXPECT_TRUE(stop.get().ok());
}

TEST_F(LifecycleTest, AStoreThatIsReplacedIsNoLongerServed) {
  ByteStream health(Address(), "/grpc.health.v1.Health/Watch", "");
  EXPECT_EQ(health.Read(), kServing);
  ASSERT_TRUE(client_->Localize(QueryAt(2.0)).ok());
  std::filesystem::rename(options_.store, folder_.File("away"));
  EXPECT_EQ(health.Read(), kNotServing);
  const Status status = client_->Localize(QueryAt(2.0)).status();
  EXPECT_EQ(status.code(), StatusCode::kUnavailable);
  EXPECT_EQ(status.reason(), "STORE_REPLACED");
}

TEST_F(LifecycleTest, ReflectionNamesTheServices) {
  ByteStream reflection(Address(), "/grpc.reflection.v1alpha.ServerReflection/ServerReflectionInfo",
                        kListServices);
  const std::string services = reflection.Read();
  for (const char* name : {"maploc.v1.LocalizationService", "maploc.v1.MapService"}) {
    EXPECT_NE(services.find(name), std::string::npos) << name;
  }
}

TEST_F(LifecycleTest, AfterTheEndThereIsNobody) {
  ASSERT_TRUE(server_->Shutdown().ok());
  server_->WaitForShutdown();
  EXPECT_TRUE(server_->Shutdown().ok());  // again
  EXPECT_EQ(client_->Localize(QueryAt(2.0, "a session")).status().code(), StatusCode::kUnavailable);
}

TEST_F(LifecycleTest, APortInUseIsAnError) {
  ServerOptions second = options_;
  second.listen = Address();
  second.port_file.clear();
  second.store = folder_.File("another");
  EXPECT_EQ(Server::Start(second).status().reason(), "CANNOT_LISTEN");
  for (const char* suffix : {"", "-wal", "-server"}) {
    EXPECT_FALSE(std::filesystem::exists(second.store + suffix)) << suffix;
  }
  WriteFile(second.store, "");  // somebody's, and no store yet
  EXPECT_EQ(Server::Start(second).status().reason(), "CANNOT_LISTEN");
  EXPECT_EQ(ReadFile(second.store), "");
  EXPECT_TRUE(client_->Localize(QueryAt(2.0)).ok());
}

TEST_F(LifecycleTest, ASecondServerOnTheStoreIsRefused) {
  ServerOptions second = options_;
  second.port_file.clear();
  std::filesystem::create_symlink(options_.store, folder_.File("link"));
  for (const std::string& name : {options_.store, folder_.File("link")}) {
    second.store = name;
    const Result<std::unique_ptr<Server>> server = Server::Start(second);
    EXPECT_EQ(server.status().reason(), "STORE_IN_USE");
    EXPECT_NE(server.status().message().find(name), std::string::npos);
  }
  EXPECT_TRUE(client_->Localize(QueryAt(2.0)).ok());
  RestartServer();  // the first one let go of it
}

TEST_F(LifecycleTest, ALockThatMayNotBeOpenedIsNotAnotherServer) {
  const std::string store = folder_.File("another");
  const std::string file = store + "-server";
  WriteFile(file, "");
  ASSERT_EQ(chmod(file.c_str(), 0), 0);
  constexpr uid_t kNobody = 65534;
  const int before = setfsuid(kNobody);  // of this thread; root may open everything
  const Result<ServeLock> lock = ServeLock::Acquire(store);
  setfsuid(static_cast<uid_t>(before));
  ASSERT_FALSE(lock.ok());
  EXPECT_EQ(lock.status().reason(), "CANNOT_LOCK");
  EXPECT_NE(lock.status().message().find(file), std::string::npos) << lock.status().message();
  EXPECT_NE(lock.status().message().find("Permission denied"), std::string::npos)
      << lock.status().message();
}

TEST_F(LifecycleTest, AStoreInNoFolderIsAnError) {
  ServerOptions lost = options_;
  lost.store = folder_.File("no/such/folder/store");
  const Status status = Server::Start(lost).status();
  EXPECT_EQ(status.reason(), "CANNOT_LOCK");
  EXPECT_NE(status.message().find(lost.store), std::string::npos) << status.message();
}

TEST_F(LifecycleTest, AStoreMadeBehindALinkHasOneLockToo) {
  ServerOptions fresh = options_;
  fresh.port_file.clear();
  fresh.store = folder_.File("link");
  std::filesystem::create_symlink("fresh", fresh.store);
  const Result<std::unique_ptr<Server>> first = Server::Start(fresh);
  ASSERT_TRUE(first.ok()) << first.status().ToString();
  fresh.store = folder_.File("fresh");
  EXPECT_EQ(Server::Start(fresh).status().reason(), "STORE_IN_USE");
}

TEST_F(LifecycleTest, AMissingStoreIsMade) {
  ServerOptions fresh = options_;
  fresh.store = folder_.File("fresh");
  fresh.port_file.clear();
  const Result<std::unique_ptr<Server>> server = Server::Start(fresh);
  ASSERT_TRUE(server.ok()) << server.status().ToString();
  const Client client("127.0.0.1:" + std::to_string(server.value()->port()));
  EXPECT_TRUE(client.ListMaps()->empty());
}

TEST_F(LifecycleTest, AFileThatIsNoStoreIsRefusedAndLeftAlone) {
  ServerOptions wrong = options_;
  wrong.store = folder_.File("letter.txt");
  WriteFile(wrong.store, "Dear robot, this is not a database.\n");
  const Result<std::unique_ptr<Server>> server = Server::Start(wrong);
  ASSERT_FALSE(server.ok());
  EXPECT_NE(server.status().message().find(wrong.store), std::string::npos);
  EXPECT_EQ(ReadFile(wrong.store), "Dear robot, this is not a database.\n");
}

TEST_F(LifecycleTest, APortFileThatCannotBeWrittenIsAnError) {
  ServerOptions options = options_;
  options.store = folder_.File("another");
  options.port_file = folder_.File("no/such/folder/port");
  EXPECT_EQ(Server::Start(options).status().reason(), "CANNOT_WRITE");
}

}  // namespace
}  // namespace maploc::testing
