/// The structs of frames.hpp as bytes, and back: what a recorder is sent over the exchange (proto/sample.proto).
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "observe/frames.hpp"

namespace interply::observe {

std::string encode_sample(const RunHeader& a);
std::string encode_sample(const LayerMesh& a);
std::string encode_sample(const LayerFrame& a);
std::string encode_sample(const InterfaceFrame& a);
std::string encode_sample(const ToolFrame& a);
std::string encode_sample(const HistoryRow& a);
std::string encode_sample(const RunEnd& a);

/// Puts the one sample that `bytes` hold into `sink`. Allocates no more than a few times their number.
/// @throws std::invalid_argument  "is unreadable", "has 7 coordinates, which is no multiple of 3", ...
void decode_sample(std::span<const std::byte> bytes, Sink& sink);

}  // namespace interply::observe
