"""Checks with plain h5py that what a record holds of its interfaces is what acted there (proto/RECORD.md).

check_forces.py record RECORD             every frame, interface and node of the record of a real run
check_forces.py example RECORD.md FOLDER  runs the example of that document as it stands in the folder of a record
"""

import os
import re
import sys

import h5py
import numpy as np

ROUND_OFF = 1e-12


def find_friction(scene, kinds, one, other):
    """Coefficient between two neighbours, from the resolved scene; kinds: {layer: kind}."""
    read = {key: float(re.search(rf"\b{key}: *([-+.\de]+)", scene)[1])
            for key in ("tool_steel", "tool_fabric", "steel_fabric", "fabric_fabric", "steel_steel")}
    fabrics = [kinds.get(name) for name in (one, other)].count("fabric")
    if one in kinds and other in kinds:
        return read[("steel_steel", "steel_fabric", "fabric_fabric")[fabrics]]
    return read[("tool_steel", "tool_fabric")[fabrics]]


def spread(corners, values, nodes):
    """A third of what each triangle has to each of its corners. [node]"""
    return np.bincount(corners.ravel(), np.repeat(values / 3, 3), nodes)


def find_areas(position, corners):
    a, b, c = (position[corners[:, k]] for k in range(3))
    return spread(corners, 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1), len(position))


def check_interface(f, pair, k, friction):
    """One frame. Returns how many nodes are pressed, and past the edge."""
    group, where = f["interfaces"][pair], f"{pair}, frame {k}"
    layer, other = (group[side][()].decode() for side in ("nodes_of", "other"))
    sheet = f["layers"][layer]
    corners, flat, position = sheet["triangles"][()], sheet["reference"][()], sheet["position"][k]
    value = {name: group[name][k] for name in group if name not in ("nodes_of", "other")}
    reference, area = find_areas(flat, corners), find_areas(position, corners)
    length = lambda vectors: np.linalg.norm(vectors, axis=1)

    # Coulomb, node by node; nothing where nothing acts
    p, tau, state = value["pressure"], value["tangential_traction"], value["state"]
    assert (p >= 0).all() and np.isfinite(tau).all(), where
    assert (length(tau) <= friction * p * (1 + ROUND_OFF)).all(), where
    assert (p[(state == 0) | (state == 3)] == 0).all(), where
    assert (state[value["share"] == 0] == 3).all(), where
    np.testing.assert_allclose(length(value["normal"]), 1, rtol=ROUND_OFF, err_msg=where)
    assert abs((tau * value["normal"]).sum(axis=1)).max() <= 1e-9 * max(length(tau).max(), 1), where
    np.testing.assert_allclose(value["area"], area, rtol=1e-9, err_msg=where)
    np.testing.assert_allclose(value["true_pressure"] * area, p * reference, rtol=1e-9, err_msg=where)
    np.testing.assert_allclose(value["true_traction"] * area[:, None], tau * reference[:, None], rtol=1e-9, atol=1e-12,
                               err_msg=where)

    # both sides: forces, and moments about an axis across the symmetry plane (about all axes of a full model)
    here, about = value["force"], np.array([3.0, -5.0, 7.0])
    moment = np.cross(position - about, here).sum(axis=0)
    if other in f["layers"]:
        there, on = value["force_on_other"], f["layers"][other]["position"][k]
        moment += np.cross(on - about, there).sum(axis=0)
    else:
        there = f["tools"][other]["force"][k][None]
        moment += f["tools"][other]["moment"][k] - np.cross(about, there[0])
    here_sum, there_sum = here.sum(axis=0), there.sum(axis=0)
    larger = max(np.linalg.norm(here_sum), np.linalg.norm(there_sum))
    assert np.linalg.norm(here_sum + there_sum) <= ROUND_OFF * larger, (where, here_sum, there_sum)
    scale = ROUND_OFF * (length(here) * length(position - about)).sum()
    half = flat[:, 1].min() > -1e-9
    assert (abs(moment[1:2] if half else moment) <= scale).all(), (where, moment, scale)

    if other in f["tools"]:  # what is recorded per area adds up to the force
        sign = -1 if other == "die" else 1
        for pressure, traction, of in ((p, tau, reference), (value["true_pressure"], value["true_traction"], area)):
            force = ((pressure[:, None] * value["normal"] + sign * traction) * of[:, None]).sum(axis=0)
            assert np.linalg.norm(force - there_sum) <= ROUND_OFF * length(here).sum(), (where, force, there_sum)
    return np.count_nonzero(p), np.count_nonzero(state == 3)


def check_fibres(ply, k):
    """Unit vectors in the deformed elements, and the shear angle between them with its sign."""
    warp, weft = ply["warp"][k], ply["weft"][k]
    a, b, c = (ply["position"][k][ply["triangles"][:, i]] for i in range(3))
    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    for fibre in (warp, weft):
        np.testing.assert_allclose(np.linalg.norm(fibre, axis=1), 1, rtol=ROUND_OFF)
        assert abs((fibre * normal).sum(axis=1)).max() < 1e-9
    gamma = np.arctan2((warp * weft).sum(axis=1), (np.cross(warp, weft) * normal).sum(axis=1))
    np.testing.assert_allclose(ply["shear_angle"][k], gamma, atol=1e-12)


def check_record(path):
    with h5py.File(path, "r") as f:
        frames, rows = f["frames_complete"][()], f["history/rows_complete"][()]
        scene = f["scene/text"][()].decode()
        layers = [name.decode() for name in f["scene/layers"]]
        pairs = [name.decode() for name in f["scene/interfaces"]]
        kinds = {name: f["layers"][name]["kind"][()].decode() for name in layers}
        assert f["status"][()] == b"done" and frames > 1, (f["status"][()], frames)
        counts = np.zeros(2, int)
        for i, pair in enumerate(pairs):
            group = f["interfaces"][pair]
            friction = find_friction(scene, kinds, *(group[side][()].decode() for side in ("nodes_of", "other")))
            for k in range(frames):
                counts += check_interface(f, pair, k, friction)
            assert (np.diff(group["slip"][:frames], axis=0) >= 0).all(), pair
            sheet = f["layers"][group["nodes_of"][()].decode()]
            reference = find_areas(sheet["reference"][()], sheet["triangles"][()])
            work = group["friction_work"][frames - 1] @ reference  # the last row is that of the last frame
            np.testing.assert_allclose(f["history/interface_friction"][rows - 1, i], work, rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(f["history/interface_friction"][:rows].sum(axis=1), f["history/friction"][:rows],
                                   rtol=1e-9, atol=1e-9)
        for name in layers:
            if kinds[name] == "fabric":
                for k in range(frames):
                    check_fibres(f["layers"][name], k)
        for tool in f["tools"].values():
            nodes, corners = tool["surface/nodes"], tool["surface/triangles"][()]
            assert corners.min() == 0 and corners.max() < len(nodes)
        print(f"{path}: {frames} frames, {len(pairs)} interfaces, {counts[0]} nodes pressed, {counts[1]} past an edge; "
              f"last punch force {f['tools/punch/force'][frames - 1, 2]:.6g} N")


def run_example(document, folder):
    """Runs the example and compares its numbers with each other."""
    with open(document) as text:
        block = re.search(r"^Load, force, map and profile.*?:\n\n((?:    .*\n)+)", text.read(), re.M)[1]
    import matplotlib

    matplotlib.use("Agg")
    os.chdir(folder)
    names = {}
    exec(re.sub(r"^    ", "", block, flags=re.M), names)
    load, force = names["load"], names["force"]
    assert len(load) == names["n"] > 1 and len(names["line"]) > 2
    assert abs(force[2] + load[-1]) <= ROUND_OFF * abs(load[-1]) and load[-1] > 0, (force, load)
    assert os.path.getsize("interface.png") > 1000


if __name__ == "__main__":
    command, *rest = sys.argv[1:]
    if command == "record":
        check_record(*rest)
    elif command == "example":
        run_example(*rest)
    else:
        sys.exit(__doc__)
