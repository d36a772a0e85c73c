#include "solve/vumat.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cfenv>
#include <cmath>
#include <cstring>
#include <mutex>

#include "scene/files.hpp"
#include "scene/read_scene.hpp"
#include "solve/vumat_utilities.hpp"

namespace interply::solve {

using mechanics::Matrix2;

namespace {

constexpr double kProbe = 1e-6;           // strain of compute_tangents()
constexpr double kProbeIncrement = 1e-6;  // s, dt of the calls before the start
constexpr double kPlane = 1e-4;           // largest stress 33 of examine(), beside that in the plane

/// The length of cmname comes last, by value; a routine in C may leave it out.
using Entry = void (*)(const int* jblock, const int* ndir, const int* nshr, const int* nstatev, const int* nfieldv,
                       const int* nprops, const int* info, const double* step_time, const double* total_time,
                       double* dt, const char* cmname, double* coord_mp, double* char_length, double* props,
                       double* density, double* strain_inc, double* rel_spin_inc, double* temp_old, double* stretch_old,
                       double* defgrad_old, double* field_old, double* stress_old, double* state_old,
                       double* ener_intern_old, double* ener_inelas_old, double* temp_new, double* stretch_new,
                       double* defgrad_new, double* field_new, double* stress_new, double* state_new,
                       double* ener_intern_new, double* ener_inelas_new, std::size_t cmname_length);

/// Routines that Abaqus/Explicit calls beside a VUMAT, and on which its results depend.
constexpr const char* kNeeded[] = {"vexternaldb", "vusdfld", "vufield", "vucharlength", "vuexpan", "vumatht"};
/// Routines of other jobs that may lie in the same file.
constexpr const char* kOthers[] = {"vuhard", "vuanisohyper_inv", "vuanisohyper_strain", "vuhyperel",  "vueos",
                                   "vfabric", "vucreepnetwork",  "vuviscosity",         "vuel",       "vuinter",
                                   "vdload", "vdisp",            "vuamp",               "vfric",      "vfric_coef",
                                   "vwave",  "vuflux",           "vfriction",           "vuinteraction"};

/// Layers that share a process may share a library, whose author knows of one thread.
std::mutex& one_at_a_time() {
  static std::mutex mutex;
  return mutex;
}

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

void* find_symbol(void* library, const std::string& name) {
  void* symbol = dlsym(library, (name + "_").c_str());
  return symbol ? symbol : dlsym(library, name.c_str());
}

LawName make_law_name(const scene::VumatLaw& law, const std::string& layer) {
  return {fmt::format("layer {}: law.vumat.library: {}", layer, law.library.path), nullptr};
}

/// dlerror() with what can be done about it.
std::string explain_load_failure(const std::string& why) {
  const std::string undefined = "undefined symbol: ";
  if (const auto at = why.find(undefined); at != std::string::npos) {
    std::string symbol = why.substr(at + undefined.size());
    symbol = symbol.substr(0, symbol.find_first_of(" ,("));
    return fmt::format(
        "calls {}, which neither it nor interply has; link it in, or leave the call out (of the utility routines of "
        "Abaqus there are {})",
        symbol, list_vumat_utilities());
  }
  return fmt::format(
      "cannot be loaded ({}); build it on a machine of this kind with gfortran -shared -fPIC, all that it calls "
      "included",
      why);
}

/// @param name  of the law; gets its flush
std::shared_ptr<void> load(const scene::VumatLaw& law, const std::string& layer, LawName& name, void*& entry) {
  const auto refuse = [&](const std::string& why) { throw scene::SceneError(fmt::format("{} {}", name.text, why)); };
  if (!law.library.digest.empty()) scene::read_resolved(law.library, fmt::format("layer {}: law.vumat.library", layer));
  install_law_guard();
  std::shared_ptr<void> library;
  {
    const std::lock_guard lock(one_at_a_time());
    const LawCall call(name);  // a library may have code of its own for this
    library = open_library(law.library.path);
  }
  if (!library) {
    const char* why = dlerror();
    refuse(explain_load_failure(why ? why : "no reason given"));
  }
  entry = find_symbol(library.get(), "vumat");
  if (!entry) refuse("has neither the symbol vumat_ nor vumat; name the subroutine VUMAT");
  for (const char* routine : kNeeded)
    if (find_symbol(library.get(), routine))
      refuse(fmt::format("has the routine {0} beside VUMAT, which is never called here; do in VUMAT what {0} does, and "
                         "leave it out",
                         routine));
  name.flush = reinterpret_cast<void (*)(const int*)>(dlsym(library.get(), "_gfortran_flush_i4"));
  return library;
}

std::array<char, 80> make_material_name(const std::string& layer) {
  std::array<char, 80> name;
  name.fill(' ');
  std::transform(layer.begin(), layer.begin() + static_cast<std::ptrdiff_t>(std::min(layer.size(), name.size())),
                 name.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return name;
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

namespace {

/// The arrays of one call, in the order of their memory.
enum Argument {
  Dt, Coord, Length, Props, Density, StrainInc, Spin, TempOld, StretchOld, DefgradOld, FieldOld, StressOld, StateOld,
  InternOld, InelasOld, TempNew, StretchNew, DefgradNew, FieldNew, StressNew, StateNew, InternNew, InelasNew, kArguments
};
constexpr const char* kNames[kArguments] = {
    "dt",       "coordMp",       "charLength",    "props",   "density",    "strainInc",  "relSpinInc", "tempOld",
    "stretchOld", "defgradOld",  "fieldOld",      "stressOld", "stateOld", "enerInternOld", "enerInelasOld", "tempNew",
    "stretchNew", "defgradNew",  "fieldNew",      "stressNew", "stateNew", "enerInternNew", "enerInelasNew"};
constexpr Argument kWritten[] = {StrainInc, StressNew, StateNew, InternNew, InelasNew};

/// A word that no law computes by chance, and another one beside each array: copying from there shows, too.
constexpr double fence(int argument) { return 1.0 / (17 + argument); }

}  // namespace

/// Arguments of one call with the leading dimension n: component c of point i at i + c n. Between the arrays lie
/// fences, as wide as kFencedColumns further components: what is written beyond an array is seen and harms nothing.
struct VumatPoints::Block {
  static constexpr int kFencedColumns = 32;

  Block(int n_most, int n_state, const std::vector<double>& parameters) : jblock(static_cast<std::size_t>(4 + n_most)) {
    const int columns[kArguments] = {2, 3, 1, 0, 1, 4, 1, 1, 4, 5, 0, 4, n_state, 1, 1, 1, 4, 5, 0, 4, n_state, 1, 1};
    const std::size_t wide = static_cast<std::size_t>(kFencedColumns * n_most);
    std::size_t at = wide;
    for (int k = 0; k < kArguments; ++k) {
      per_point[k] = columns[k];
      constant[k] = k == Dt ? 1 : k == Props ? static_cast<int>(parameters.size()) : 0;
      start[k] = at;
      at += static_cast<std::size_t>(columns[k] * n_most + constant[k]) + wide;
    }
    start[kArguments] = at;
    words.assign(at, fence(-1));
    set_size(n_most);
  }

  int n = 0;
  double step_time = 0, total_time = 0;
  std::array<int, kArguments> per_point{}, constant{};
  std::array<std::size_t, kArguments + 1> start{};
  std::vector<double> words;
  std::vector<int> jblock;

  int count(int k) const { return per_point[k] * n + constant[k]; }
  std::size_t end(int k) const { return start[k] + static_cast<std::size_t>(count(k)); }
  double* array(int k) { return words.data() + start[k]; }
  const double* array(int k) const { return words.data() + start[k]; }
  double& at(int k, int component, int i) { return array(k)[i + component * n]; }
  double get(int k, int component, int i) const { return array(k)[i + component * n]; }
  void copy(int from, int to) { std::copy_n(array(from), count(from), array(to)); }

  /// Lays the fences for calls of n points.
  void set_size(int points) {
    if (n == points) return;
    n = points;
    for (int k = 0; k < kArguments; ++k) {
      std::fill_n(array(k), count(k), 0.0);
      std::fill(words.begin() + static_cast<std::ptrdiff_t>(end(k)),
                words.begin() + static_cast<std::ptrdiff_t>(start[k + 1]), fence(k));
    }
  }

  /// The array beside which a word has changed, or -1. Cheap: the words that touch the arrays.
  int find_breach() const {
    for (int k = 0; k < kArguments; ++k)
      if (words[end(k)] != fence(k) || words[start[k] - 1] != fence(k - 1)) return k;
    return -1;
  }
  /// The same for the first point of every further component of the arrays that a law writes.
  int find_far_breach() const {
    for (const int k : kWritten)
      for (int c = 1; c < kFencedColumns; ++c)
        if (words[end(k) + static_cast<std::size_t>(c * n)] != fence(k)) return k;
    return -1;
  }
  /// The same for every word.
  int find_any_breach() const {
    if (const int k = find_breach(); k >= 0) return k;
    for (int k = 0; k < kArguments; ++k)
      for (std::size_t i = end(k); i < start[k + 1]; ++i)
        if (words[i] != fence(k)) return k;
    return -1;
  }

  std::string describe_breach(int k) const {
    const std::string outside = fmt::format("writes outside its argument {}, which has ", kNames[k]);
    if (k == StateOld || k == StateNew)
      return outside + fmt::format("{} per point; set law.vumat.state_variables to what the law uses", per_point[k]);
    if (per_point[k] == 0) return outside + fmt::format("{} values; correct the law", constant[k]);
    return outside + fmt::format("{} components; correct the law: it must obey ndir 3, nshr 1 of shells and membranes",
                                 per_point[k]);
  }
};

VumatPoints::VumatPoints(const scene::VumatLaw& law, const std::string& layer, double density, Eigen::Index n_elements,
                         int n_sections)
    : law_(make_law_name(law, layer)),
      library_(load(law, layer, law_, entry_)),
      name_(make_material_name(layer)),
      parameters_(law.parameters),
      density_(density),
      n_elements_(n_elements),
      stress_(Rows::Zero(4, n_elements * n_sections)),
      stretch_(Rows::Ones(4, n_elements * n_sections)),
      state_(Rows::Zero(law.state_variables, n_elements * n_sections)),
      energy_(Rows::Zero(2, n_elements * n_sections)),
      block_(std::make_unique<Block>(static_cast<int>(std::min<Eigen::Index>(n_elements, kVumatBlock)),
                                     law.state_variables, law.parameters)) {
  stretch_.row(3).setZero();
  const VumatIncrement at_rest{.strain = Matrix2::Zero(), .stretch = Matrix2::Identity()};
  try {
    compute_tangents(0, 1, &at_rest, {}, &initial_tangent_);
  } catch (const mechanics::Divergence& e) {
    throw scene::SceneError(e.what());
  }
  if (!initial_tangent_.allFinite() || !(initial_tangent_.diagonal().maxCoeff() > 0))
    throw scene::SceneError(fmt::format(
        "{}: the first calls give the stiffnesses {:.4g}, {:.4g} and {:.4g} MPa (11, 22, 12), but a law must resist "
        "small strains at stepTime = 0; check law.vumat.parameters and state_variables",
        law_.text, initial_tangent_(0, 0), initial_tangent_(1, 1), initial_tangent_(2, 2)));
}

VumatPoints::~VumatPoints() = default;

void VumatPoints::fill(Eigen::Index first, int n, const VumatIncrement* increments, const Instant& now) {
  Block& b = *block_;
  b.set_size(n);
  const auto copy = [&](const Rows& rows, Eigen::Index row, int k, int component) {
    std::copy_n(&rows(row, first), n, b.array(k) + component * n);
  };
  for (int c = 0; c < 4; ++c) {
    copy(stress_, c, StressOld, c);
    copy(stretch_, c, StretchOld, c);
    copy(stretch_, c, DefgradOld, c);
  }
  copy(stretch_, 3, DefgradOld, 4);
  copy(energy_, 0, InternOld, 0);
  copy(energy_, 1, InelasOld, 0);
  for (int c = 0; c < n_state(); ++c) copy(state_, c, StateOld, c);
  for (int i = 0; i < n; ++i) {
    const VumatIncrement& at = increments[i];
    const Matrix2 &de = at.strain, &u = at.stretch;
    const double f33 = stretch_(2, first + i);
    const double strain[4] = {de(0, 0), de(1, 1), 0, de(0, 1)};
    const double gradient[5] = {u(0, 0), u(1, 1), f33, u(0, 1), u(0, 1)};
    for (int c = 0; c < 3; ++c) b.at(Coord, c, i) = at.position(c);
    for (int c = 0; c < 4; ++c) b.at(StrainInc, c, i) = strain[c];
    for (int c = 0; c < 4; ++c) b.at(StretchNew, c, i) = gradient[c];
    for (int c = 0; c < 5; ++c) b.at(DefgradNew, c, i) = gradient[c];
    b.at(Length, 0, i) = at.length;
    b.at(Spin, 0, i) = at.spin;
    b.at(Density, 0, i) = density_ / (u.determinant() * f33);
    b.at(TempOld, 0, i) = b.at(TempNew, 0, i) = 0;
  }
  std::copy(parameters_.begin(), parameters_.end(), b.array(Props));
  b.array(Dt)[0] = now.dt > 0 ? now.dt : kProbeIncrement;
  b.copy(StressOld, StressNew);  // a law that writes nothing leaves everything as it is
  b.copy(StateOld, StateNew);
  b.copy(InternOld, InternNew);
  b.copy(InelasOld, InelasNew);

  b.step_time = b.total_time = now.time;
  const std::array<int, 4> place{n, 1, 1, static_cast<int>(first / n_elements_) + 1};
  std::copy(place.begin(), place.end(), b.jblock.begin());
  for (int i = 0; i < n; ++i) b.jblock[static_cast<std::size_t>(4 + i)] = static_cast<int>(first % n_elements_) + i + 1;
}

void VumatPoints::invoke() {
  Block& b = *block_;
  const std::array<int, 16> info{};  // lanneal, which is an array in newer releases
  const int three = 3, one = 1, none = 0, states = n_state(), parameters = static_cast<int>(parameters_.size());
  const std::lock_guard lock(one_at_a_time());
  const LawCall call(law_);
  reinterpret_cast<Entry>(entry_)(
      b.jblock.data(), &three, &one, &states, &none, &parameters, info.data(), &b.step_time, &b.total_time, b.array(Dt),
      name_.data(), b.array(Coord), b.array(Length), b.array(Props), b.array(Density), b.array(StrainInc),
      b.array(Spin), b.array(TempOld), b.array(StretchOld), b.array(DefgradOld), b.array(FieldOld), b.array(StressOld),
      b.array(StateOld), b.array(InternOld), b.array(InelasOld), b.array(TempNew), b.array(StretchNew),
      b.array(DefgradNew), b.array(FieldNew), b.array(StressNew), b.array(StateNew), b.array(InternNew),
      b.array(InelasNew), name_.size());
}

void VumatPoints::call(Eigen::Index first, int n, const VumatIncrement* increments, const Instant& now) {
  fill(first, n, increments, now);
  invoke();
  check_fences(first, n);
}

/// After every call what is near, once in a round over the points what is far.
void VumatPoints::check_fences(Eigen::Index first, int n) const {
  int breach = block_->find_breach();
  if (breach < 0 && first + n == size()) breach = block_->find_far_breach();
  if (breach < 0) return;
  throw mechanics::Divergence(fmt::format("{} {}", law_.text, block_->describe_breach(breach)));
}

Matrix2 VumatPoints::called_stress(int i) const {
  const Block& b = *block_;
  Matrix2 stress;
  const double shear = b.get(StressNew, 3, i);
  stress << b.get(StressNew, 0, i), shear, shear, b.get(StressNew, 1, i);
  return stress;
}

void VumatPoints::advance(Eigen::Index first, int n, const VumatIncrement* increments, const Instant& now) {
  call(first, n, increments, now);
  const Block& b = *block_;
  const auto keep = [&](int k, int component, Rows& rows, Eigen::Index row) {
    std::copy_n(b.array(k) + component * n, n, &rows(row, first));
  };
  for (int i = 0; i < n; ++i) {
    stretch_(2, first + i) *= std::exp(b.get(StrainInc, 2, i));
    stress_33_ = std::max(stress_33_, std::abs(b.get(StressNew, 2, i)));
  }
  for (int c = 0; c < 4; ++c) keep(StressNew, c, stress_, c);
  for (const int c : {0, 1, 3}) keep(StretchNew, c, stretch_, c);
  keep(InternNew, 0, energy_, 0);
  keep(InelasNew, 0, energy_, 1);
  for (int c = 0; c < n_state(); ++c) keep(StateNew, c, state_, c);
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
        const Matrix2 change = (called_stress(i) - response(first + i).stress) / size;
        const Eigen::Vector3d column(change(0, 0), change(1, 1), change(0, 1));
        const bool stiffer = size > 0 || !(column.norm() <= tangents[i].col(j).norm());
        if (stiffer) tangents[i].col(j) = column;
      }
    }
  }
  for (int i = 0; i < n; ++i) tangents[i] = ((tangents[i] + tangents[i].transpose()) / 2).eval();
}

namespace {

/// Stretch of point e in step k of examine(): small, and another one for each point and component.
Matrix2 make_stretch(Eigen::Index e, int k) {
  const double x = kProbe * k * (1 + 0.01 * static_cast<double>(e));
  Matrix2 u;
  u << 1 + 5 * x, 2 * x, 2 * x, 1 - 3 * x;
  return u;
}

}  // namespace

std::vector<std::string> VumatPoints::examine() {
  Block& b = *block_;
  std::vector<std::string> warnings;
  std::vector<VumatIncrement> increments(static_cast<std::size_t>(std::min<Eigen::Index>(n_elements_, kVumatBlock)));
  const auto refuse = [&](const std::string& why) { throw scene::SceneError(fmt::format("{} {}", law_.text, why)); };
  const auto in_blocks = [&](const auto& body) {
    for (Eigen::Index first = 0; first < size(); first += n_elements_)
      for (Eigen::Index e = 0; e < n_elements_; e += kVumatBlock)
        body(first + e, e, static_cast<int>(std::min<Eigen::Index>(kVumatBlock, n_elements_ - e)));
  };
  const auto prepare = [&](Eigen::Index first, Eigen::Index e, int n, int k) {
    for (int i = 0; i < n; ++i) {
      const Matrix2 u = make_stretch(e + i, k);
      auto& increment = increments[static_cast<std::size_t>(i)];
      increment = compute_vumat_increment(stretch(first + i), u * u);
      increment.position = {1.0 + static_cast<double>(e + i), 2, 3};
    }
  };
  const auto at_step = [](int k) { return Instant{.time = k * kProbeIncrement, .dt = kProbeIncrement}; };

  bool changed[kArguments] = {};
  const auto look = [&](Eigen::Index first, Eigen::Index e, int n, int k) {
    prepare(first, e, n, k);
    fill(first, n, increments.data(), at_step(k));
    const std::vector<double> given = b.words;
    invoke();
    if (const int breach = b.find_any_breach(); breach >= 0)
      refuse(b.describe_breach(breach));
    for (int a = 0; a < kArguments; ++a)
      if (std::find(std::begin(kWritten), std::end(kWritten), a) == std::end(kWritten))
        changed[a] |= !std::equal(b.array(a), b.array(a) + b.count(a), given.data() + b.start[a]);
    double in_plane = 0, normal = 0;
    for (int i = 0; i < n; ++i) {
      in_plane = std::max(in_plane, called_stress(i).cwiseAbs().maxCoeff());
      normal = std::max(normal, std::abs(b.get(StressNew, 2, i)));
      if (!called_stress(i).allFinite() || !std::isfinite(b.get(StrainInc, 2, i)))
        refuse("returns a stress or thickness strain that is not finite for strains of 1e-5; check "
               "law.vumat.parameters and state_variables");
    }
    if (normal > kPlane * in_plane)
      refuse(fmt::format("gives the stress 33 of {:.3g} MPa beside {:.3g} MPa in the plane: it is written for solids, "
                         "but laws of shells and membranes are plane stress (ndir 3, nshr 1); let it give "
                         "stressNew(:,3) = 0 and leave the thickness strain in strainInc(:,3)",
                         normal, in_plane));
    advance(first, n, increments.data(), at_step(k));
  };
  for (int k = 1; k <= 3; ++k)
    in_blocks([&](Eigen::Index first, Eigen::Index e, int n) { look(first, e, n, k); });

  // the same call before and after others
  std::vector<std::vector<double>> before;
  bool differs = false;
  for (const int round : {0, 1}) {
    std::size_t block = 0;
    in_blocks([&](Eigen::Index first, Eigen::Index e, int n) {
      prepare(first, e, n, 4);
      rehearse(first, n, increments.data(), at_step(4));
      if (round == 0) before.push_back(b.words);
      differs |= round == 1 &&
                 std::memcmp(before[block].data(), b.words.data(), b.words.size() * sizeof(double)) != 0;
      ++block;
    });
  }
  for (int a = 0; a < kArguments; ++a)
    if (changed[a])
      warnings.push_back(fmt::format("{} changes its argument {}, which is read only: the change is lost", law_.text,
                                     kNames[a]));
  if (differs)
    warnings.push_back(fmt::format(
        "{} answers the same call differently when asked again: it keeps something outside its state variables (SAVE, "
        "COMMON, a module) or reads what was never set, so its results are those of no one history",
        law_.text));
  for (const char* routine : kOthers)
    if (find_symbol(library_.get(), routine))
      warnings.push_back(fmt::format("{} has the routine {} beside VUMAT; it is never called", law_.text, routine));
  return warnings;
}

double VumatPoints::largest_stress_33() const {
  return stress_33_ > 1e-8 * initial_tangent_.diagonal().maxCoeff() ? stress_33_ : 0;
}

void VumatPoints::add_state_to(mechanics::Digest& digest) const {
  digest.add(stress_);
  digest.add(stretch_);
  digest.add(state_);
}

}  // namespace interply::solve
