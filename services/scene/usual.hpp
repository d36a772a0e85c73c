/// Values that the scene allows and that are more likely a slip of the unit.
#pragma once

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>

#include <string>
#include <vector>

namespace interply::scene {

/// One sentence for each number of a message of proto/scene.proto outside its (usual) interval; 0 always passes.
std::vector<std::string> find_unusual(const google::protobuf::Message& message);

/// "; in kg/m3 it would be 7.85e-09 t/mm3" if a common unit makes a usual value of this one, else nothing.
std::string suggest_unit(double value, const google::protobuf::FieldOptions& options);

}  // namespace interply::scene
