#include "coordinator/report.hpp"

#include <fmt/format.h>
#include <google/protobuf/util/json_util.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>
#include <utility>
#include <vector>

#include "coordinator/coordinator.hpp"
#include "coordinator/quantity.hpp"
#include "coordinator/verdict.hpp"
#include "solve/session.hpp"

namespace interply::coordinator {

namespace {

/// Inward displacement of the edge of a layer where it crosses the axes, mm: -x, +x, +y; and its largest displacement
/// in the plane.
struct DrawIn {
  double minus_x = 0, plus_x = 0, plus_y = 0, largest = 0;
};

/// Nodes of the sides that belong to one element only and do not lie in the symmetry plane.
std::vector<int> find_rim(const mechanics::TriangleMesh& mesh) {
  std::vector<bool> held(static_cast<std::size_t>(mesh.n_nodes()), false), rim(held.size(), false);
  for (const int node : mesh.symmetry_nodes) held[static_cast<std::size_t>(node)] = true;
  for (Eigen::Index e = 0; e < mesh.n_elements(); ++e)
    for (int k = 0; k < 3; ++k) {
      const auto a = static_cast<std::size_t>(mesh.triangles((k + 1) % 3, e));
      const auto b = static_cast<std::size_t>(mesh.triangles((k + 2) % 3, e));
      if (mesh.neighbours(k, e) < 0 && !(held[a] && held[b])) rim[a] = rim[b] = true;
    }
  std::vector<int> nodes;
  for (std::size_t i = 0; i < rim.size(); ++i)
    if (rim[i]) nodes.push_back(static_cast<int>(i));
  return nodes;
}

DrawIn measure_draw_in(const LayerSlot& slot) {
  const auto& reference = slot.mesh.reference;
  const mechanics::NodalVectors position = slot.geometry.positions();
  const double x_min = reference.row(0).minCoeff(), x_max = reference.row(0).maxCoeff();
  const double y_max = reference.row(1).maxCoeff();
  int ends[3] = {0, 0, 0};  // nodes nearest to (-x, 0), (+x, 0), (0, +y)
  double nearest[3] = {1e300, 1e300, 1e300}, largest = 0;
  const double targets[3][2] = {{x_min, 0}, {x_max, 0}, {0, y_max}};
  for (const int node : find_rim(slot.mesh)) {
    largest =
        std::max(largest, std::hypot(position(0, node) - reference(0, node), position(1, node) - reference(1, node)));
    for (int k = 0; k < 3; ++k) {
      const double d = std::hypot(reference(0, node) - targets[k][0], reference(1, node) - targets[k][1]);
      if (d < nearest[k]) {
        nearest[k] = d;
        ends[k] = node;
      }
    }
  }
  return {.minus_x = position(0, ends[0]) - reference(0, ends[0]),
          .plus_x = reference(0, ends[1]) - position(0, ends[1]),
          .plus_y = reference(1, ends[2]) - position(1, ends[2]),
          .largest = largest};
}

constexpr double kNegligible = 1e-3;  ///< mJ; a smaller internal energy gives no ratio

void set_draw_in(summary::DrawIn* to, const DrawIn& d) {
  set(to->mutable_minus_x(), d.minus_x, "mm");
  set(to->mutable_plus_x(), d.plus_x, "mm");
  set(to->mutable_plus_y(), d.plus_y, "mm");
  set(to->mutable_largest(), d.largest, "mm");
}

void set_outside(summary::OutsideTrust* to, const exchange::OutsideTrust& passed, double first_stroke) {
  to->set_quantity(passed.quantity);
  to->set_meaning(passed.meaning);
  set(to->mutable_limit(), passed.limit, passed.unit);
  set(to->mutable_worst(), passed.worst, passed.unit);
  set(to->mutable_area_share(), 100 * passed.share, "%");
  set(to->mutable_x(), passed.x, "mm");
  set(to->mutable_y(), passed.y, "mm");
  set(to->mutable_first_time(), 1e3 * passed.first_time, "ms");
  set(to->mutable_first_stroke(), first_stroke, "mm");
}

std::string describe_outside(const std::string& layer, const summary::OutsideTrust& o) {
  return fmt::format(
      "{}: {} beyond {:g} {} in {:.2g} % of its area, from {:.1f} mm stroke on, up to {:.3g} {} at ({:.1f}, {:.1f}) mm "
      "of the flat blank: {}",
      layer, o.quantity(), o.limit().value(), o.limit().unit(), o.area_share().value(), o.first_stroke().value(),
      o.worst().value(), o.worst().unit(), o.x().value(), o.y().value(), o.meaning());
}

/// One line, or as many as it takes to keep within 80 columns: what does not fit goes on below the first item.
void add_items(const std::string& head, const std::vector<std::string>& items, std::string& text) {
  std::string line = head;
  for (const std::string& item : items) {
    if (line.size() > head.size() && line.size() + 2 + item.size() > 80) {
      text += line + '\n';
      line.assign(head.size(), ' ');
    }
    line += "  " + item;
  }
  text += line + '\n';
}

std::string format_time(double seconds) {
  const long s = std::lround(seconds);
  return s < 60 ? fmt::format("{} s", s) : fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
}

}  // namespace

std::string format_progress(const Progress& p) {
  std::string line;  // what matters first: a narrow terminal cuts the end
  if (p.seconds_left >= 0) line += fmt::format("left {:>7}  ", format_time(p.seconds_left));
  if (!p.waiting_for.empty()) line += fmt::format("waiting for {}  ", p.waiting_for);
  line += fmt::format(
      "stroke {:5.1f} mm  punch {:.2f} kN  energy residual {:+.3f} %  step {:>7}  dt {:.2e} s  t {:.3f}/{:.3f} ms",
      p.stroke, 1e-3 * p.punch_force, 100 * p.residual, p.step, p.dt, 1e3 * p.time, 1e3 * p.end_time);
  return line;
}

summary::Summary summarise(const scene::Scene& scene, const Forming& forming, const EnergyBalance& end,
                           const std::vector<exchange::Final>& finals, double seconds) {
  summary::Summary s;
  const Pace& pace = forming.pace();
  std::int64_t elements = 0;
  for (int i = 0; i < forming.stack().n_layers(); ++i) elements += forming.stack().layer(i).mesh.n_elements();
  s.set_interply(exchange::kVersion);
  s.set_scene(scene.name);
  s.set_modelled_part(scene.blank.half ? "half model" : "full model");
  set(s.mutable_stroke(), forming.stroke(), "mm");
  set(s.mutable_time(), 1e3 * pace.time(), "ms");
  set(s.mutable_steps(), static_cast<double>(pace.step()), "-");
  set(s.mutable_wall_time(), seconds, "s");
  set(s.mutable_element_steps_per_second(), static_cast<double>(elements * pace.step()) / seconds, "1/s");
  for (std::size_t i = 0; i < finals.size(); ++i) {
    summary::Layer& layer = *s.add_layers();
    layer.set_name(scene.layers[i].name);
    layer.set_kind(solve::to_word(scene.layers[i].kind()));
    for (const exchange::SummaryItem& item : finals[i].summary) {
      summary::Item& entry = *layer.add_items();
      entry.set_name(item.name);
      set(entry.mutable_quantity(), item.value, item.unit);
    }
    set_draw_in(layer.mutable_draw_in(), measure_draw_in(forming.stack().layer(static_cast<int>(i))));
    set(layer.mutable_kinetic_to_internal(), 100 * end.layer_kinetic[i] / std::max(end.layer_internal[i], kNegligible),
        "%");
    for (const exchange::OutsideTrust& passed : finals[i].outside_trust)
      set_outside(layer.add_outside_trust(), passed, forming.compute_stroke(passed.first_time));
  }
  if (forming.stack().punch()) set(s.mutable_punch_force(), 1e-3 * forming.punch_force(), "kN");
  const double target = forming.holder().target();
  summary::BlankHolder& holder = *s.mutable_blank_holder();
  set(holder.mutable_force(), 1e-3 * forming.holder_force(), "kN");
  set(holder.mutable_target(), 1e-3 * target, "kN");
  if (target > 0) {
    set(holder.mutable_mean_deviation(),
        100 * (forming.measurements().holder_mean(forming.holder_force()) / target - 1), "%");
    set(holder.mutable_largest_deviation(), 100 * forming.measurements().holder_deviation(), "%");
  }
  summary::Energy& energy = *s.mutable_energy();
  set(energy.mutable_external(), end.external, "mJ");
  set(energy.mutable_thinning(), end.thinning, "mJ");
  set(energy.mutable_internal(), end.internal, "mJ");
  set(energy.mutable_kinetic(), end.kinetic, "mJ");
  set(energy.mutable_contact(), end.contact, "mJ");
  set(energy.mutable_friction(), end.friction, "mJ");
  set(energy.mutable_damping(), end.damping, "mJ");
  set(energy.mutable_residual(), 100 * forming.final_residual(end), "%");
  set(energy.mutable_largest_residual(), 100 * forming.measurements().largest_residual(), "%");
  if (scene.record.frames > 0) {
    set(s.mutable_penetration()->mutable_percentile_99(), 100 * forming.measurements().penetration_99(), "%");
    set(s.mutable_penetration()->mutable_peak(), 100 * forming.measurements().penetration_peak(), "%");
  }
  for (const summary::Layer& layer : s.layers())
    for (const summary::OutsideTrust& passed : layer.outside_trust())
      s.add_warnings(describe_outside(layer.name(), passed));
  if (const Inertia& inertia = forming.measurements().inertia(); inertia.work > 0) {
    set(s.mutable_inertia()->mutable_share(), 100 * inertia.kinetic / inertia.work, "%");
    set(s.mutable_inertia()->mutable_kinetic(), inertia.kinetic, "mJ");
    set(s.mutable_inertia()->mutable_work(), inertia.work, "mJ");
    set(s.mutable_inertia()->mutable_time(), 1e3 * inertia.time, "ms");
  }
  judge(scene, list_untouched(scene, forming.measurements().touched(), pace.step()), s);
  return s;
}

std::string format_text(const summary::Summary& s) {
  std::string text;
  auto out = std::back_inserter(text);
  fmt::format_to(out, "{}: {:.1f} mm stroke, {:.2f} ms, {:.0f} steps, {} ({:.2f} M element-steps/s)\n", s.scene(),
                 s.stroke().value(), s.time().value(), s.steps().value(), format_time(s.wall_time().value()),
                 1e-6 * s.element_steps_per_second().value());
  for (const summary::Layer& layer : s.layers()) {
    std::vector<std::string> items;
    for (const summary::Item& item : layer.items())
      items.push_back(fmt::format("{} {:.3g}{}", item.name(), item.quantity().value(),
                                  item.quantity().unit() == "-" ? "" : " " + item.quantity().unit()));
    const summary::DrawIn& d = layer.draw_in();
    items.push_back(fmt::format("draw-in at -x, +x, +y {:.1f} {:.1f} {:.1f}, rim up to {:.1f} mm", d.minus_x().value(),
                                d.plus_x().value(), d.plus_y().value(), d.largest().value()));
    add_items(fmt::format("  {:<12} {:<6}", layer.name(), layer.kind()), items, text);
  }
  if (s.has_punch_force())
    fmt::format_to(out, "  punch force {:.3f} kN ({})\n", s.punch_force().value(), s.modelled_part());
  const summary::BlankHolder& holder = s.blank_holder();
  std::vector<std::string> force{fmt::format("{:.3f} kN ({}), target {:.3f} kN", holder.force().value(),
                                             s.modelled_part(), holder.target().value())};
  if (holder.has_mean_deviation())
    force.push_back(fmt::format("after the ramp mean {:+.2f} %, largest deviation {:.2f} %",
                                holder.mean_deviation().value(), holder.largest_deviation().value()));
  add_items("  blank-holder force", force, text);
  const summary::Energy& e = s.energy();
  add_items("  energy (mJ)",
            {fmt::format("external {:.5g} + thinning {:.3g} =", e.external().value(), e.thinning().value()),
             fmt::format("internal {:.5g} + kinetic {:.3g} + contact {:.3g}", e.internal().value(), e.kinetic().value(),
                         e.contact().value()),
             fmt::format("+ friction {:.5g} + damping {:.3g}", e.friction().value(), e.damping().value())},
            text);
  fmt::format_to(out, "  energy residual {:.3g} %, largest of all steps {:.3g} %\n", e.residual().value(),
                 e.largest_residual().value());
  if (s.has_penetration())
    fmt::format_to(out, "  penetration, worst frame: {:.2f} % (99 % of the area), peak {:.2f} % of a layer\n",
                   s.penetration().percentile_99().value(), s.penetration().peak().value());
  for (const std::string& warning : s.warnings()) fmt::format_to(out, "  warning: {}\n", warning);
  text += '\n';
  for (const summary::Verdict& verdict : s.verdicts()) {
    const char* state[] = {"fine: ", "", "not judged: "};
    fmt::format_to(out, "  {:<12} {}{}\n", verdict.name(), state[verdict.state()], verdict.sentence());
  }
  return text;
}

std::string format_json(const google::protobuf::Message& message) {
  google::protobuf::util::JsonPrintOptions options;
  options.add_whitespace = true;
  options.always_print_primitive_fields = true;
  options.preserve_proto_field_names = true;
  std::string text;
  if (!google::protobuf::util::MessageToJsonString(message, &text, options).ok())
    throw std::runtime_error(message.GetTypeName() + " cannot be written as JSON");
  return text;
}

}  // namespace interply::coordinator
