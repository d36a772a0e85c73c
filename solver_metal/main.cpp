/// The process of one sheet.
#include "solve/session.hpp"
#include "solver_metal/metal_layer.hpp"

int main(int argc, char** argv) {
  return interply::solve::solver_main(argc, argv, interply::scene::Kind::Metal, interply::metal::make_metal_layer);
}
