#include "node.h"

#include <iostream>

#include "client/api/client.h"
#include "client/odometry/tracker.h"

std::string RunNode(const std::string& server, const maploc::CredentialFiles& credentials) {
  auto read = maploc::ReadCredentials(credentials);
  if (!read.ok()) return read.status().ToString();
  maploc::ClientOptions client_options;
  client_options.credentials = *std::move(read);
  const maploc::Client client(server, client_options);
  const auto maps = client.ListMaps();
  if (!maps.ok()) return maps.status().ToString();
  std::cout << maps->size() << " maps\n";

  maploc::TrackerOptions options;
  options.agreeing_answers = 1;
  auto tracker = maploc::Tracker::Create(options);
  if (!tracker.ok()) return tracker.status().ToString();
  maploc::UncertainPose answer;
  answer.map_from_body.translation = {1.0, 2.0, 3.0};
  answer.covariance.diagonal().setConstant(0.01);
  const auto decision = tracker->Judge(maploc::Rigid3(), answer);
  if (!decision.ok()) return decision.status().ToString();
  const auto pose = tracker->MapFromBase(maploc::Rigid3());
  if (!pose) return "an answer was held back: " + decision->Reason();
  std::cout << "at " << pose->map_from_body.translation.transpose() << ", variance "
            << pose->covariance(5, 5) << "\n";
  return "";
}
