/// What a record is made of, before it is written: known from the header, the meshes and the first frame of a run.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "observe/frames.hpp"

namespace interply::record {

/// `name` as part of an HDF5 and XDMF path: every character but letters, digits and . _ - | + becomes '_'.
std::string to_path_name(const std::string& name);

/// Shape of one field.
struct FieldShape {
  std::string name, unit, description;
  bool nodal = false;
  int components = 1;
  std::size_t points = 0;
};
std::vector<FieldShape> shapes_of(const std::vector<observe::Field>& fields);

/// Everything that fixes the layout. Layers and interfaces that are not in the maps get a group without frames.
struct Layout {
  observe::RunHeader header;
  std::map<std::string, observe::LayerMesh> meshes;                 ///< by layer
  std::map<std::string, std::vector<FieldShape>> layer_fields;      ///< by layer
  std::map<std::string, std::vector<FieldShape>> interface_fields;  ///< by interface
  std::map<std::string, std::vector<FieldShape>> other_fields;      ///< at the nodes of its other layer, by interface
};

/// Bytes of the record and its sidecar, to 1 % and a few kilobytes. They have them from the first frame on, whatever
/// happens to the run. Nothing is compressed: a compressed dataset would have to change its place in the file as it
/// grows (file.hpp).
std::uint64_t measure_record(const Layout& layout);

}  // namespace interply::record
