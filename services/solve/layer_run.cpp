#include "solve/layer_run.hpp"

namespace interply::solve {

using mechanics::NodalVectors;

LayerRun::LayerRun(const scene::Scene& scene, int layer, const mechanics::TriangleMesh& mesh,
                   std::unique_ptr<LayerMechanics> mechanics)
    : scene_(scene),
      layer_(layer),
      mesh_(mesh),
      mechanics_(std::move(mechanics)),
      mass_(mechanics::compute_lumped_mass(
          mesh, scene.layers[static_cast<std::size_t>(layer)].thickness,
          scene.layers[static_cast<std::size_t>(layer)].density * scene.time.mass_scaling)),
      nodes_(mechanics::make_motion_at_rest(mesh)),
      internal_force_(NodalVectors::Zero(3, mesh.n_nodes())),
      old_internal_force_(internal_force_),
      contact_force_(internal_force_) {
  motion_.position = nodes_.position;
  motion_.vote = mechanics_->compute_stable_increment(nodes_.position);
  motion_.thickness = mechanics_->compute_nodal_thickness();
}

void LayerRun::drift(double dt) {
  ++motion_.step;
  motion_.thickness.resize(0);
  if (motion_.step % scene_.time.vote_every == 0) {  // from the tangent and thickness of the last step
    motion_.vote = mechanics_->compute_stable_increment(nodes_.position);
    motion_.thickness = mechanics_->compute_nodal_thickness();
  }
  mechanics::drift(nodes_, dt);
  time_ += dt;
  motion_.position = nodes_.position;
  motion_.energies = energies_;
}

void LayerRun::compute_internal_forces() {
  old_internal_force_.swap(internal_force_);
  mechanics_->compute_internal_forces(nodes_.position, {.time = time_, .dt = nodes_.dt}, internal_force_);
  energies_.internal = mechanics_->internal_energy();
  energies_.internal_work += mechanics::compute_trapezoid_work(old_internal_force_, internal_force_, nodes_.increment);
}

void LayerRun::kick(exchange::Force& force) {
  energies_.contact_work += mechanics::compute_trapezoid_work(contact_force_, force.force, nodes_.increment);
  contact_force_.swap(force.force);
  energies_.kinetic =
      mechanics::kick(nodes_, force.next_dt, contact_force_, internal_force_, mass_, mesh_.symmetry_nodes);
}

observe::LayerMesh LayerRun::describe_mesh() const {
  const scene::Layer& layer = scene_.layers[static_cast<std::size_t>(layer_)];
  return {.layer = layer.name,
          .kind = layer.kind() == scene::Kind::Fabric ? "fabric" : "metal",
          .thickness = layer.thickness,
          .reference = mesh_.reference,
          .triangles = mesh_.triangles};
}

observe::LayerFrame LayerRun::describe_frame(int frame) const {
  return {.layer = scene_.layers[static_cast<std::size_t>(layer_)].name,
          .frame = frame,
          .step = motion_.step,
          .time = time_,
          .position = nodes_.position,
          .fields = mechanics_->compute_fields(nodes_.position)};
}

exchange::Final LayerRun::describe_end() const {
  mechanics::Digest digest;
  digest.add(nodes_.position);
  digest.add(nodes_.velocity);
  mechanics_->add_state_to(digest);
  return {.digest = digest.value(), .energies = energies_, .summary = mechanics_->summarise(nodes_.position)};
}

}  // namespace interply::solve
