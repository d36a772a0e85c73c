#include "scene/convert.hpp"

#include <cmath>
#include <stdexcept>
#include <type_traits>

namespace interply::scene {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

template <class T>
constexpr bool kIsScalar = std::is_arithmetic_v<T> || std::is_enum_v<T> || std::is_same_v<T, std::string>;

const FieldDescriptor* find_field(const Message& message, const char* key) {
  const FieldDescriptor* field = message.GetDescriptor()->FindFieldByName(key);
  if (!field) throw std::logic_error("proto/scene.proto: " + message.GetTypeName() + " has no field " + key);
  return field;
}

/// The two directions of a copy share their verbs, so that each struct is described once, by `map` below:
///     io(key, member)                    a number, word or nested struct
///     io.block(key, body)                a nested block without a struct of its own
///     io.items(key, vector)              a repeated field of blocks
///     io.numbers(key, vector)            a repeated field of numbers
///     io.may_be_absent(key, optional)    a nested struct
///     io.alternative<T>(key, variant)    a member of a oneof
struct FromMessage {
  static constexpr bool kReading = true;
  const Message& message;

  template <class T>
  void operator()(const char* key, T& x) {
    if (!has(key)) return;
    if constexpr (kIsScalar<T>) {
      copy_scalar(find_field(message, key), x);
    } else {
      block(key, [&x](auto& inner) { map(inner, x); });
    }
  }

  template <class Body>
  void block(const char* key, Body body) {
    if (!has(key)) return;
    FromMessage inner{message.GetReflection()->GetMessage(message, find_field(message, key))};
    body(inner);
  }

  template <class T>
  void items(const char* key, std::vector<T>& x) {
    const FieldDescriptor* field = find_field(message, key);
    for (int i = 0; i < message.GetReflection()->FieldSize(message, field); ++i) {
      FromMessage inner{message.GetReflection()->GetRepeatedMessage(message, field, i)};
      map(inner, x.emplace_back());
    }
  }

  void numbers(const char* key, std::vector<double>& x) {
    const FieldDescriptor* field = find_field(message, key);
    for (int i = 0; i < message.GetReflection()->FieldSize(message, field); ++i)
      x.push_back(message.GetReflection()->GetRepeatedDouble(message, field, i));
  }

  template <class T>
  void may_be_absent(const char* key, std::optional<T>& x) {
    if (has(key)) (*this)(key, x.emplace());
  }

  template <class T, class Variant>
  void alternative(const char* key, Variant& x) {
    if (has(key)) (*this)(key, x.template emplace<T>());
  }

 private:
  bool has(const char* key) const { return message.GetReflection()->HasField(message, find_field(message, key)); }

  template <class T>
  void copy_scalar(const FieldDescriptor* field, T& x) const {
    const auto& reflection = *message.GetReflection();
    if constexpr (std::is_same_v<T, std::string>) {
      x = reflection.GetString(message, field);
    } else if constexpr (std::is_same_v<T, double>) {
      x = reflection.GetDouble(message, field);
    } else if constexpr (std::is_same_v<T, int>) {
      x = reflection.GetInt32(message, field);
    } else if (field->cpp_type() == FieldDescriptor::CPPTYPE_BOOL) {
      x = static_cast<T>(reflection.GetBool(message, field));
    } else {
      x = static_cast<T>(reflection.GetEnumValue(message, field));
    }
  }
};

struct ToMessage {
  static constexpr bool kReading = false;
  Message& message;

  template <class T>
  void operator()(const char* key, T& x) {
    if constexpr (kIsScalar<T>) {
      copy_scalar(find_field(message, key), x);
    } else {
      block(key, [&x](auto& inner) { map(inner, x); });
    }
  }

  template <class Body>
  void block(const char* key, Body body) {
    ToMessage inner{*message.GetReflection()->MutableMessage(&message, find_field(message, key))};
    body(inner);
  }

  template <class T>
  void items(const char* key, std::vector<T>& x) {
    for (T& item : x) {
      ToMessage inner{*message.GetReflection()->AddMessage(&message, find_field(message, key))};
      map(inner, item);
    }
  }

  void numbers(const char* key, std::vector<double>& x) {
    for (const double number : x) message.GetReflection()->AddDouble(&message, find_field(message, key), number);
  }

  template <class T>
  void may_be_absent(const char* key, std::optional<T>& x) {
    if (x) (*this)(key, *x);
  }

  template <class T, class Variant>
  void alternative(const char* key, Variant& x) {
    if (T* held = std::get_if<T>(&x)) (*this)(key, *held);
  }

 private:
  template <class T>
  void copy_scalar(const FieldDescriptor* field, const T& x) {
    const auto& reflection = *message.GetReflection();
    if constexpr (std::is_same_v<T, std::string>) {
      reflection.SetString(&message, field, x);
    } else if constexpr (std::is_same_v<T, double>) {
      reflection.SetDouble(&message, field, x);
    } else if constexpr (std::is_same_v<T, int>) {
      reflection.SetInt32(&message, field, x);
    } else if (field->cpp_type() == FieldDescriptor::CPPTYPE_BOOL) {
      reflection.SetBool(&message, field, static_cast<bool>(x));
    } else {
      reflection.SetEnumValue(&message, field, static_cast<int>(x));
    }
  }
};

// Enumerators are copied by number.
static_assert(static_cast<int>(Variant::Fabric) == schema::WovenLaw::fabric);
static_assert(static_cast<int>(Variant::Uncoupled) == schema::WovenLaw::uncoupled);
static_assert(static_cast<int>(Variant::Full) == schema::WovenLaw::full);
static_assert(static_cast<int>(Variant::Biaxial) == schema::WovenLaw::biaxial);
static_assert(static_cast<int>(Variant::NormalShear) == schema::WovenLaw::normal_shear);
static_assert(static_cast<int>(Integration::Membrane) == schema::VumatLaw::membrane);
static_assert(static_cast<int>(Integration::Shell) == schema::VumatLaw::shell);
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
