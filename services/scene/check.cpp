#include "scene/check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <set>

#include "process/words.hpp"

namespace interply::scene {
namespace {

constexpr double kMostElements = 1e8;  ///< of a layer: 12 GB to check it (39 million took 4.7), and indices are 32 bits

void check_ascending(const Table& table, const std::string& path, Report& report) {
  if (table.size() < 2) return report.add(path, "needs at least two rows [x, y]");
  for (std::size_t i = 1; i < table.size(); ++i) {
    if (table[i][0] > table[i - 1][0]) continue;
    return report.add(join(path, i), "abscissa " + to_text(table[i][0]) + " is not above the one before it, " +
                                         to_text(table[i - 1][0]));
  }
}

/// Strictly ascending abscissa, and an ordinate that never falls: a falling one is a negative stiffness, and the ply
/// would tear itself apart there. The last row counts, too: the table goes straight on beyond it.
void check_fabric_table(const Table& table, const std::string& path, Report& report) {
  check_ascending(table, path, report);
  for (std::size_t i = 1; i < table.size(); ++i) {
    if (report.is_broken(path) || table[i][1] >= table[i - 1][1]) continue;
    return report.add(join(path, i), "stress " + to_text(table[i][1]) + " MPa is below the one before it, " +
                                         to_text(table[i - 1][1]) + " MPa: a falling table is a negative stiffness");
  }
}

/// First shear angle in [0, pi/2] at which d tau/d gamma = s1 + 2 s2 g + 3 s3 g^2 <= 0 (solver_fabric/THEORY.md), rad.
std::optional<double> find_shear_softening(const std::array<double, 3>& s) {
  const double c0 = s[0], c1 = 2 * s[1], c2 = 3 * s[2], last = std::numbers::pi / 2;
  if (c0 <= 0) return 0.0;
  // Smallest positive root, in the form that does not cancel: g = 2 c0 / (-c1 + sqrt(c1^2 - 4 c0 c2)).
  const double discriminant = c1 * c1 - 4 * c0 * c2;
  if (discriminant < 0) return std::nullopt;
  const double denominator = -c1 + std::sqrt(discriminant);
  if (denominator <= 0 || 2 * c0 > last * denominator) return std::nullopt;
  return 2 * c0 / denominator;
}

void check_woven(const WovenLaw& law, const std::string& path, Report& report) {
  if (const auto angle = find_shear_softening(law.s); angle && !report.is_broken(join(path, "s")))
    report.add(join(path, "s"), "the shear stiffness s1 + 2 s2 g + 3 s3 g^2 is not positive at " +
                                    to_rounded(*angle * 180 / std::numbers::pi) + " deg, as it must be up to 90 deg");
  const std::string tables = join(path, "tables");
  if (!law.tables || report.is_broken(tables)) return;
  if (law.variant != Variant::Fabric && !report.is_broken(join(path, "variant")))
    report.add(tables, "belongs to variant fabric only");
  check_fabric_table(law.tables->warp, join(tables, "warp"), report);
  check_fabric_table(law.tables->weft, join(tables, "weft"), report);
  check_fabric_table(law.tables->shear, join(tables, "shear"), report);
  const Table& shear = law.tables->shear;
  if (!shear.empty() && (shear[0][0] != 0 || shear[0][1] != 0))
    report.add(join(join(tables, "shear"), std::size_t{0}), "must be [0, 0], as the table is continued oddly");
}

void check_hardening_table(const Table& table, const std::string& path, Report& report) {
  check_ascending(table, path, report);
  if (!table.empty() && table[0][0] != 0)
    report.add(join(path, std::size_t{0}), "plastic strain " + to_text(table[0][0]) + " is not 0 in the first row");
  for (std::size_t i = 0; i < table.size(); ++i) {
    const double stress = table[i][1];
    if (stress <= 0)
      report.add(join(path, i), "yield stress " + to_text(stress) + " is not in (0, inf) MPa");
    else if (i > 0 && stress < table[i - 1][1])
      report.add(join(path, i), "yield stress " + to_text(stress) + " is below the one before it, " +
                                    to_text(table[i - 1][1]) + "; softening is not supported");
  }
}

void check_saturation(double s0, double s_inf, const std::string& path, Report& report) {
  if (report.is_broken(path) || s_inf >= s0) return;
  report.add(join(path, "s_inf"), to_text(s_inf) + " is below s0 = " + to_text(s0) + "; softening is not supported");
}

void check_j2(const J2Law& law, const std::string& path, Report& report) {
  const std::string hardening = join(path, "hardening");
  if (report.is_broken(hardening)) return;
  if (const auto* voce = std::get_if<Voce>(&law.hardening)) {
    check_saturation(voce->s0, voce->s_inf, join(hardening, "voce"), report);
  } else if (const auto* hockett = std::get_if<HockettSherby>(&law.hardening)) {
    check_saturation(hockett->s0, hockett->s_inf, join(hardening, "hockett_sherby"), report);
  } else if (const auto* table = std::get_if<HardeningTable>(&law.hardening)) {
    check_hardening_table(table->points, join(hardening, "table"), report);
  }
}

const std::vector<std::string> kTools{"punch", "die", "blank_holder"};
const std::vector<std::string> kRoles{"coordinator", "recorder", "monitor"};

bool is_word(const std::string& name) {
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  return !name.empty() && is_letter(name[0]) && name.size() <= 64 && std::all_of(name.begin(), name.end(), [&](char c) {
    return is_letter(c) || (c >= '0' && c <= '9') || c == '_' || c == '-';
  });
}

/// Names become file groups, topics and program arguments.
void check_name(const Scene& scene, std::size_t i, const std::string& path, Report& report) {
  const std::string& name = scene.layers[i].name;
  if (report.is_broken(path)) return;
  if (!is_word(name))
    report.add(path, "'" + name + "' must be at most 64 letters, digits, '_' and '-', starting with a letter");
  if (std::find(kTools.begin(), kTools.end(), name) != kTools.end())
    report.add(path, "'" + name + "' is the name of a tool; choose another");
  if (std::find(kRoles.begin(), kRoles.end(), name) != kRoles.end())
    report.add(path, "'" + name + "' is the name of another process of a run; choose another");
  for (std::size_t k = 0; k < i; ++k) {
    if (scene.layers[k].name != name) continue;
    return report.add(path, "'" + name + "' is already the name of layers[" + std::to_string(k) + "]");
  }
}

void check_mesh_size(const Blank& blank, double mesh_size, const std::string& path, Report& report) {
  const double half = std::min(blank.length, blank.width) / 2;
  if (report.is_broken("blank") || report.is_broken(path)) return;
  const double elements = 2 * blank.length * blank.width / (blank.half ? 2 : 1) / (mesh_size * mesh_size);
  if (elements > kMostElements)
    return report.add(path, to_text(mesh_size) + " mm would make " + to_rounded(elements) +
                                " elements of each layer, and " + to_rounded(kMostElements) + " are the most; " +
                                to_rounded(mesh_size * std::sqrt(elements / kMostElements)) + " mm would do");
  if (mesh_size < half) return;
  report.add(path,
             to_text(mesh_size) + " is not below " + to_rounded(half) + " mm, half of the smaller side of the blank");
}

void check_blank(const Scene& scene, Report& report) {
  const Blank& blank = scene.blank;
  if (!blank.mesh) return check_mesh_size(blank, blank.mesh_size, "blank.mesh_size", report);
  for (const char* key : {"length", "width", "mesh_size", "diagonals"})
    if (report.is_given(join("blank", key)))
      report.add(join("blank", key), "and blank.mesh are both given; keep one of them");
}

/// A layer's mesh in place of the blank's.
void check_own_mesh(const Scene& scene, std::size_t i, Report& report) {
  const Layer& layer = scene.layers[i];
  const std::string path = join(join("layers", i), "mesh_size");
  if (!layer.mesh_size) return;
  if (layer.mesh) return report.add(path, "and mesh are both given; keep one of them");
  if (scene.blank.mesh) return report.add(path, "needs a rectangular blank; give this layer a mesh of its own");
  check_mesh_size(scene.blank, *layer.mesh_size, path, report);
}

bool is_same(const Pair& pair) { return pair.warp == pair.weft; }

bool is_same_in_both_fibres(const Layer& layer) {
  if (const auto* w = std::get_if<WovenLaw>(&layer.law))
    return is_same(w->a) && is_same(w->b) && is_same(w->c) && is_same(w->p_min) && is_same(w->d) && is_same(w->s_T) &&
           is_same(w->s_C) && is_same(w->strain_cap) && is_same(layer.bending) &&
           (!w->tables || w->tables->warp == w->tables->weft);
  const auto* j2 = std::get_if<J2Law>(&layer.law);
  return j2 && j2->hill48 && j2->hill48->r0 == j2->hill48->r90;
}

/// A half model mirrors its layers in y = 0: fibres at 0 and 90 deg become themselves, fibres at 45 deg become the
/// other ones, and fibres at any other angle belong to no half model.
void check_mirrored(const Scene& scene, std::size_t i, Report& report) {
  const Layer& layer = scene.layers[i];
  const auto* j2 = std::get_if<J2Law>(&layer.law);
  if (!scene.blank.half || (j2 && !j2->hill48)) return;
  const double off = std::abs(std::remainder(layer.orientation_deg, 90));
  if (off < 1e-9 || (off > 45 - 1e-9 && is_same_in_both_fibres(layer))) return;
  report.add(
      join(join("layers", i), "orientation"),
      to_text(layer.orientation_deg) + " deg is another direction in the mirrored half; set blank.symmetry: full");
}

void check_layers(const Scene& scene, Report& report) {
  if (scene.layers.empty() && !report.is_broken("layers"))
    report.add("layers", "the stack is empty; give at least one layer");
  for (std::size_t i = 0; i < scene.layers.size(); ++i) {
    const std::string path = join("layers", i);
    check_name(scene, i, join(path, "name"), report);
    check_law(scene.layers[i].law, join(path, "law"), report);
    check_own_mesh(scene, i, report);
    if (report.is_broken(join(path, "law"))) continue;
    check_mirrored(scene, i, report);
    const bool fabric = scene.layers[i].kind() == Kind::Fabric;
    if (std::holds_alternative<VumatLaw>(scene.layers[i].law) && scene.layers[i].threads > 1)
      report.add(join(path, "threads"), "a vumat is called from one thread; set 1");
    for (const char* key : {"bending", "twist", "integration_points"}) {
      const bool for_fabric = std::string(key) != "integration_points";
      if (report.is_given(join(path, key)) && for_fabric != fabric)
        report.add(join(path, key), std::string("belongs to a ") + (for_fabric ? "fabric" : "metal") + " layer only");
    }
  }
}

/// Smallest distance between a punch and an opening around it, mm: the support function of a triangle of edge e lies
/// between its inradius e/(2 sqrt 3) and its circumradius e/sqrt 3.
double compute_clearance(const Opening& opening, const Punch& punch) {
  const double wider = (opening.edge - punch.edge) / std::numbers::sqrt3;
  return opening.offset - punch.radius + std::min(wider / 2, wider);
}

void check_clearances(const Scene& scene, Report& report) {
  if (!scene.tools.punch || scene.tools.punch->stl || report.is_broken("tools") || report.is_broken("layers")) return;
  double stack = 0;
  for (const Layer& layer : scene.layers) stack += layer.thickness;
  const double die = compute_clearance(scene.tools.die, *scene.tools.punch);
  if (!scene.tools.die.stl && die < stack * (1 - 1e-12))
    report.add("tools.die.offset", "leaves " + to_rounded(die) + " mm between punch and die, less than the " +
                                       to_rounded(stack) + " mm of the stack");
  const double holder = compute_clearance(scene.tools.blank_holder.opening, *scene.tools.punch);
  if (!scene.tools.blank_holder.opening.stl && holder <= 0)
    report.add("tools.blank_holder.offset",
               "leaves " + to_rounded(holder) + " mm between punch and blank holder, so the punch does not pass");
}

/// A tool is either parameters or a surface.
void check_either(const std::optional<File>& stl, const std::string& path, const std::vector<std::string>& keys,
                  Report& report) {
  if (!stl) return;
  for (const std::string& key : keys)
    if (report.is_given(join(path, key))) report.add(join(path, key), "and stl are both given; keep one of them");
}

/// The triangle has its centre in the origin and a vertex on the x axis: its circumradius reaches out along x, half an
/// edge along y.
void check_inside_blank(const Opening& opening, const Blank& blank, const std::string& path, Report& report) {
  if (opening.stl || blank.mesh || report.is_broken("blank") || report.is_broken(path)) return;
  const double rim = opening.offset + opening.shoulder;
  const double x = opening.edge / std::numbers::sqrt3 + rim, y = opening.edge / 2 + rim;
  if (x >= blank.length / 2 || y >= blank.width / 2)
    report.add(path, "opening and shoulder reach " + to_rounded(x) + " mm along x and " + to_rounded(y) +
                         " mm along y, beyond the half blank of " + to_rounded(blank.length / 2) + " x " +
                         to_rounded(blank.width / 2) + " mm");
}

/// Neighbours in contact: consecutive layers, die and lowest layer, punch or blank holder and uppermost layer.
bool are_neighbours(const std::vector<std::string>& stack, const std::string& first, const std::string& second) {
  const auto touches = [&](const std::string& a, const std::string& b) {
    if (a == "die") return !stack.empty() && b == stack.front();
    if (a == "punch" || a == "blank_holder") return !stack.empty() && b == stack.back();
    const auto at = std::find(stack.begin(), stack.end(), a);
    return at != stack.end() && at + 1 != stack.end() && *(at + 1) == b;
  };
  return touches(first, second) || touches(second, first);
}

void check_friction_pairs(const Scene& scene, Report& report) {
  if (report.is_broken("layers")) return;
  std::vector<std::string> stack;
  for (const Layer& layer : scene.layers) stack.push_back(layer.name);
  std::vector<std::string> known = stack;
  known.insert(known.end(), kTools.begin(), kTools.end());
  std::set<std::set<std::string>> seen;
  for (std::size_t i = 0; i < scene.contact.pairs.size(); ++i) {
    const auto& [first, second, coefficient] = scene.contact.pairs[i];
    const std::string path = join(join("friction.pairs", i), "between");
    if (report.is_broken(path)) continue;
    bool all_known = true;
    for (const std::string& name : {first, second}) {
      if (std::find(known.begin(), known.end(), name) != known.end()) continue;
      report.add(path, "'" + name + "' is no layer or tool" + suggest(name, known));
      all_known = false;
    }
    if (!all_known) continue;
    if (!are_neighbours(stack, first, second))
      report.add(path, "'" + first + "' and '" + second + "' are not neighbours");
    if (!seen.insert({first, second}).second) report.add(path, "'" + first + "' and '" + second + "' are given twice");
  }
}

/// "host:port", port in [1, 65535]; an IPv6 host in brackets. Whether this host can listen there, launch/run.hpp finds.
bool is_host_and_port(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string::npos || colon == 0) return false;
  const bool in_brackets = text[0] == '[' && text[colon - 1] == ']';
  if (!in_brackets && text.find(':') != colon) return false;
  int port = 0;
  const char* end = text.data() + text.size();
  const auto [last, error] = std::from_chars(text.data() + colon + 1, end, port);
  return error == std::errc{} && last == end && port >= 1 && port <= 65535;
}

/// The name becomes that of a folder.
void check_run_name(const Scene& scene, Report& report) {
  const std::string& name = scene.name;
  const bool is_plain = process::to_line(name) == name && name.find('/') == std::string::npos && name.size() <= 100;
  if (is_plain && !name.empty() && name[0] != '.' && name[0] != '-') return;
  if (!report.is_broken("name"))
    report.add("name",
               fmt::format("'{}' cannot name the folder of a run: give 1 to 100 printable characters without '/', "
                           "not beginning with '.' or '-'",
                           process::to_line(name, 100)));
}

void check_addresses(const Scene& scene, Report& report) {
  const std::string& address = scene.exchange.address;
  const bool is_private = address == "shm" || address == "ipc";
  const bool is_path = (address.starts_with("shm://") || address.starts_with("ipc://")) && address.size() > 6;
  const bool is_tcp = address.starts_with("tcp://") && is_host_and_port(address.substr(6));
  if (!is_private && !is_path && !is_tcp && !report.is_broken("exchange.address"))
    report.add("exchange.address", "'" + address + "' is not shm, ipc, shm://path, ipc://path or tcp://host:port");
  if (scene.observe.network.empty() && !report.is_broken("observe.network"))
    report.add("observe.network", "is empty; give the address of a network interface, such as 127.0.0.1");
}

}  // namespace

void check_law(const Law& law, const std::string& path, Report& report) {
  if (const auto* woven = std::get_if<WovenLaw>(&law)) check_woven(*woven, join(path, "woven"), report);
  if (const auto* j2 = std::get_if<J2Law>(&law)) check_j2(*j2, join(path, "j2"), report);
}

void check_scene(const Scene& scene, Report& report) {
  check_run_name(scene, report);
  check_blank(scene, report);
  check_layers(scene, report);
  if (scene.tools.punch) check_either(scene.tools.punch->stl, "tools.punch", {"edge", "height", "radius"}, report);
  check_either(scene.tools.die.stl, "tools.die", {"edge", "offset", "shoulder"}, report);
  check_either(scene.tools.blank_holder.opening.stl, "tools.blank_holder", {"edge", "offset", "shoulder"}, report);
  check_clearances(scene, report);
  check_inside_blank(scene.tools.die, scene.blank, "tools.die", report);
  check_inside_blank(scene.tools.blank_holder.opening, scene.blank, "tools.blank_holder", report);
  check_friction_pairs(scene, report);
  check_addresses(scene, report);
}

}  // namespace interply::scene
