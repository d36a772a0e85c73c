#include "solve/vumat.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cfenv>
#include <cmath>
#include <mutex>

#include "scene/files.hpp"
#include "scene/read_scene.hpp"

namespace interply::solve {

using mechanics::Matrix2;

namespace {

constexpr double kProbe = 1e-6;           // strain of compute_tangents()
constexpr double kProbeIncrement = 1e-6;  // s, dt of the calls before the start

using Real = const double*;
using Integer = const int*;
/// The length of cmname comes last, by value; a routine in C may leave it out.
using Entry = void (*)(Integer nblock, Integer ndir, Integer nshr, Integer nstatev, Integer nfieldv, Integer nprops,
                       Integer lanneal, Real step_time, Real total_time, Real dt, const char* cmname, Real coord_mp,
                       Real char_length, Real props, Real density, double* strain_inc, Real rel_spin_inc, Real temp_old,
                       Real stretch_old, Real defgrad_old, Real field_old, Real stress_old, Real state_old,
                       Real ener_intern_old, Real ener_inelas_old, Real temp_new, Real stretch_new, Real defgrad_new,
                       Real field_new, double* stress_new, double* state_new, double* ener_intern_new,
                       double* ener_inelas_new, std::size_t cmname_length);

/// A library built with -ffast-math sets the loading thread to flush small numbers to zero: that must not change the
/// bits of anything else.
std::shared_ptr<void> open_library(const std::string& file) {
  std::fenv_t environment;
  std::fegetenv(&environment);
  void* library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  std::fesetenv(&environment);
  return {library, [](void* handle) {
            if (handle) dlclose(handle);
          }};
}

std::shared_ptr<void> load(const scene::VumatLaw& law, const std::string& layer, void*& entry) {
  const std::string& file = law.library.path;
  const auto refuse = [&](const std::string& why) {
    throw scene::SceneError(fmt::format("layer {}: law.vumat.library: {} {}", layer, file, why));
  };
  if (!law.library.digest.empty()) scene::read_resolved(law.library, fmt::format("layer {}: law.vumat.library", layer));
  auto library = open_library(file);
  if (!library) {
    const char* why = dlerror();
    refuse(fmt::format("cannot be loaded ({}); build it with gfortran -shared -fPIC, all that it calls included",
                       why ? why : "no reason given"));
  }
  entry = dlsym(library.get(), "vumat_");
  if (!entry) entry = dlsym(library.get(), "vumat");
  if (!entry) refuse("has neither the symbol vumat_ nor vumat; name the subroutine VUMAT");
  return library;
}

std::array<char, 80> make_material_name(const std::string& layer) {
  std::array<char, 80> name;
  name.fill(' ');
  std::transform(layer.begin(), layer.begin() + static_cast<std::ptrdiff_t>(std::min(layer.size(), name.size())),
                 name.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return name;
}

/// Layers that share a process may share a library, whose author knows of one thread.
std::mutex& one_at_a_time() {
  static std::mutex mutex;
  return mutex;
}

}  // namespace

Matrix2 compute_stretch(const Matrix2& metric) {
  const double j = std::sqrt(metric.determinant());
  return (metric + j * Matrix2::Identity()) / std::sqrt(metric.trace() + 2 * j);
}

VumatIncrement compute_vumat_increment(const Matrix2& old_stretch, const Matrix2& new_metric) {
  const Matrix2 old_metric = old_stretch * old_stretch;
  const Matrix2 inverse = compute_stretch((old_metric + new_metric) / 2).inverse();
  VumatIncrement increment;
  increment.strain = inverse * ((new_metric - old_metric) / 2) * inverse;  // (V1)
  increment.stretch = compute_stretch(new_metric);
  const Matrix2 rate = (increment.stretch - old_stretch) * inverse;
  increment.spin = (rate(1, 0) - rate(0, 1)) / 2;
  return increment;
}

void check_vumat(const scene::VumatLaw& law, const std::string& layer) {
  void* entry = nullptr;
  load(law, layer, entry);
}

/// Arguments of one call with the leading dimension n: component c of point i at i + c n.
struct VumatPoints::Block {
  explicit Block(int n_state)
      : state_old(static_cast<std::size_t>(std::max(1, n_state)) * kVumatBlock), state_new(state_old) {}

  template <int Components>
  using Columns = std::array<double, Components * kVumatBlock>;

  int n = 0;
  Columns<3> position{};
  Columns<1> length{}, density{}, spin{}, zero{};
  Columns<4> strain{}, stretch_old{}, stretch_new{}, stress_old{}, stress_new{};
  Columns<5> gradient_old{}, gradient_new{};
  Columns<2> energy_old{}, energy_new{};
  std::vector<double> state_old, state_new;

  template <class Array>
  void set(Array& array, int component, int i, double value) {
    array[static_cast<std::size_t>(i + component * n)] = value;
  }
  template <class Array>
  double get(const Array& array, int component, int i) const {
    return array[static_cast<std::size_t>(i + component * n)];
  }
};

VumatPoints::VumatPoints(const scene::VumatLaw& law, const std::string& layer, double density, Eigen::Index n_points)
    : library_(load(law, layer, entry_)),
      name_(make_material_name(layer)),
      parameters_(law.parameters),
      density_(density),
      stress_(Rows::Zero(4, n_points)),
      stretch_(Rows::Ones(4, n_points)),
      state_(Rows::Zero(law.state_variables, n_points)),
      energy_(Rows::Zero(2, n_points)),
      block_(std::make_unique<Block>(law.state_variables)) {
  stretch_.row(3).setZero();
  const VumatIncrement at_rest{.strain = Matrix2::Zero(), .stretch = Matrix2::Identity()};
  compute_tangents(0, 1, &at_rest, {}, &initial_tangent_);
  if (!initial_tangent_.allFinite() || !(initial_tangent_.diagonal().maxCoeff() > 0))
    throw scene::SceneError(fmt::format(
        "layer {}: law.vumat: the first calls give the stiffnesses {:.4g}, {:.4g} and {:.4g} MPa (11, 22, 12), but a "
        "law must resist small strains at stepTime = 0; check law.vumat.parameters and state_variables",
        layer, initial_tangent_(0, 0), initial_tangent_(1, 1), initial_tangent_(2, 2)));
}

VumatPoints::~VumatPoints() = default;

void VumatPoints::call(Eigen::Index first, int n, const VumatIncrement* increments, const Instant& now) {
  Block& b = *block_;
  b.n = n;
  const auto copy = [&](const Rows& rows, Eigen::Index row, auto& array, int component) {
    std::copy_n(&rows(row, first), n, array.begin() + component * n);
  };
  for (int c = 0; c < 4; ++c) {
    copy(stress_, c, b.stress_old, c);
    copy(stretch_, c, b.stretch_old, c);
    copy(stretch_, c, b.gradient_old, c);
  }
  copy(stretch_, 3, b.gradient_old, 4);
  for (int c = 0; c < 2; ++c) copy(energy_, c, b.energy_old, c);
  for (int c = 0; c < n_state(); ++c) copy(state_, c, b.state_old, c);
  for (int i = 0; i < n; ++i) {
    const VumatIncrement& at = increments[i];
    const Matrix2 &de = at.strain, &u = at.stretch;
    const double f33 = b.get(b.stretch_old, 2, i);
    const double strain[4] = {de(0, 0), de(1, 1), 0, de(0, 1)};
    const double gradient[5] = {u(0, 0), u(1, 1), f33, u(0, 1), u(0, 1)};
    for (int c = 0; c < 3; ++c) b.set(b.position, c, i, at.position(c));
    for (int c = 0; c < 4; ++c) b.set(b.strain, c, i, strain[c]);
    for (int c = 0; c < 4; ++c) b.set(b.stretch_new, c, i, gradient[c]);
    for (int c = 0; c < 5; ++c) b.set(b.gradient_new, c, i, gradient[c]);
    b.set(b.length, 0, i, at.length);
    b.set(b.spin, 0, i, at.spin);
    b.set(b.density, 0, i, density_ / (u.determinant() * f33));
  }
  b.stress_new = b.stress_old;  // a law that writes nothing leaves everything as it is
  b.energy_new = b.energy_old;
  std::copy(b.state_old.begin(), b.state_old.end(), b.state_new.begin());

  const int three = 3, one = 1, none = 0, states = n_state(), parameters = static_cast<int>(parameters_.size());
  const std::lock_guard lock(one_at_a_time());
  reinterpret_cast<Entry>(entry_)(&n, &three, &one, &states, &none, &parameters, &none, &now.time, &now.time, &now.dt,
                                  name_.data(), b.position.data(), b.length.data(), parameters_.data(),
                                  b.density.data(), b.strain.data(), b.spin.data(), b.zero.data(), b.stretch_old.data(),
                                  b.gradient_old.data(), b.zero.data(), b.stress_old.data(), b.state_old.data(),
                                  b.energy_old.data(), b.energy_old.data() + n, b.zero.data(), b.stretch_new.data(),
                                  b.gradient_new.data(), b.zero.data(), b.stress_new.data(), b.state_new.data(),
                                  b.energy_new.data(), b.energy_new.data() + n, name_.size());
}

VumatResponse VumatPoints::called(int i) const {
  const Block& b = *block_;
  VumatResponse r;
  const double shear = b.get(b.stress_new, 3, i);
  r.stress << b.get(b.stress_new, 0, i), shear, shear, b.get(b.stress_new, 1, i);
  r.thickness_stretch = b.get(b.stretch_old, 2, i) * std::exp(b.get(b.strain, 2, i));
  return r;
}

void VumatPoints::advance(Eigen::Index first, int n, const VumatIncrement* increments, const Instant& now) {
  call(first, n, increments, now);
  const Block& b = *block_;
  const auto keep = [&](const auto& array, int component, Rows& rows) {
    std::copy_n(array.begin() + component * n, n, &rows(component, first));
  };
  for (int i = 0; i < n; ++i) stretch_(2, first + i) = called(i).thickness_stretch;
  for (int c = 0; c < 4; ++c) keep(b.stress_new, c, stress_);
  for (const int c : {0, 1, 3}) keep(b.stretch_new, c, stretch_);
  for (int c = 0; c < 2; ++c) keep(b.energy_new, c, energy_);
  for (int c = 0; c < n_state(); ++c) keep(b.state_new, c, state_);
}

void VumatPoints::rehearse(Eigen::Index first, int n, const VumatIncrement* increments, const Instant& now) {
  call(first, n, increments, now);
}

VumatResponse VumatPoints::response(Eigen::Index point) const {
  VumatResponse r;
  r.stress << stress_(0, point), stress_(3, point), stress_(3, point), stress_(1, point);
  r.thickness_stretch = stretch_(2, point);
  return r;
}

Matrix2 VumatPoints::stretch(Eigen::Index point) const {
  Matrix2 u;
  u << stretch_(0, point), stretch_(3, point), stretch_(3, point), stretch_(1, point);
  return u;
}

void VumatPoints::compute_tangents(Eigen::Index first, int n, const VumatIncrement* increments, const Instant& now,
                                   Eigen::Matrix3d* tangents) {
  const Instant when{.time = now.time, .dt = now.dt > 0 ? now.dt : kProbeIncrement};
  std::array<VumatIncrement, kVumatBlock> probe;
  for (int j = 0; j < 3; ++j) {
    Matrix2 direction = Matrix2::Zero();
    (j < 2 ? direction(j, j) : direction(0, 1)) = j < 2 ? 1 : 0.5;
    direction(1, 0) = direction(0, 1);
    for (const double size : {kProbe, -kProbe}) {
      for (int i = 0; i < n; ++i) {
        const Matrix2 u = stretch(first + i);
        probe[i] = compute_vumat_increment(u, u * (Matrix2::Identity() + 2 * size * direction) * u);
        probe[i].position = increments[i].position;
        probe[i].length = increments[i].length;
      }
      call(first, n, probe.data(), when);
      for (int i = 0; i < n; ++i) {
        const Matrix2 change = (called(i).stress - response(first + i).stress) / size;
        const Eigen::Vector3d column(change(0, 0), change(1, 1), change(0, 1));
        const bool stiffer = size > 0 || !(column.norm() <= tangents[i].col(j).norm());
        if (stiffer) tangents[i].col(j) = column;
      }
    }
  }
  for (int i = 0; i < n; ++i) tangents[i] = ((tangents[i] + tangents[i].transpose()) / 2).eval();
}

void VumatPoints::add_state_to(mechanics::Digest& digest) const {
  digest.add(stress_);
  digest.add(stretch_);
  digest.add(state_);
}

}  // namespace interply::solve
