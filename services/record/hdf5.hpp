/// Thin RAII over the HDF5 C API. Internal to record.
#pragma once

#include <hdf5.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace interply::record {

/// Any HDF5 identifier; closes it at the end.
class Handle {
 public:
  Handle() = default;
  explicit Handle(hid_t id) : id_(id) {}
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, H5I_INVALID_HID)) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    return *this;
  }
  ~Handle() {
    if (id_ >= 0) H5Idec_ref(id_);
  }
  hid_t id() const { return id_; }

 private:
  hid_t id_ = H5I_INVALID_HID;
};

using Shape = std::vector<hsize_t>;

/// `result` if it is not negative. @throws std::system_error if the system has refused something, else
/// std::runtime_error "cannot <action>: <HDF5's innermost reason>"
hid_t check(hid_t result, const std::string& action);

/// A new file in the earliest format. Metadata and raw data go straight to the file system; no file lock is held, so
/// that others may read while it is written.
Handle create_file(const std::filesystem::path& path);
/// An existing file, for overwriting raw data in place (`writable`) or for reading.
Handle open_file(const std::filesystem::path& path, bool writable);

Handle create_group(const Handle& parent, const std::string& name);

/// Contiguous, allocated and filled at once: NaN for doubles, -1 for integers. Its metadata never change again.
/// @param type   H5T_NATIVE_DOUBLE, H5T_NATIVE_INT or H5T_NATIVE_INT64; shape {} is a scalar
Handle create_dataset(const Handle& parent, const std::string& name, hid_t type, const Shape& shape,
                      const std::string& unit, const std::string& description);
/// Strings of fixed length (UTF-8, padded with zeros), empty at first. shape {} is a scalar.
Handle create_text(const Handle& parent, const std::string& name, std::size_t length, const Shape& shape,
                   const std::string& description);

void write_attribute(const Handle& object, const std::string& name, const std::string& value);
std::string read_attribute(const Handle& object, const std::string& name);

Handle open_dataset(const Handle& parent, const std::string& path);
Shape shape_of(const Handle& dataset);

/// Whole dataset; data as many as its shape says.
void write_all(const Handle& dataset, const double* data);
void write_all(const Handle& dataset, const int* data);
/// Entry `row` of the first dimension; @pre values.size() is the product of the others
void write_row(const Handle& dataset, hsize_t row, const std::vector<double>& values);
void write_row(const Handle& dataset, hsize_t row, std::int64_t value);
/// Entries [begin, begin + count) of the first dimension; @pre values.size() is `count` times the product of the others
void write_rows(const Handle& dataset, hsize_t begin, hsize_t count, const std::vector<double>& values);
void write_rows(const Handle& dataset, hsize_t begin, hsize_t count, const std::vector<std::int64_t>& values);
/// A scalar integer.
void write_scalar(const Handle& dataset, int value);
/// Texts in order, each cut to the dataset's length at a character's start.
void write_text(const Handle& dataset, const std::vector<std::string>& texts);

/// Entries [begin, begin + count) of the first dimension, converted to double.
std::vector<double> read_rows(const Handle& dataset, hsize_t begin, hsize_t count);
/// Everything, also of a scalar.
std::vector<double> read_all(const Handle& dataset);
std::vector<std::string> read_text(const Handle& dataset);

/// Everything written so far reaches the operating system, so it survives this process (not a power failure).
void flush(const Handle& file);

}  // namespace interply::record
