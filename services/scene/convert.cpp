#include "scene/convert.hpp"

#include <cmath>

#include "scene/copy_fields.hpp"

namespace interply::scene {
namespace {

// Enumerators are copied by number.
static_assert(static_cast<int>(Variant::Fabric) == schema::WovenLaw::fabric);
static_assert(static_cast<int>(Variant::Uncoupled) == schema::WovenLaw::uncoupled);
static_assert(static_cast<int>(Variant::Full) == schema::WovenLaw::full);
static_assert(static_cast<int>(Variant::Biaxial) == schema::WovenLaw::biaxial);
static_assert(static_cast<int>(Variant::NormalShear) == schema::WovenLaw::normal_shear);
static_assert(static_cast<int>(Integration::Membrane) == schema::VumatLaw::membrane);
static_assert(static_cast<int>(Integration::Shell) == schema::VumatLaw::shell);
static_assert(static_cast<int>(Diagonals::Centre) == schema::Blank::centre);
static_assert(static_cast<int>(Diagonals::Around) == schema::Blank::around);
static_assert(schema::Blank::full == 0 && schema::Blank::half == 1);  // Blank::half as a number

template <class Io>
void map(Io& io, File& x) {
  io("path", x.path);
  io("digest", x.digest);
}

template <class Io>
void map(Io& io, Pair& x) {
  io("warp", x.warp);
  io("weft", x.weft);
}

template <class Io>
void map(Io& io, std::array<double, 2>& x) {
  io("x", x[0]);
  io("y", x[1]);
}

template <class Io>
void map(Io& io, std::array<double, 3>& x) {
  io("s1", x[0]);
  io("s2", x[1]);
  io("s3", x[2]);
}

template <class Io>
void map(Io& io, Table& x) {
  io.items("points", x);
}

template <class Io>
void map(Io& io, FabricTables& x) {
  io("warp", x.warp);
  io("weft", x.weft);
  io("shear", x.shear);
}

template <class Io>
void map(Io& io, WovenLaw& x) {
  io("variant", x.variant);
  io("a", x.a);
  io("b", x.b);
  io("c", x.c);
  io("p_min", x.p_min);
  io("d", x.d);
  io("s", x.s);
  io("s_T", x.s_T);
  io("s_C", x.s_C);
  io("strain_cap", x.strain_cap);
  io.may_be_absent("tables", x.tables);
}

template <class Io>
void map(Io& io, Swift& x) {
  io("K", x.K);
  io("e0", x.e0);
  io("n", x.n);
}

template <class Io>
void map(Io& io, Voce& x) {
  io("s0", x.s0);
  io("s_inf", x.s_inf);
  io("rate", x.rate);
}

template <class Io>
void map(Io& io, HockettSherby& x) {
  io("s0", x.s0);
  io("s_inf", x.s_inf);
  io("rate", x.rate);
  io("n", x.n);
}

template <class Io>
void map(Io& io, HardeningTable& x) {
  map(io, x.points);
}

template <class Io>
void map(Io& io, Hardening& x) {
  io.template alternative<Swift>("swift", x);
  io.template alternative<Voce>("voce", x);
  io.template alternative<HockettSherby>("hockett_sherby", x);
  io.template alternative<HardeningTable>("table", x);
}

template <class Io>
void map(Io& io, Hill48& x) {
  io("r0", x.r0);
  io("r45", x.r45);
  io("r90", x.r90);
}

template <class Io>
void map(Io& io, J2Law& x) {
  io("young", x.young);
  io("poisson", x.poisson);
  io("hardening", x.hardening);
  io.may_be_absent("hill48", x.hill48);
}

template <class Io>
void map(Io& io, VumatLaw& x) {
  io("library", x.library);
  io.numbers("parameters", x.parameters);
  io("state_variables", x.state_variables);
  io("integration", x.integration);
}

template <class Io>
void map(Io& io, Law& x) {
  io.template alternative<WovenLaw>("woven", x);
  io.template alternative<J2Law>("j2", x);
  io.template alternative<VumatLaw>("vumat", x);
}

/// Isotropic estimate of the twisting stiffness: half the geometric mean of the bending stiffnesses.
double default_twist(const Pair& bending) { return std::sqrt(bending.warp * bending.weft) / 2; }

template <class Io>
void map(Io& io, MeshFile& x) {
  io("file", x.file);
  if (Io::kReading || !x.set.empty()) io("set", x.set);
}

template <class Io>
void map(Io& io, Layer& x) {
  io("name", x.name);
  io("thickness", x.thickness);
  io("density", x.density);
  io("orientation", x.orientation_deg);
  io("law", x.law);
  if (Io::kReading || x.kind() == Kind::Fabric) {
    io("bending", x.bending);
    if (Io::kReading) x.twist = default_twist(x.bending);
    io("twist", x.twist);
  }
  if (Io::kReading || x.kind() == Kind::Metal) io("integration_points", x.integration_points);
  io("threads", x.threads);
  io.may_be_absent("mesh", x.mesh);
  io.may_be_absent("mesh_size", x.mesh_size);
}

template <class Io>
void map(Io& io, Blank& x) {
  io("symmetry", x.half);
  io.may_be_absent("mesh", x.mesh);
  if (!Io::kReading && x.mesh) return;
  io("length", x.length);
  io("width", x.width);
  io("mesh_size", x.mesh_size);
  io("diagonals", x.diagonals);
}

template <class Io>
void map(Io& io, Punch& x) {
  io.may_be_absent("stl", x.stl);
  if (!Io::kReading && x.stl) return;
  io("edge", x.edge);
  io("height", x.height);
  io("radius", x.radius);
}

template <class Io>
void map(Io& io, Opening& x) {
  io.may_be_absent("stl", x.stl);
  if (!Io::kReading && x.stl) return;
  io("edge", x.edge);
  io("offset", x.offset);
  io("shoulder", x.shoulder);
}

template <class Io>
void map(Io& io, BlankHolder& x) {
  map(io, x.opening);
  io("pressure", x.pressure);
  io("ramp", x.ramp);
  io("mass_ratio", x.mass_ratio);
  io("damping", x.damping);
}

template <class Io>
void map(Io& io, Tools& x) {
  io.may_be_absent("punch", x.punch);
  io("die", x.die);
  io("blank_holder", x.blank_holder);
}

template <class Io>
void map(Io& io, Motion& x) {
  io("stroke", x.stroke);
  io("forming_time", x.forming_time);
}

template <class Io>
void map(Io& io, PairFriction& x) {
  io.block("between", [&x](auto& between) {
    between("first", x.first);
    between("second", x.second);
  });
  io("coefficient", x.coefficient);
}

/// The scene file keeps friction apart from the other contact settings.
template <class Io>
void map(Io& io, Contact& x) {
  io.block("contact", [&x](auto& contact) {
    contact("reference_pressure", x.reference_pressure);
    contact("penetration", x.penetration);
    contact("damping", x.damping);
    contact("tangential_stiffness", x.tangential_stiffness);
    contact("threads", x.threads);
  });
  io.block("friction", [&x](auto& friction) {
    friction("tool_steel", x.tool_steel);
    friction("tool_fabric", x.tool_fabric);
    friction("steel_fabric", x.steel_fabric);
    friction("fabric_fabric", x.fabric_fabric);
    friction("steel_steel", x.steel_steel);
    friction.items("pairs", x.pairs);
  });
}

template <class Io>
void map(Io& io, Time& x) {
  io("safety", x.safety);
  io("mass_scaling", x.mass_scaling);
  io("vote_every", x.vote_every);
  io("energy_limit", x.energy_limit);
}

template <class Io>
void map(Io& io, Exchange& x) {
  io("address", x.address);
  io("startup_deadline", x.startup_deadline);
  io("wait_deadline", x.wait_deadline);
}

template <class Io>
void map(Io& io, Observe& x) {
  io("network", x.network);
  io("multicast", x.multicast);
  io("domain", x.domain);
}

template <class Io>
void map(Io& io, Record& x) {
  io("frames", x.frames);
  io("history", x.history);
  io("history_every", x.history_every);
}

template <class Io>
void map(Io& io, Scene& x) {
  io("name", x.name);
  io("blank", x.blank);
  io.items("layers", x.layers);
  io("tools", x.tools);
  io("motion", x.motion);
  map(io, x.contact);
  io("time", x.time);
  io("exchange", x.exchange);
  io("observe", x.observe);
  io("record", x.record);
}

}  // namespace

Scene to_scene(const schema::Scene& message) {
  Scene scene;
  FromMessage from{message};
  map(from, scene);
  return scene;
}

Law to_law(const schema::Law& message) {
  Law law;
  FromMessage from{message};
  map(from, law);
  return law;
}

schema::Scene to_message(Scene scene) {
  schema::Scene message;
  ToMessage to{message};
  map(to, scene);
  return message;
}

}  // namespace interply::scene
