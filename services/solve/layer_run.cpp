#include "solve/layer_run.hpp"

namespace interply::solve {

LayerRun::LayerRun(const scene::Scene& scene, int layer, const mechanics::TriangleMesh& mesh,
                   std::unique_ptr<LayerMechanics> mechanics)
    : scene_(scene),
      layer_(layer),
      mesh_(mesh),
      mechanics_(std::move(mechanics)),
      trust_(mechanics_->trust_limits(), mesh),
      mass_(mechanics::compute_lumped_mass(
          mesh, scene.layers[static_cast<std::size_t>(layer)].thickness,
          scene.layers[static_cast<std::size_t>(layer)].density * scene.time.mass_scaling)),
      nodes_(mechanics::make_motion_at_rest(mesh)),
      internal_force_(3, mesh.n_nodes()) {
  motion_.position = mesh.reference;
  motion_.vote = mechanics_->compute_stable_increment(motion_.position);
  motion_.thickness = mechanics_->compute_nodal_thickness();
}

void LayerRun::drift(double dt) {
  ++motion_.step;
  motion_.thickness.resize(0);
  if (motion_.step % scene_.time.vote_every == 0) {  // from the tangent and thickness of the last step
    motion_.vote = mechanics_->compute_stable_increment(motion_.position);
    motion_.thickness = mechanics_->compute_nodal_thickness();
  }
  mechanics::drift(nodes_, dt, motion_.position);
  time_ += dt;
  motion_.energies = energies_;
}

void LayerRun::compute_internal_forces() {
  mechanics_->compute_internal_forces(motion_.position, {.time = time_, .dt = nodes_.dt}, internal_force_);
  energies_.internal = mechanics_->internal_energy();
}

void LayerRun::kick(const exchange::Force& force) {
  mechanics::kick(nodes_, force.next_dt, force.force, internal_force_, mass_, mesh_.symmetry_nodes);
  energies_.kinetic = nodes_.kinetic;
  energies_.internal_work = nodes_.work.internal;
  energies_.contact_work = nodes_.work.contact;
}

observe::LayerMesh LayerRun::describe_mesh() const {
  const scene::Layer& layer = scene_.layers[static_cast<std::size_t>(layer_)];
  return {.layer = layer.name,
          .kind = layer.kind() == scene::Kind::Fabric ? "fabric" : "metal",
          .thickness = layer.thickness,
          .reference = mesh_.reference,
          .triangles = mesh_.triangles};
}

observe::LayerFrame LayerRun::describe_frame(int frame) {
  trust_.note(time_, mechanics_->compute_trust_quantities(motion_.position));
  std::vector<observe::Field> fields = mechanics_->compute_fields(motion_.position);
  fields.push_back(trust_.describe());
  return {.layer = scene_.layers[static_cast<std::size_t>(layer_)].name,
          .frame = frame,
          .step = motion_.step,
          .time = time_,
          .position = motion_.position,
          .fields = std::move(fields)};
}

exchange::Final LayerRun::describe_end() {
  trust_.note(time_, mechanics_->compute_trust_quantities(motion_.position));
  mechanics::Digest digest;
  digest.add(motion_.position);
  digest.add(nodes_.velocity);
  mechanics_->add_state_to(digest);
  return {.digest = digest.value(),
          .energies = energies_,
          .summary = mechanics_->summarise(motion_.position),
          .outside_trust = trust_.list_passed()};
}

}  // namespace interply::solve
