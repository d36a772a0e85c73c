#include "coordinator/verdict.hpp"

#include <fmt/format.h>

#include <cmath>

#include "coordinator/coordinator.hpp"
#include "coordinator/quantity.hpp"

namespace interply::coordinator {

std::vector<std::string> list_untouched(const scene::Scene& scene, const std::vector<bool>& touched,
                                        std::int64_t steps) {
  std::vector<std::string> sentences;
  if (!scene.tools.punch && scene.motion.stroke > 0)
    sentences.push_back(
        fmt::format("there was no punch (tools.punch): the stack was only squeezed, motion.stroke = {:g} mm moved "
                    "nothing",
                    scene.motion.stroke));
  const auto names = name_interfaces(scene);
  const std::size_t n = scene.layers.size();
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (touched[k]) continue;
    if (k > 0 && k < n) {
      sentences.push_back(fmt::format("{} and {} never touched: no pressure between them in any of {} steps",
                                      scene.layers[k - 1].name, scene.layers[k].name, steps));
      continue;
    }
    const char* tool = k == 0 ? "die" : k == n ? "blank holder" : "punch";
    sentences.push_back(
        fmt::format("the {} never touched {}: its force was 0 in all {} steps; {}", tool, names[k].nodes_of, steps,
                    k > n ? "see `interply check` for a tool finer than the mesh, or lengthen motion.stroke"
                          : "see `interply check` for a tool finer than the mesh or beside the blank"));
  }
  return sentences;
}

namespace {

using summary::Quantity;
using summary::Summary;
using summary::Verdict;

struct Judged {
  Verdict::State state;
  std::string sentence;
};

Judged judge_inertia(const scene::Scene& scene, const Summary& s, Verdict& verdict) {
  if (!s.has_inertia()) return {Verdict::NOT_JUDGED, "no punch has moved"};
  const double share = s.inertia().share().value();
  *verdict.mutable_value() = s.inertia().share();
  set(verdict.mutable_limit(), kMostKinetic, "%");
  const std::string most =
      fmt::format("at most {:.2g} % of the work was kinetic energy, limit {:g} %", share, kMostKinetic);
  if (share <= kMostKinetic) return {Verdict::FINE, most};
  return {Verdict::LOOK,
          fmt::format("{}, at {:.3g} ms: motion.forming_time: {:.2g} would do", most, s.inertia().time().value(),
                      scene.motion.forming_time * std::sqrt(share / kMostKinetic))};
}

Judged judge_thinning(const Summary& s, Verdict& verdict) {
  const summary::Layer* thinnest = nullptr;
  for (const summary::Layer& layer : s.layers())
    for (const summary::Item& item : layer.items())
      if (item.name() == "thinning up to" && (!thinnest || item.quantity().value() > verdict.value().value())) {
        thinnest = &layer;
        *verdict.mutable_value() = item.quantity();
      }
  if (!thinnest) return {Verdict::NOT_JUDGED, "no layer becomes thinner"};
  const std::string most = fmt::format("{} by up to {:.3g} %", thinnest->name(), verdict.value().value());
  for (const summary::Layer& layer : s.layers())
    for (const summary::OutsideTrust& passed : layer.outside_trust())
      if (passed.quantity() == "thinning") {
        *verdict.mutable_limit() = passed.limit();
        return {Verdict::LOOK, fmt::format("{}, limit {:g} %: {}", most, passed.limit().value(), passed.meaning())};
      }
  return {Verdict::FINE, most};
}

Judged judge_penetration(const Summary& s, Verdict& verdict) {
  if (!s.has_penetration()) return {Verdict::NOT_JUDGED, "it is sampled in frames, and record.frames is 0"};
  const double most = s.penetration().percentile_99().value();
  *verdict.mutable_value() = s.penetration().percentile_99();
  set(verdict.mutable_limit(), kMostPenetration, "%");
  const std::string said =
      fmt::format("99 % of the contact area below {:.3g} % of the thinner layer, limit {:g} %", most, kMostPenetration);
  if (s.penetration().peak().value() > 100)
    return {
        Verdict::LOOK,
        "a layer or tool has gone through another: raise contact.reference_pressure or lengthen motion.forming_time"};
  if (most <= kMostPenetration) return {Verdict::FINE, said};
  return {Verdict::LOOK, said + ": raise contact.reference_pressure"};
}

Judged judge_energy(const Summary& s, Verdict& verdict) {
  const double most = s.energy().largest_residual().value();
  *verdict.mutable_value() = s.energy().largest_residual();
  set(verdict.mutable_limit(), kMostResidual, "%");
  const std::string said = fmt::format("residual of the balance at most {:.2g} %, limit {:g} %", most, kMostResidual);
  if (std::abs(most) <= kMostResidual) return {Verdict::FINE, said};
  return {Verdict::LOOK, said + ": lower time.safety, and look where layers fold or tools hit"};
}

/// Of what is outside beside thinning, the one that takes the largest share of its layer.
Judged judge_trust(const Summary& s, Verdict& verdict) {
  const summary::OutsideTrust* widest = nullptr;
  std::string of;
  int layers = 0;
  for (const summary::Layer& layer : s.layers()) {
    bool is_outside = false;
    for (const summary::OutsideTrust& passed : layer.outside_trust()) {
      if (passed.quantity() == "thinning") continue;
      is_outside = true;
      if (widest && passed.area_share().value() <= widest->area_share().value()) continue;
      widest = &passed;
      of = layer.name();
    }
    layers += is_outside;
  }
  if (!widest) return {Verdict::FINE, "no element is outside what its law is made for"};
  *verdict.mutable_value() = widest->area_share();
  return {
      Verdict::LOOK,
      fmt::format("{} layer{} outside what the law is made for, most of all {}: {} beyond {:g} {} in {:.2g} % of its "
                  "area; see the warnings",
                  layers, layers == 1 ? " is" : "s are", of, widest->quantity(), widest->limit().value(),
                  widest->limit().unit(), widest->area_share().value())};
}

Judged judge_contact(const std::vector<std::string>& untouched) {
  if (untouched.empty()) return {Verdict::FINE, "all neighbours have touched"};
  std::string sentence;
  for (const std::string& one : untouched) sentence += (sentence.empty() ? "" : "; ") + one;
  return {Verdict::LOOK, sentence};
}

}  // namespace

void judge(const scene::Scene& scene, const std::vector<std::string>& untouched, Summary& s) {
  const auto add = [&](const char* name, const auto& judge_it) {
    Verdict verdict;
    verdict.set_name(name);
    const Judged judged = judge_it(verdict);
    verdict.set_state(judged.state);
    verdict.set_sentence(judged.sentence);
    *s.add_verdicts() = verdict;
  };
  add("inertia", [&](Verdict& v) { return judge_inertia(scene, s, v); });
  add("thinning", [&](Verdict& v) { return judge_thinning(s, v); });
  add("penetration", [&](Verdict& v) { return judge_penetration(s, v); });
  add("energy", [&](Verdict& v) { return judge_energy(s, v); });
  add("trust", [&](Verdict& v) { return judge_trust(s, v); });
  add("contact", [&](Verdict&) { return judge_contact(untouched); });
}

}  // namespace interply::coordinator
