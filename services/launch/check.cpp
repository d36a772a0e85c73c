#include "launch/check.hpp"

#include <fmt/format.h>

#include <ostream>

#include "coordinator/quantity.hpp"
#include "launch/datacheck.hpp"
#include "launch/run.hpp"
#include "scene/read_scene.hpp"

namespace interply::launch {
namespace {

using datacheck::Datacheck;

std::string format_duration(double seconds) {
  if (seconds < 90) return fmt::format("{:.0f} s", seconds);
  if (seconds < 5400) return fmt::format("{:.0f} min", seconds / 60);
  if (seconds < 2 * 86400) return fmt::format("{:.1f} h", seconds / 3600);
  return fmt::format("{:.0f} days", seconds / 86400);
}

std::string format_bytes(double mebi) {
  return mebi < 4096 ? fmt::format("{:.0f} MiB", mebi) : fmt::format("{:.1f} GiB", mebi / 1024);
}

void print_layers(const Datacheck& check, std::ostream& out) {
  out << fmt::format("{:<15} {:<18} {:>5} {:>5} {:>8} {:>8} {:>7} {:>7}\n", "layer", "law", "deg", "mm", "nodes",
                     "elements", "g", "us");
  for (int i = check.layers_size() - 1; i >= 0; --i) {  // top layer first, as they lie
    const datacheck::Layer& l = check.layers(i);
    out << fmt::format("{:<15} {:<18} {:>5g} {:>5g} {:>8} {:>8} {:>7.2f} {:>7.3g}\n", l.name(), l.law(),
                       l.orientation().value(), l.thickness().value(), l.nodes().value(), l.elements().value(),
                       l.mass().value(), l.increment().value());
  }
  double mass = 0, added = 0;
  for (const datacheck::Layer& l : check.layers()) {
    mass += l.mass().value();
    added += l.added_mass().value();
  }
  if (added > 0) out << fmt::format("mass scaling adds {:.2f} g to these {:.2f} g\n", added, mass);
}

void print_interfaces(const Datacheck& check, std::ostream& out) {
  out << fmt::format("\n{:<34} {:>8} {:>17}\n", "interface", "friction", "stiffness MPa/mm");
  for (int i = check.interfaces_size() - 1; i >= 0; --i) {
    const datacheck::Interface& k = check.interfaces(i);
    out << fmt::format("{:<34} {:>8g} {:>17.4g}\n", k.name(), k.friction().value(), k.stiffness().value());
  }
}

void print_tools(const Datacheck& check, std::ostream& out) {
  out << '\n';
  for (const datacheck::Tool& t : check.tools()) {
    out << fmt::format("{:<13} {}\n{:13} ", t.name(), t.shape(), "");
    out << (t.size_z().value() > 0
                ? fmt::format("{:.4g} x {:.4g} x {:.4g} mm", t.size_x().value(), t.size_y().value(), t.size_z().value())
                : fmt::format("opening {:.4g} x {:.4g} mm", t.size_x().value(), t.size_y().value()));
    out << fmt::format(", touches at z = {:.4g} mm", t.touching_height().value());
    if (t.moved().value() != 0) out << fmt::format(" (moved by {:.4g})", t.moved().value());
    if (t.has_smallest_radius()) out << fmt::format(", radius {:.3g} mm", t.smallest_radius().value());
    out << '\n';
  }
}

void print_motion(const Datacheck& check, std::ostream& out) {
  const datacheck::Motion& m = check.motion();
  out << fmt::format("\nmotion      {:g} mm in {:g} ms, the punch at up to {:.3g} m/s; blank holder {:.4g} kN\n",
                     m.stroke().value(), m.time().value(), m.largest_speed().value(), m.holder_force().value());
  if (m.has_kinetic_share())
    out << fmt::format("inertia     roughly {:.1g} % of the work when the punch is fastest\n",
                       m.kinetic_share().value());
}

void print_cost(const Datacheck& check, std::ostream& out) {
  const datacheck::Cost& c = check.cost();
  out << fmt::format("increment   {:.3g} us, in whose fastest mode {} moves most; it falls later\n",
                     c.increment().value(), c.fastest());
  out << fmt::format("steps       at least {:.0f} with {:.0f} frames\n", c.steps().value(), c.frames().value());
  out << fmt::format("memory      about {} in {:.0f} processes", format_bytes(c.memory().value()),
                     c.processes().value());
  if (c.has_free_memory()) out << fmt::format("; {} are free", format_bytes(c.free_memory().value()));
  out << fmt::format("\nrecord      about {}", format_bytes(c.record().value()));
  if (c.has_free_disk())
    out << fmt::format("; {} are free for runs/{}", format_bytes(c.free_disk().value()), check.scene());
  out << fmt::format("\ntime        about {} on {:.0f} cores like these\n", format_duration(c.wall_time().value()),
                     c.cores().value());
}

}  // namespace

int check_command(const CheckOptions& options, std::ostream& out) {
  const Datacheck check = check_data(scene::read_scene(options.scene, options.overrides, options.overlays));
  if (options.json) {
    out << coordinator::format_json(check) << '\n';
    return kDone;
  }
  out << fmt::format("{}: {} layer{}, {}, {}\n\n", check.scene(), check.layers_size(),
                     check.layers_size() == 1 ? "" : "s", check.blank(), check.modelled_part());
  print_layers(check, out);
  print_interfaces(check, out);
  print_tools(check, out);
  print_motion(check, out);
  print_cost(check, out);
  for (const auto& warning : check.warnings()) out << "warning     " << warning << '\n';
  return kDone;
}

}  // namespace interply::launch
