#include "record/hdf5.hpp"

#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string_view>
#include <system_error>

namespace interply::record {
namespace {

/// Keeps HDF5 from printing its error stack: check() reports errors. And from closing files once more when the process
/// ends, which crashes for a file that a full disk has not let it close; every Handle closes its own. Each thread has an
/// error stack of its own.
void prepare() {
  static const bool once = H5dont_atexit() >= 0;
  thread_local const bool in_this_thread = H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr) >= 0;
  (void)once;
  (void)in_this_thread;
}

/// What the system said, of a description that quotes it: "..., errno = 28, error message = '...', ..."; 0 if none does.
int find_system_error(const std::string& description) {
  constexpr std::string_view kBefore = "errno = ";
  const std::size_t begin = description.find(kBefore);
  return begin == std::string::npos ? 0 : std::atoi(description.c_str() + begin + kBefore.size());
}

herr_t keep_innermost(unsigned n, const H5E_error2_t* error, void* reason) {
  if (n == 0) *static_cast<std::string*>(reason) = error->desc ? error->desc : "";
  return 0;
}

std::size_t cut_at_character(const std::string& s, std::size_t length) {
  if (s.size() <= length) return s.size();
  while (length > 0 && (static_cast<unsigned char>(s[length]) & 0xC0) == 0x80) --length;
  return length;
}

Handle make_space(const Shape& shape) {
  return Handle(check(
      shape.empty() ? H5Screate(H5S_SCALAR) : H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr),
      "make a data space"));
}

Handle make_text_type(std::size_t length) {
  Handle type(check(H5Tcopy(H5T_C_S1), "make a text type"));
  check(H5Tset_size(type.id(), std::max<std::size_t>(length, 1)), "make a text type");
  check(H5Tset_strpad(type.id(), H5T_STR_NULLPAD), "make a text type");
  check(H5Tset_cset(type.id(), H5T_CSET_UTF8), "make a text type");
  return type;
}

Handle make_access(bool writable) {
  Handle access(check(H5Pcreate(H5P_FILE_ACCESS), "make file access properties"));
  check(H5Pset_fclose_degree(access.id(), H5F_CLOSE_STRONG), "set the close degree");
  check(H5Pset_file_locking(access.id(), false, true), "set file locking");
  if (writable) check(H5Pset_sieve_buf_size(access.id(), 0), "set the sieve buffer");
  return access;
}

Handle create_filled(const Handle& parent, const std::string& name, hid_t type, const void* fill, const Shape& shape,
                     const std::string& unit, const std::string& description) {
  const std::string action = fmt::format("create dataset {}", name);
  const Handle properties(check(H5Pcreate(H5P_DATASET_CREATE), action));
  check(H5Pset_layout(properties.id(), H5D_CONTIGUOUS), action);
  check(H5Pset_alloc_time(properties.id(), H5D_ALLOC_TIME_EARLY), action);
  check(H5Pset_fill_time(properties.id(), H5D_FILL_TIME_ALLOC), action);
  if (fill) check(H5Pset_fill_value(properties.id(), type, fill), action);
  check(H5Pset_obj_track_times(properties.id(), false), action);
  const Handle space = make_space(shape);
  Handle dataset(check(
      H5Dcreate2(parent.id(), name.c_str(), type, space.id(), H5P_DEFAULT, properties.id(), H5P_DEFAULT), action));
  write_attribute(dataset, "unit", unit);
  write_attribute(dataset, "description", description);
  return dataset;
}

/// Selects entries [begin, begin + count) of the first dimension. @return their number of values
hsize_t select_rows(const Handle& space, const Shape& shape, hsize_t begin, hsize_t count) {
  Shape start(shape.size(), 0), extent = shape;
  start.at(0) = begin;
  extent.at(0) = count;
  check(H5Sselect_hyperslab(space.id(), H5S_SELECT_SET, start.data(), nullptr, extent.data(), nullptr), "select rows");
  return std::accumulate(extent.begin(), extent.end(), hsize_t{1}, std::multiplies<>());
}

void write_selected(const Handle& dataset, hsize_t begin, hsize_t count, hid_t type, const void* data, hsize_t size) {
  const Handle space(check(H5Dget_space(dataset.id()), "open a data space"));
  const hsize_t n = select_rows(space, shape_of(dataset), begin, count);
  if (n != size) throw std::logic_error(fmt::format("rows of {} values are written with {}", n, size));
  const Handle memory = make_space({n});
  check(H5Dwrite(dataset.id(), type, memory.id(), space.id(), H5P_DEFAULT, data), "write to the record");
}

}  // namespace

hid_t check(hid_t result, const std::string& action) {
  if (result >= 0) return result;
  std::string reason;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_innermost, &reason);
  if (const int error = find_system_error(reason))
    throw std::system_error(error, std::generic_category(), fmt::format("cannot {}", action));
  throw std::runtime_error(fmt::format("cannot {}: {}", action, reason));
}

Handle create_file(const std::filesystem::path& path) {
  prepare();
  const Handle access = make_access(true);
  return Handle(
      check(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.id()), fmt::format("create {}", path.string())));
}

Handle open_file(const std::filesystem::path& path, bool writable) {
  prepare();
  const Handle access = make_access(writable);
  return Handle(check(H5Fopen(path.c_str(), writable ? H5F_ACC_RDWR : H5F_ACC_RDONLY, access.id()),
                      fmt::format("open {}", path.string())));
}

Handle create_group(const Handle& parent, const std::string& name) {
  return Handle(check(H5Gcreate2(parent.id(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                      fmt::format("create group {}", name)));
}

Handle create_dataset(const Handle& parent, const std::string& name, hid_t type, const Shape& shape,
                      const std::string& unit, const std::string& description) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::int64_t none64 = -1;
  const int none = -1;
  const void* fill = type == H5T_NATIVE_DOUBLE  ? static_cast<const void*>(&nan)
                     : type == H5T_NATIVE_INT64 ? static_cast<const void*>(&none64)
                                                : static_cast<const void*>(&none);
  return create_filled(parent, name, type, fill, shape, unit, description);
}

Handle create_text(const Handle& parent, const std::string& name, std::size_t length, const Shape& shape,
                   const std::string& description) {
  return create_filled(parent, name, make_text_type(length).id(), nullptr, shape, "-", description);
}

void write_attribute(const Handle& object, const std::string& name, const std::string& value) {
  const Handle type = make_text_type(value.size()), space = make_space({});
  const std::string action = fmt::format("write attribute {}", name);
  const Handle attribute(
      check(H5Acreate2(object.id(), name.c_str(), type.id(), space.id(), H5P_DEFAULT, H5P_DEFAULT), action));
  check(H5Awrite(attribute.id(), type.id(), value.c_str()), action);
}

std::string read_attribute(const Handle& object, const std::string& name) {
  const std::string action = fmt::format("read attribute {}", name);
  const Handle attribute(check(H5Aopen(object.id(), name.c_str(), H5P_DEFAULT), action));
  const Handle type(check(H5Aget_type(attribute.id()), action));
  std::string value(H5Tget_size(type.id()), '\0');
  check(H5Aread(attribute.id(), type.id(), value.data()), action);
  return value.substr(0, value.find('\0'));
}

Handle open_dataset(const Handle& parent, const std::string& path) {
  prepare();
  return Handle(check(H5Dopen2(parent.id(), path.c_str(), H5P_DEFAULT), fmt::format("open dataset {}", path)));
}

Shape shape_of(const Handle& dataset) {
  prepare();
  const Handle space(check(H5Dget_space(dataset.id()), "open a data space"));
  Shape shape(static_cast<std::size_t>(check(H5Sget_simple_extent_ndims(space.id()), "read a shape")));
  if (!shape.empty()) check(H5Sget_simple_extent_dims(space.id(), shape.data(), nullptr), "read a shape");
  return shape;
}

void write_all(const Handle& dataset, const double* data) {
  prepare();
  check(H5Dwrite(dataset.id(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, data), "write to the record");
}
void write_all(const Handle& dataset, const int* data) {
  prepare();
  check(H5Dwrite(dataset.id(), H5T_NATIVE_INT, H5S_ALL, H5S_ALL, H5P_DEFAULT, data), "write to the record");
}

void write_row(const Handle& dataset, hsize_t row, const std::vector<double>& values) {
  write_rows(dataset, row, 1, values);
}
void write_row(const Handle& dataset, hsize_t row, std::int64_t value) {
  write_selected(dataset, row, 1, H5T_NATIVE_INT64, &value, 1);
}
void write_rows(const Handle& dataset, hsize_t begin, hsize_t count, const std::vector<double>& values) {
  write_selected(dataset, begin, count, H5T_NATIVE_DOUBLE, values.data(), values.size());
}
void write_rows(const Handle& dataset, hsize_t begin, hsize_t count, const std::vector<std::int64_t>& values) {
  write_selected(dataset, begin, count, H5T_NATIVE_INT64, values.data(), values.size());
}

void write_scalar(const Handle& dataset, int value) { write_all(dataset, &value); }

void write_text(const Handle& dataset, const std::vector<std::string>& texts) {
  if (texts.empty()) return;
  prepare();
  const Handle type(check(H5Dget_type(dataset.id()), "read a type"));
  const std::size_t length = H5Tget_size(type.id());
  std::string buffer(length * texts.size(), '\0');
  for (std::size_t i = 0; i < texts.size(); ++i) {
    buffer.replace(i * length, cut_at_character(texts[i], length), texts[i], 0, cut_at_character(texts[i], length));
  }
  check(H5Dwrite(dataset.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, buffer.data()), "write to the record");
}

std::vector<double> read_rows(const Handle& dataset, hsize_t begin, hsize_t count) {
  const Handle space(check(H5Dget_space(dataset.id()), "open a data space"));
  std::vector<double> values(select_rows(space, shape_of(dataset), begin, count));
  if (values.empty()) return values;
  const Handle memory = make_space({values.size()});
  check(H5Dread(dataset.id(), H5T_NATIVE_DOUBLE, memory.id(), space.id(), H5P_DEFAULT, values.data()),
        "read the record");
  return values;
}

std::vector<double> read_all(const Handle& dataset) {
  const Shape shape = shape_of(dataset);
  std::vector<double> values(std::accumulate(shape.begin(), shape.end(), hsize_t{1}, std::multiplies<>()));
  check(H5Dread(dataset.id(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), "read the record");
  return values;
}

std::vector<std::string> read_text(const Handle& dataset) {
  const Handle type(check(H5Dget_type(dataset.id()), "read a type"));
  if (H5Tget_class(type.id()) != H5T_STRING) throw std::runtime_error("the dataset does not hold text");
  const std::size_t length = H5Tget_size(type.id());
  const Shape shape = shape_of(dataset);
  const hsize_t n = std::accumulate(shape.begin(), shape.end(), hsize_t{1}, std::multiplies<>());
  std::string buffer(length * n, '\0');
  check(H5Dread(dataset.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, buffer.data()), "read the record");
  std::vector<std::string> texts;
  for (hsize_t i = 0; i < n; ++i) {
    const std::string padded = buffer.substr(i * length, length);
    texts.push_back(padded.substr(0, padded.find('\0')));
  }
  return texts;
}

void flush(const Handle& file) {
  prepare();
  check(H5Fflush(file.id(), H5F_SCOPE_GLOBAL), "flush the record");
}

}  // namespace interply::record
