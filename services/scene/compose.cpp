#include "scene/compose.hpp"

#include <algorithm>

#include "scene.pb.h"
#include "scene/files.hpp"
#include "scene/read_scene.hpp"
#include "scene/schema.hpp"

namespace interply::scene {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;

bool is_block_of_keys(const FieldDescriptor* field) {
  return field && field->message_type() && !is_list(*field->message_type());
}

void anchor_file(Value& path, const std::filesystem::path& folder) {
  if (path.kind == Value::Kind::Scalar && !path.scalar.empty()) path.scalar = to_absolute(path.scalar, folder);
}

void anchor_files(Value& value, const Descriptor& type, const std::filesystem::path& folder) {
  if (&type == schema::File::descriptor()) {
    Value* path = value.kind == Value::Kind::Block ? value.find("path") : &value;
    if (path) anchor_file(*path, folder);
    return;
  }
  for (std::size_t i = 0; i < value.keys.size(); ++i) {
    const FieldDescriptor* field = type.FindFieldByName(value.keys[i]);
    if (!is_block_of_keys(field)) continue;
    if (field->is_repeated())  // a list, or in an overlay a block by name
      for (Value& item : value.items[i].items) anchor_files(item, *field->message_type(), folder);
    else
      anchor_files(value.items[i], *field->message_type(), folder);
  }
}

void erase(Value& block, std::size_t i) {
  block.keys.erase(block.keys.begin() + static_cast<std::ptrdiff_t>(i));
  block.items.erase(block.items.begin() + static_cast<std::ptrdiff_t>(i));
}

/// Removes alternatives of `base` that are others than those of `over`.
void drop_other_alternatives(Value& base, Value& over, const Descriptor& type) {
  const auto find_oneof = [&](const std::string& key) {
    const FieldDescriptor* field = type.FindFieldByName(key);
    return field ? field->real_containing_oneof() : nullptr;
  };
  for (const std::string& key : over.keys) {
    const auto* oneof = find_oneof(key);
    for (std::size_t i = base.keys.size(); oneof && i-- > 0;)
      if (base.keys[i] != key && find_oneof(base.keys[i]) == oneof) erase(base, i);
  }
}

void lay_over_items(Value& list, Value over, const Descriptor& type, const std::string& path, Report& report) {
  for (std::size_t i = 0; i < over.keys.size(); ++i) {
    std::string item_path = path;
    if (Value* item = find_item(list, over.keys[i], over.items[i].origin, item_path, report))
      lay_over(*item, std::move(over.items[i]), type, item_path, report);
  }
}

}  // namespace

Value parse_part(const std::filesystem::path& file, const Descriptor& type, Report& report) {
  Value root = parse_yaml(read_text(file), file.string(), report);
  drop_anchors(root);
  anchor_files(root, type, file.parent_path());
  return root;
}

void drop_anchors(Value& root) {
  for (std::size_t i = root.keys.size(); i-- > 0;)
    if (root.keys[i].starts_with("x-")) erase(root, i);
}

void include_law(Value& law, const std::filesystem::path& folder, const std::string& path, Report& report) {
  Value* file = law.find("file");
  if (!file) return;
  const bool chosen_last = law.keys.back() == "file" && file->origin.starts_with("--set ");
  if (law.keys.size() > 1 && !chosen_last) return;  // the reader says which one to keep
  while (law.keys.size() > 1) erase(law, 0);
  file = &law.items[0];
  const std::string file_path = join(path, std::string("file"));
  if (report.is_broken(file_path)) return;  // said already
  if (file->kind != Value::Kind::Scalar || file->scalar.empty())
    return report.add_at(file->origin, file_path, "must be the path of a file that holds a `law` block");
  const std::string origin = file->origin;
  anchor_file(*file, folder);
  try {
    Value part = parse_part(file->scalar, *schema::Law::descriptor(), report);
    if (part.keys.size() == 1 && part.keys[0] == "law") {
      part = Value(part.items[0]);
      anchor_files(part, *schema::Law::descriptor(), std::filesystem::path(file->scalar).parent_path());
    }
    if (part.find("file")) return report.add_at(origin, file_path, "names a file that names another; give that one");
    law = std::move(part);
  } catch (const SceneError& error) {
    report.add_at(origin, file_path, error.what());
  }
}

void include_laws(Value& root, const std::filesystem::path& folder, Report& report) {
  Value* layers = root.find("layers");
  if (!layers) return;
  for (std::size_t i = 0; i < layers->items.size(); ++i)
    if (Value* law = layers->items[i].find("law"))
      include_law(*law, folder, join(join("layers", i), std::string("law")), report);
}

void lay_over(Value& base, Value over, const Descriptor& type, const std::string& path, Report& report) {
  if (base.kind != Value::Kind::Block || over.kind != Value::Kind::Block) {
    base = std::move(over);
    return;
  }
  drop_other_alternatives(base, over, type);
  for (std::size_t i = 0; i < over.keys.size(); ++i) {
    const std::string& key = over.keys[i];
    const FieldDescriptor* field = type.FindFieldByName(key);
    Value& item = over.items[i];
    Value* found = base.find(key);
    if (!found) {
      base.keys.push_back(key);
      base.items.push_back(std::move(item));
    } else if (!is_block_of_keys(field)) {
      *found = std::move(item);
    } else if (!field->is_repeated()) {
      lay_over(*found, std::move(item), *field->message_type(), join(path, key), report);
    } else if (item.kind == Value::Kind::Block && found->kind == Value::Kind::List) {
      lay_over_items(*found, std::move(item), *field->message_type(), join(path, key), report);
    } else {
      *found = std::move(item);
    }
  }
}

}  // namespace interply::scene
