/// The checked scene as plain structs. Units: mm, t, s, N, MPa; angles in degrees where the name says so.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace interply::scene {

/// A file that the scene names (scene/files.hpp).
struct File {
  std::string path;    ///< absolute in a resolved scene
  std::string digest;  ///< XXH3 of the content and all that it includes, 16 hexadecimal digits; empty until it is read
};

/// One value per fibre direction, [warp, weft].
struct Pair {
  double warp = 0;
  double weft = 0;
};

/// The five variants of the paper's Fig. 4 (solver_fabric/THEORY.md).
enum class Variant { Fabric, Uncoupled, Full, Biaxial, NormalShear };

/// Piecewise linear table, abscissa strictly ascending, straight on beyond both ends.
using Table = std::vector<std::array<double, 2>>;

/// Tables of variant `fabric`: work-conjugate nominal stress (MPa) over engineering strain, shear over gamma (rad).
/// warp and weft: T = dW/dlambda; shear: tau = dW/dgamma, given for gamma >= 0 and continued oddly.
struct FabricTables {
  Table warp, weft, shear;
};

/// Membrane law of a woven ply (solver_fabric/THEORY.md, paper eq. 1-11).
struct WovenLaw {
  Variant variant = Variant::Full;
  Pair a{5.5e3, 5.5e3};                        ///< cubic tensile coefficient, MPa
  Pair b{100, 100};                            ///< quadratic tensile coefficient, MPa
  Pair c{25, 25};                              ///< biaxial coupling, -
  Pair p_min{0.75, 0.75};                      ///< lower bound of k_TC, in [0, 1]
  Pair d{100, 100};                            ///< compression coefficient, MPa
  std::array<double, 3> s{0.17, -0.53, 0.63};  ///< shear polynomial, MPa
  Pair s_T{200, 200};                          ///< tension-shear coupling, MPa
  Pair s_C{1000, 1000};                        ///< compression-shear reduction, -
  /// transverse strain beyond which exp(c e_t) goes on linearly; infinity = none
  Pair strain_cap{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  std::optional<FabricTables> tables;  ///< variant fabric only; sampled from the parameters if absent
};

/// sigma_y = K (e0 + p)^n, MPa
struct Swift {
  double K = 530, e0 = 0.0065, n = 0.23;
};

/// sigma_y = s_inf - (s_inf - s0) exp(-rate p), MPa
struct Voce {
  double s0 = 0, s_inf = 0, rate = 0;
};

/// sigma_y = s_inf - (s_inf - s0) exp(-rate p^n), MPa
struct HockettSherby {
  double s0 = 0, s_inf = 0, rate = 0, n = 0;
};

/// (p, sigma_y in MPa) ascending from p = 0, constant beyond the last point
struct HardeningTable {
  Table points;
};

using Hardening = std::variant<Swift, Voce, HockettSherby, HardeningTable>;

/// Width / thickness plastic strain of bars cut at 0, 45 and 90 deg to the rolling direction.
struct Hill48 {
  double r0 = 1, r45 = 1, r90 = 1;
};

/// Isotropic elasticity with J2 plasticity (solver_metal/THEORY.md).
struct J2Law {
  double young = 210e3;  ///< MPa
  double poisson = 0.3;
  Hardening hardening = Swift{};
  std::optional<Hill48> hill48;  ///< hardening is then that of the rolling direction, the layer's orientation
};

/// One point in the plane, or points through the thickness.
enum class Integration { Membrane, Shell };

/// A law of the user's own (services/solve/vumat.hpp).
struct VumatLaw {
  File library;                    ///< shared library
  std::vector<double> parameters;  ///< props
  int state_variables = 0;         ///< nstatev, zero at the start
  Integration integration = Integration::Membrane;
};

using Law = std::variant<WovenLaw, J2Law, VumatLaw>;
enum class Kind { Fabric, Metal };

/// A flat mesh from a Gmsh .msh or Abaqus .inp file (geometry/blank_mesh.hpp).
struct MeshFile {
  File file;
  std::string set;  ///< physical surface or element set; empty: every element
};

struct Layer {
  std::string name;
  double thickness = 1.0;      ///< mm
  double density = 0;          ///< t/mm3, without mass scaling
  double orientation_deg = 0;  ///< direction of the warp, or of rolling, from x
  Law law;
  Pair bending{2.2, 2.2};           ///< fabric: bending stiffness per width, N mm
  double twist = 1.1;               ///< fabric: M12 = twist * 2 kappa12, N mm; default sqrt(warp*weft)/2
  int integration_points = 5;       ///< metal: Gauss-Lobatto points through the thickness (1 = membrane)
  int threads = 1;                  ///< worker threads of this layer's process
  std::optional<MeshFile> mesh;     ///< in place of the blank's
  std::optional<double> mesh_size;  ///< in place of a rectangular blank's, mm
  Kind kind() const {
    if (const auto* own = std::get_if<VumatLaw>(&law))
      return own->integration == Integration::Membrane ? Kind::Fabric : Kind::Metal;
    return std::holds_alternative<WovenLaw>(law) ? Kind::Fabric : Kind::Metal;
  }
};

/// Diagonals of a rectangular blank's mesh: through its centre, or around it (mechanics/mesh.hpp).
enum class Diagonals { Centre, Around };

/// A rectangle, or any outline by its mesh. The mesh of a half model is its part y >= 0.
struct Blank {
  double length = 280;           ///< along x, mm; centred on x = 0
  double width = 280;            ///< along y, mm; centred on y = 0
  bool half = true;              ///< model y >= 0 only, symmetry plane y = 0
  double mesh_size = 4;          ///< mm
  Diagonals diagonals = Diagonals::Centre;
  std::optional<MeshFile> mesh;  ///< instead of length, width, mesh_size and diagonals
};

/// Regular triangular pyramid (inner sharp edge and height) offset by a ball, prismatic above its base; points down.
struct Punch {
  double edge = 100, height = 50, radius = 15;  ///< mm
  std::optional<File> stl;                      ///< instead: any surface
};

/// Plate with a triangular opening of edge `edge` offset by `offset`, shoulder radius `shoulder`.
struct Opening {
  double edge = 100, offset = 22, shoulder = 10;  ///< mm
  std::optional<File> stl;                        ///< instead: any surface
};

struct BlankHolder {
  Opening opening;
  double pressure = 2;    ///< MPa on the initial flange area (STL: where it touches the flat blank)
  double ramp = 1e-3;     ///< s, smooth
  double mass_ratio = 1;  ///< mass / mass of the blank
  double damping = 0.1;   ///< fraction of critical on the stack's stiffness
};

struct Tools {
  std::optional<Punch> punch;  ///< absent: the stack is only squeezed
  Opening die;
  BlankHolder blank_holder;
};

struct Motion {
  double stroke = 60;           ///< mm, downwards
  double forming_time = 15e-3;  ///< s, smooth step after the blank-holder ramp
};

/// Friction coefficient between two named neighbours (layers or tools).
struct PairFriction {
  std::string first, second;
  double coefficient = 0;
};

struct Contact {
  double reference_pressure = 10;   ///< MPa
  double penetration = 0.02;        ///< allowed at the reference pressure / thinner layer's thickness
  double damping = 0.05;            ///< fraction of critical
  double tangential_stiffness = 1;  ///< / normal stiffness
  int threads = 1;                  ///< worker threads of the coordinator
  double tool_steel = 0.10, tool_fabric = 0.15, steel_fabric = 0.25, fabric_fabric = 0.25, steel_steel = 0.15;
  std::vector<PairFriction> pairs;  ///< overrides between two named neighbours (layers or tools)
};

struct Time {
  double safety = 0.9;         ///< fraction of the stable increment
  double mass_scaling = 1;     ///< factor on every density
  int vote_every = 20;         ///< steps between evaluations of the tangent, 1 to 100
  double energy_limit = 0.02;  ///< largest energy residual / energy scale
};

struct Exchange {
  std::string address = "shm";   ///< exchange/zeromq.hpp; "shm" or "ipc" alone: at a private path
  double startup_deadline = 60;  ///< s
  double wait_deadline = 60;     ///< s without a message before a participant counts as lost
};

struct Observe {
  std::string network = "127.0.0.1";  ///< address of the interface that DDS uses
  bool multicast = false;
  int domain = 0;
};

struct Record {
  int frames = 30;        ///< beside the initial one, evenly in time
  int history = 1000;     ///< rows, evenly in time
  int history_every = 0;  ///< steps; 0: by `history`
};

struct Scene {
  std::string name = "scene";
  Blank blank;
  std::vector<Layer> layers;  ///< bottom to top
  Tools tools;
  Motion motion;
  Contact contact;
  Time time;
  Exchange exchange;
  Observe observe;
  Record record;
  std::string text;          ///< resolved scene, YAML with every default written out
  std::uint64_t digest = 0;  ///< of `text`; participants of one run must agree on it

  double end_time() const { return tools.blank_holder.ramp + motion.forming_time; }
};

}  // namespace interply::scene
