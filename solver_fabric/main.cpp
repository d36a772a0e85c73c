/// interply-solver-fabric: one ply as a process.
#include "solve/session.hpp"
#include "solver_fabric/fabric_layer.hpp"

int main(int argc, char** argv) {
  return interply::solve::solver_main(argc, argv, interply::scene::Kind::Fabric, interply::fabric::make_fabric_layer);
}
