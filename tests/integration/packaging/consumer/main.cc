#include <iostream>

#include "node.h"

// usage: robot HOST:PORT [CA TOKEN]
int main(int argc, char** argv) {
  maploc::CredentialFiles credentials;
  if (argc == 4) credentials = {.ca = argv[2], .cert = "", .key = "", .token = argv[3]};
  const std::string failure = argc < 2 ? "no HOST:PORT" : RunNode(argv[1], credentials);
  std::cerr << failure;
  return failure.empty() ? 0 : 1;
}
