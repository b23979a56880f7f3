#pragma once

#include <string>

#include "client/api/credentials.h"

// Prints the maps of the server, and what odometry makes of an answer. "" or what went wrong.
std::string RunNode(const std::string& server, const maploc::CredentialFiles& credentials);
