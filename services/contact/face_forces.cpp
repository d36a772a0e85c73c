#include "contact/face_forces.hpp"

namespace interply::contact {

using Eigen::Index;

FaceForces::FaceForces(const LayerGeometry& layer)
    : layer_(layer),
      force_(NodalVectors::Zero(3, layer.mesh->n_nodes())),
      records_(static_cast<std::size_t>(2 * layer.mesh->n_nodes())) {}

double FaceForces::finish() {
  layer_.normals->add_forces_of_pulls(layer_.normal, records_.data());
  is_zero_ = false;
  double work[3] = {};
  const Quad* now = records_.data();
  const auto replace = [](double& force, double next, double increment) {
    const double work = (force + next) * increment;
    force = next;
    return work;
  };
  double *x = &force_(0, 0), *y = &force_(1, 0), *z = &force_(2, 0);
  const NodalVectors& by = layer_.increment;
  for (Index i = 0; i < force_.cols(); ++i) {
    work[0] += replace(x[i], now[2 * i].x, by(0, i));
    work[1] += replace(y[i], now[2 * i].y, by(1, i));
    work[2] += replace(z[i], now[2 * i].z, by(2, i));
  }
  return 0.5 * (work[0] + work[1] + work[2]);
}

double FaceForces::finish_without_forces() {
  if (is_zero_) return 0;
  const double work = 0.5 * (force_ * layer_.increment).sum();
  force_.setZero();
  is_zero_ = true;
  return work;
}

}  // namespace interply::contact
