#include "record/history.hpp"

#include <array>

namespace interply::record {
namespace {

using observe::HistoryRow;

constexpr std::array kScalars = {
    ScalarColumn{"time", "s", "simulated time", &HistoryRow::time},
    ScalarColumn{"dt", "s", "time increment", &HistoryRow::dt},
    ScalarColumn{"stroke", "mm", "travel of the punch", &HistoryRow::stroke},
    ScalarColumn{"kinetic", "mJ", "kinetic energy of layers and blank holder", &HistoryRow::kinetic},
    ScalarColumn{"internal", "mJ", "internal energy of all layers", &HistoryRow::internal},
    ScalarColumn{"contact", "mJ", "energy stored in contact", &HistoryRow::contact},
    ScalarColumn{"friction", "mJ", "work dissipated by friction", &HistoryRow::friction},
    ScalarColumn{"damping", "mJ", "work dissipated by damping", &HistoryRow::damping},
    ScalarColumn{"thinning", "mJ", "work of contact on the change of thickness", &HistoryRow::thinning},
    ScalarColumn{"external", "mJ", "work of tools and blank-holder pressure", &HistoryRow::external},
    ScalarColumn{"residual", "-", "energy residual / energy scale", &HistoryRow::residual},
    ScalarColumn{"punch_force", "N", "force on the punch, modelled part", &HistoryRow::punch_force},
    ScalarColumn{"blank_holder_force", "N", "contact force on the blank holder, modelled part",
                 &HistoryRow::blank_holder_force},
    ScalarColumn{"blank_holder_target", "N", "force applied to the blank holder, modelled part",
                 &HistoryRow::blank_holder_target},
    ScalarColumn{"peak_penetration", "-", "largest penetration / thickness of the thinner layer",
                 &HistoryRow::peak_penetration},
    ScalarColumn{"contact_vote", "s", "largest stable increment of contact", &HistoryRow::contact_vote},
    ScalarColumn{"coordinator_step_seconds", "s", "wall time per step of the coordinator, mean since the last row",
                 &HistoryRow::coordinator_step_seconds},
    ScalarColumn{"coordinator_wait_seconds", "s", "of that, waiting for the layers",
                 &HistoryRow::coordinator_wait_seconds},
};

const std::array kLists = {
    ListColumn{"layer_kinetic", "mJ", "kinetic energy of each layer", &HistoryRow::layer_kinetic},
    ListColumn{"layer_internal", "mJ", "internal energy of each layer", &HistoryRow::layer_internal},
    ListColumn{"layer_residual", "mJ", "energy residual of each layer", &HistoryRow::layer_residual},
    ListColumn{"votes", "s", "largest stable increment of each layer", &HistoryRow::votes},
    ListColumn{"step_seconds", "s", "wall time per step of each layer's process, mean since the last row",
               &HistoryRow::step_seconds},
    ListColumn{"wait_seconds", "s", "of that, waiting for the coordinator", &HistoryRow::wait_seconds},
    ListColumn{"interface_residual", "mJ", "energy residual of each interface", &HistoryRow::interface_residual, true},
    ListColumn{"interface_friction", "mJ", "work dissipated by friction at each interface",
               &HistoryRow::interface_friction, true},
};

}  // namespace

std::span<const ScalarColumn> scalar_columns() { return kScalars; }
std::span<const ListColumn> list_columns() { return kLists; }

}  // namespace interply::record
