/// Where a layer has left what its law and its elements were made for: the run goes on, and says so.
#pragma once

#include <string>
#include <vector>

#include "exchange/link.hpp"
#include "mechanics/mesh.hpp"
#include "observe/frames.hpp"

namespace interply::solve {

/// An element whose quantity is larger than the limit is outside.
struct TrustLimit {
  std::string quantity, unit;
  double limit = 0;     ///< in that unit; sources in THEORY.md 3 of the solvers
  std::string meaning;  ///< what lies beyond, a clause for a sentence
};

/// Counts the elements of a layer outside each of its limits, frame by frame.
class TrustBook {
 public:
  TrustBook(std::vector<TrustLimit> limits, const mechanics::TriangleMesh& mesh);

  /// @param time        of the state, s
  /// @param quantities  in the order and units of the limits [n_limits x n_elements]
  void note(double time, const Eigen::ArrayXXd& quantities);

  /// Of the state last noted: per element the sum of 2^i over the limits i that it has passed.
  observe::Field describe() const;
  /// The limits that were passed so far.
  std::vector<exchange::OutsideTrust> list_passed() const;

 private:
  std::vector<TrustLimit> limits_;
  const mechanics::TriangleMesh& mesh_;
  mechanics::Scalars area_share_;               ///< of the layer's reference area [n_elements]
  std::vector<exchange::OutsideTrust> passed_;  ///< one per limit; share 0: not passed
  std::vector<double> mask_;                    ///< [n_elements]
};

}  // namespace interply::solve
