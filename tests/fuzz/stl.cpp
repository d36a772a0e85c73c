/// Surfaces of tools. What is accepted makes a tool whose distance is finite and found the same by search and by trying
/// every triangle.
#include "geometry/stl.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include "contact/triangle_tool.hpp"
#include "fuzz/parts.hpp"

namespace {

using namespace interply;

void try_tool(const geometry::Surface& surface) {
  const contact::TriangleTool tool(surface.vertices, surface.triangles);
  const mechanics::Vector3 low = surface.vertices.rowwise().minCoeff(), high = surface.vertices.rowwise().maxCoeff();
  for (const double s : {-0.5, 0.25, 0.6, 2.0}) {
    const mechanics::Vector3 x = low + s * (high - low) + mechanics::Vector3(0, 0, 0.1 * s);
    for (const mechanics::Vector3& at : {x, mechanics::Vector3(surface.vertices.col(0))}) {
      const contact::Distance found = tool.evaluate(at), reference = tool.evaluate_by_all(at);
      if (!std::isfinite(found.value)) fuzz::fail("a distance that is not finite");
      if (!(std::abs(found.gradient.norm() - 1) < 1e-6)) fuzz::fail("a gradient that is no unit vector");
      if (found.value != reference.value || found.gradient != reference.gradient) fuzz::fail("the search is wrong");
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  geometry::Surface surface;
  try {
    surface = geometry::parse_stl({reinterpret_cast<const char*>(data), size}, "fuzz.stl");
  } catch (const geometry::Unreadable& refused) {
    fuzz::expect_sentence(refused.what(), "fuzz.stl");
    return 0;
  }
  try {
    try_tool(surface);
  } catch (const std::invalid_argument& refused) {  // needles only; connectivity has been checked by the reader
    if (std::string(refused.what()).find("no triangle of the surface has an area") == std::string::npos) throw;
  }
  return 0;
}
