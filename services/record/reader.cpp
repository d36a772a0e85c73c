#include "record/reader.hpp"

#include <spdlog/fmt/fmt.h>

#include <stdexcept>

#include "record/file.hpp"
#include "record/hdf5.hpp"

namespace interply::record {

struct RecordReader::Impl {
  std::filesystem::path path;
  Handle file;

  Handle open(const std::string& dataset) const {
    try {
      return open_dataset(file, dataset);
    } catch (const std::runtime_error&) {
      throw std::runtime_error(fmt::format("{} has no dataset {}", path.string(), dataset));
    }
  }
  /// Entries [begin, begin + count) of the first dimension.
  Numbers read_part(const std::string& dataset, hsize_t begin, hsize_t count) const {
    const Handle handle = open(dataset);
    const Shape shape = shape_of(handle);
    Numbers numbers{{shape.begin(), shape.end()},
                    read_rows(handle, begin, count),
                    read_attribute(handle, "unit"),
                    read_attribute(handle, "description")};
    numbers.shape.at(0) = count;
    return numbers;
  }
};

RecordReader::RecordReader(const std::filesystem::path& file) : impl_(std::make_unique<Impl>()) {
  impl_->path = file;
  impl_->file = open_file(file, false);
}
RecordReader::~RecordReader() = default;

int RecordReader::frames_complete() const { return static_cast<int>(read("frames_complete").values.at(0)); }
int RecordReader::rows_complete() const { return static_cast<int>(read("history/rows_complete").values.at(0)); }
std::vector<double> RecordReader::times() const {
  return impl_->read_part("time", 0, static_cast<hsize_t>(frames_complete())).values;
}
std::vector<std::string> RecordReader::layers() const { return record::read_text(impl_->open("scene/layers")); }
std::vector<std::string> RecordReader::interfaces() const { return record::read_text(impl_->open("scene/interfaces")); }

std::string RecordReader::read_text(const std::string& path) const {
  return record::read_text(impl_->open(path)).at(0);
}

Numbers RecordReader::read(const std::string& path) const {
  const Handle handle = impl_->open(path);
  const Shape shape = shape_of(handle);
  return {{shape.begin(), shape.end()},
          read_all(handle),
          read_attribute(handle, "unit"),
          read_attribute(handle, "description")};
}

Numbers RecordReader::read_frame(const std::string& path, int frame) const {
  const int complete = frames_complete();
  if (frame < 0 || frame >= complete) {
    throw std::runtime_error(fmt::format("frame {} of {} is not among the {} complete frames of {}", frame, path,
                                         complete, impl_->path.string()));
  }
  Numbers numbers = impl_->read_part(path, static_cast<hsize_t>(frame), 1);
  numbers.shape.erase(numbers.shape.begin());
  return numbers;
}

mechanics::NodalVectors RecordReader::read_position(const std::string& layer, int frame) const {
  const Numbers n = read_frame("layers/" + to_path_name(layer) + "/position", frame);
  using ByNode = Eigen::Array<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
  return Eigen::Map<const ByNode>(n.values.data(), static_cast<Eigen::Index>(n.shape.at(0)), 3).transpose();
}

mechanics::Triangles RecordReader::read_triangles(const std::string& layer) const {
  const Numbers n = read("layers/" + to_path_name(layer) + "/triangles");
  using ByElement = Eigen::Array<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
  return Eigen::Map<const ByElement>(n.values.data(), static_cast<Eigen::Index>(n.shape.at(0)), 3)
      .transpose()
      .cast<int>();
}

Numbers RecordReader::read_layer_field(const std::string& layer, const std::string& field, int frame) const {
  return read_frame("layers/" + to_path_name(layer) + "/" + to_path_name(field), frame);
}

Numbers RecordReader::read_interface_field(const std::string& interface, const std::string& field, int frame) const {
  return read_frame("interfaces/" + to_path_name(interface) + "/" + to_path_name(field), frame);
}

Numbers RecordReader::read_history(const std::string& column) const {
  return impl_->read_part("history/" + column, 0, static_cast<hsize_t>(rows_complete()));
}

}  // namespace interply::record
