"""Checks a record of SampleRun (sample_run.hpp) with plain h5py, or its sidecar with VTK.

check_record.py values RECORD FRAMES ROWS STATUS   every value of the first FRAMES frames, NaN beyond
check_record.py prefix RECORD FRAMES               the same of a broken-off record, whatever lies beyond
check_record.py attributes RECORD                  unit and description on every dataset
check_record.py xdmf SIDECAR FRAMES                the sidecar, resolved as XDMF 2 says
check_record.py well_formed SIDECAR                it can be parsed
check_record.py vtk SIDECAR FRAMES                 what vtkXdmfReader makes of it
"""

import os
import sys
from xml.etree import ElementTree

import h5py
import numpy as np

OWNERS = {"layers/ply_1": 0, "layers/sheet": 1, "interfaces/ply_1|sheet": 10, "interfaces/die|ply_1": 11}
WEDGE = np.array([[0.0, 0, 5], [20, 0, 0], [20, 30, 0], [0, 30, 5]]), np.array([[0, 1, 2], [0, 2, 3]])  # the tool
LAYER_FIELDS = [("stress", 3, False), ("thickness", 1, False), ("fibre____pair_", 2, False), ("velocity", 3, True)]
INTERFACE_FIELDS = [("pressure", 1, True), ("tangential_traction", 3, True)]


def expected(owner, field, frames, points, components):
    """[frames, points(, components)]"""
    k, p, c = np.ogrid[:frames, :points, :components]
    values = owner * 1e6 + field * 1e5 + k * 1e3 + c * 100.0 + p * 0.5
    return values[:, :, 0] if components == 1 else values


def check_values(path, frames, rows=None, status="running"):
    """rows None: what the file says, and frames and rows beyond may have been begun."""
    with h5py.File(path, "r") as f:
        whole = rows is not None
        rows = rows if whole else f["history/rows_complete"][()]

        def check_frames(dataset, values):
            n = len(values)
            np.testing.assert_array_equal(dataset[:n], values, dataset.name)
            assert not whole or np.isnan(dataset[n:]).all(), f"{dataset.name} is not NaN beyond {n}"

        assert f["status"][()].decode() == status, f["status"][()]
        assert f["frames_complete"][()] == frames, f["frames_complete"][()]
        assert f["history/rows_complete"][()] == rows, f["history/rows_complete"][()]
        assert [s.decode() for s in f["scene/layers"]] == ["ply_1", "sheet"]
        check_frames(f["time"], 0.5 * np.arange(frames))
        np.testing.assert_array_equal(f["step"][:frames], 100 * np.arange(frames))
        for group, owner in OWNERS.items():
            layer = f["layers/ply_1" if group.startswith("interfaces") else group]
            nodes, elements = len(layer["reference"]), len(layer["triangles"])
            for i, (name, components, nodal) in enumerate(LAYER_FIELDS if owner < 10 else INTERFACE_FIELDS):
                points = nodes if nodal else elements
                check_frames(f[group][name], expected(owner, i, frames, points, components))
            if owner < 10:
                k = np.arange(frames)[:, None, None]
                check_frames(f[group]["position"], f[group]["reference"][()] + k * np.array([0.001, 0, -1.0]))
        on_sheet = expected(10, 2, frames, len(f["layers/sheet/reference"]), 3)
        check_frames(f["interfaces/ply_1|sheet/force_on_other"], on_sheet)
        assert "force_on_other" not in f["interfaces/die|ply_1"]
        assert [f[f"interfaces/{pair}/other"][()].decode() for pair in ("ply_1|sheet", "die|ply_1")] == ["sheet", "die"]
        check_frames(f["tools/punch/position"], 7.5 - 3.25 * np.arange(frames))
        check_frames(f["tools/punch/force"], expected(20, 1, frames, 1, 3)[:, 0])
        check_frames(f["tools/punch/moment"], expected(20, 2, frames, 1, 3)[:, 0])
        np.testing.assert_array_equal(f["tools/punch/surface/nodes"], WEDGE[0])
        np.testing.assert_array_equal(f["tools/punch/surface/triangles"], WEDGE[1])
        check_frames(f["history/stroke"], 2.0 * np.arange(rows))
        check_frames(f["history/votes"], np.arange(rows)[:, None] * np.array([7.0, 8.0]))
        check_frames(f["history/interface_residual"], np.arange(rows)[:, None] * np.array([13.0, 14.0]))
        check_frames(f["history/interface_friction"], np.arange(rows)[:, None] * np.array([15.0, 16.0]))


def check_attributes(path):
    seen = []

    def visit(name, item):
        if isinstance(item, h5py.Dataset):
            seen.append(name)
            for key in ("unit", "description"):
                assert item.attrs.get(key), f"{name} has no {key}"

    with h5py.File(path, "r") as f:
        f.visititems(visit)
    assert len(seen) > 50, seen


def read_item(item, folder):
    """Numbers of an XDMF DataItem, read as the XDMF 2 specification says."""
    if item.get("ItemType") == "Function":
        first, sign, number = item.get("Function").split()
        assert first == "$0" and sign in "+-"
        return read_item(item.find("DataItem"), folder) + float(sign + number)
    dimensions = [int(n) for n in item.get("Dimensions").split()]
    if item.get("ItemType") == "HyperSlab":
        selection, source = item.findall("DataItem")
        start, stride, count = np.reshape([int(n) for n in selection.text.split()], (3, -1))
        data = read_item(source, folder)
        data = data[tuple(slice(b, b + n * s, s) for b, s, n in zip(start, stride, count))]
        return data.reshape(dimensions)
    file, dataset = item.text.split(":", 1)
    with h5py.File(os.path.join(folder, file), "r") as f:
        data = f[dataset][()]
    assert list(data.shape) == dimensions, (item.text, data.shape, dimensions)
    return data


def check_grid(name, position, triangles, fields, layer, owner, k):
    """What a viewer shows of one grid; fields: {(name, centre): values}."""
    np.testing.assert_allclose(position, layer["position"][k], atol=1e-6)
    np.testing.assert_array_equal(triangles, layer["triangles"])
    wanted = LAYER_FIELDS if owner < 10 else INTERFACE_FIELDS
    assert len(fields) == len(wanted), (name, list(fields))
    for i, (safe, components, nodal) in enumerate(wanted):
        key = ("fibre & <pair>" if safe.startswith("fibre") else safe, "Node" if nodal else "Cell")
        assert key in fields, f"{name} shows no {key} but {list(fields)}"
        points = len(position) if nodal else len(triangles)
        np.testing.assert_array_equal(fields[key], expected(owner, i, k + 1, points, components)[k], str(key))


def check_tool(position, triangles, k):
    """What a viewer shows of the tool: where it is in frame k."""
    np.testing.assert_allclose(position, WEDGE[0] + [0, 0, 7.5 - 3.25 * k], atol=1e-5)
    np.testing.assert_array_equal(triangles, WEDGE[1])


def check_xdmf(path, frames):
    folder = os.path.dirname(path)
    collections = ElementTree.parse(path).getroot().findall("Domain/Grid")
    assert [c.get("Name") for c in collections] == [group.split("/")[1] for group in [*OWNERS, "tools/punch"]]
    with h5py.File(path.replace(".xdmf", ".h5"), "r") as f:
        for collection, (group, owner) in zip(collections, OWNERS.items()):
            assert collection.get("CollectionType") == "Temporal"
            grids = collection.findall("Grid")
            np.testing.assert_allclose([float(g.find("Time").get("Value")) for g in grids], 0.5 * np.arange(frames))
            for k, grid in enumerate(grids):
                fields = {(a.get("Name"), a.get("Center")): read_item(a.find("DataItem"), folder)
                          for a in grid.findall("Attribute")}
                check_grid(group, read_item(grid.find("Geometry/DataItem"), folder),
                           read_item(grid.find("Topology/DataItem"), folder), fields,
                           f["layers/ply_1" if owner >= 10 else group], owner, k)
    for k, grid in enumerate(collections[-1].findall("Grid")):
        axes = [read_item(item, folder) for item in grid.findall("Geometry/DataItem")]
        check_tool(np.column_stack(axes), read_item(grid.find("Topology/DataItem"), folder), k)
    assert k == frames - 1


def check_vtk(path, frames):
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkCommonDataModel import vtkCompositeDataSet
    from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline

    from vtkmodules.vtkIOXdmf2 import vtkXdmfReader  # in python3-paraview, not in python3-vtk9

    reader = vtkXdmfReader()
    reader.SetFileName(path)
    reader.UpdateInformation()
    information = reader.GetOutputInformation(0)
    key = vtkStreamingDemandDrivenPipeline.TIME_STEPS()
    times = [information.Get(key, i) for i in range(information.Length(key))]
    np.testing.assert_allclose(times, 0.5 * np.arange(frames))
    with h5py.File(path.replace(".xdmf", ".h5"), "r") as f:
        for k, time in enumerate(times):
            reader.UpdateTimeStep(time)
            blocks = reader.GetOutputDataObject(0)
            assert blocks.GetNumberOfBlocks() == len(OWNERS) + 1, blocks.GetNumberOfBlocks()
            for b, (group, owner) in enumerate([*OWNERS.items(), ("tools/punch", 20)]):
                name = blocks.GetMetaData(b).Get(vtkCompositeDataSet.NAME())
                assert group.endswith("/" + name), (group, name)
                grid = blocks.GetBlock(b)
                cells = range(grid.GetNumberOfCells())
                triangles = np.array([[grid.GetCell(e).GetPointId(c) for c in range(3)] for e in cells])
                fields = {(data.GetArrayName(i), centre): vtk_to_numpy(data.GetArray(i))
                          for centre, data in (("Node", grid.GetPointData()), ("Cell", grid.GetCellData()))
                          for i in range(data.GetNumberOfArrays())}
                position = vtk_to_numpy(grid.GetPoints().GetData())
                bounds = np.column_stack([position.min(axis=0), position.max(axis=0)]).ravel()
                np.testing.assert_allclose(grid.GetBounds(), bounds)
                if owner == 20:
                    check_tool(position, triangles, k)
                    continue
                check_grid(group, position, triangles, fields, f["layers/ply_1" if owner >= 10 else group], owner, k)


if __name__ == "__main__":
    command, file, *rest = sys.argv[1:]
    if command == "values":
        check_values(file, int(rest[0]), int(rest[1]), rest[2])
    elif command == "prefix":
        check_values(file, int(rest[0]))
    elif command == "attributes":
        check_attributes(file)
    elif command == "xdmf":
        check_xdmf(file, int(rest[0]))
    elif command == "well_formed":
        ElementTree.parse(file)
    elif command == "vtk":
        check_vtk(file, int(rest[0]))
    else:
        sys.exit(__doc__)
