#include "coordinator/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include "coordinator/coordinator.hpp"
#include "coordinator/verdict.hpp"

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

std::string format_time(double seconds) {
  const long s = std::lround(seconds);
  return s < 60 ? fmt::format("{} s", s) : fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
}

}  // namespace

std::string format_progress(const Progress& p) {
  std::string line = fmt::format(
      "stroke {:5.1f} mm  step {:>7}  t {:.3f}/{:.3f} ms  dt {:.2e} s  punch {:.2f} kN  "
      "energy residual {:+.3f} %",
      p.stroke, p.step, 1e3 * p.time, 1e3 * p.end_time, p.dt, 1e-3 * p.punch_force, 100 * p.residual);
  if (p.seconds_left >= 0) line += "  left " + format_time(p.seconds_left);
  if (!p.waiting_for.empty()) line += "  waiting for " + p.waiting_for;
  return line;
}

std::string format_summary(const scene::Scene& scene, const Forming& forming, const EnergyBalance& end,
                           const std::vector<exchange::Final>& finals, double seconds) {
  std::string text;
  auto out = std::back_inserter(text);
  const Pace& pace = forming.pace();
  std::int64_t elements = 0;
  for (int i = 0; i < forming.stack().n_layers(); ++i) elements += forming.stack().layer(i).mesh.n_elements();
  fmt::format_to(out, "{}: {:.1f} mm stroke, {:.2f} ms, {} steps, {} ({:.2f} M element-steps/s)\n", scene.name,
                 forming.stroke(), 1e3 * pace.time(), pace.step(), format_time(seconds),
                 1e-6 * static_cast<double>(elements * pace.step()) / seconds);
  for (std::size_t i = 0; i < finals.size(); ++i) {
    const scene::Layer& layer = scene.layers[i];
    fmt::format_to(out, "  {:<12} {:<6}", layer.name, layer.kind() == scene::Kind::Fabric ? "fabric" : "metal");
    for (const exchange::SummaryItem& item : finals[i].summary)
      fmt::format_to(out, "  {} {:.3g}{}", item.name, item.value, item.unit == "-" ? "" : " " + item.unit);
    text += '\n';
  }
  fmt::format_to(out, "  draw-in at -x, +x, +y, largest of the rim (mm):");
  for (std::size_t i = 0; i < finals.size(); ++i) {
    const DrawIn d = measure_draw_in(forming.stack().layer(static_cast<int>(i)));
    fmt::format_to(out, "{} {} {:.1f} {:.1f} {:.1f} {:.1f}", i == 0 ? "" : ",", scene.layers[i].name, d.minus_x,
                   d.plus_x, d.plus_y, d.largest);
  }
  text += '\n';
  const char* part = scene.blank.half ? "half model" : "full model";
  if (forming.stack().punch())
    fmt::format_to(out, "  punch force {:.3f} kN ({})\n", 1e-3 * forming.punch_force(), part);
  const double target = forming.holder().target();
  fmt::format_to(out, "  blank-holder force {:.3f} kN ({}), target {:.3f} kN", 1e-3 * forming.holder_force(), part,
                 1e-3 * target);
  if (target > 0)
    fmt::format_to(out, "; after the ramp mean {:+.2f} %, largest deviation {:.2f} %",
                   100 * (forming.holder_mean() / target - 1), 100 * forming.holder_deviation());
  text += '\n';
  fmt::format_to(out,
                 "  energy (mJ): external {:.5g} + thinning {:.3g} = internal {:.5g} + kinetic {:.3g} + contact {:.3g} "
                 "+ friction {:.5g} + damping {:.3g}\n  energy residual {:.3g} %, largest of all steps {:.3g} %\n",
                 end.external, end.thinning, end.internal, end.kinetic, end.contact, end.friction, end.damping,
                 100 * end.residual() / end.scale(), 100 * forming.largest_residual());
  std::string ratios;
  for (std::size_t i = 0; i < end.layer_kinetic.size(); ++i)
    ratios += fmt::format(" {} {:.2g} %", scene.layers[i].name,
                          100 * end.layer_kinetic[i] / std::max(end.layer_internal[i], kNegligible));
  fmt::format_to(out, "  kinetic/internal energy:{}\n", ratios);
  if (scene.record.frames > 0)
    fmt::format_to(out,
                   "  penetration, worst frame: 99 % of the contact area below {:.2f} %, peak {:.2f} % of the "
                   "thinner layer\n",
                   100 * forming.penetration_99(), 100 * forming.penetration_peak());
  for (const std::string& sentence : list_untouched(scene, forming.touched(), pace.step()))
    text += "  warning: " + sentence + '\n';
  if (forming.penetration_peak() > 1)
    text +=
        "  warning: a layer or tool has gone through another; raise contact.reference_pressure or lengthen "
        "motion.forming_time\n";
  return text;
}

}  // namespace interply::coordinator
