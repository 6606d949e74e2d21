"""Reads series by VTK's own reader: read_vtk.py FOLDER NAME. Prints one line about NAME.pvd and one about
NAME_walls.pvd: frames, points and cells of the first and the last, the arrays, and which walls have moved between the
two."""
import os
import sys
import xml.etree.ElementTree as xml

import vtk


def frames(folder, name):
    index = xml.parse(os.path.join(folder, name + ".pvd"))
    times = [(float(d.get("timestep")), d.get("file")) for d in index.iter("DataSet")]
    assert times == sorted(times) and len(set(t for t, _ in times)) == len(times), "times do not rise"
    found = []
    for _, file in times:
        reader = vtk.vtkXMLPolyDataReader()
        assert reader.CanReadFile(os.path.join(folder, file)), file
        reader.SetFileName(os.path.join(folder, file))
        reader.Update()
        found.append(reader.GetOutput())
    return found


def arrays(data):
    point = data.GetPointData()
    return [point.GetArrayName(k) for k in range(point.GetNumberOfArrays())]


def corners(data):
    wall = data.GetPointData().GetArray("wall")
    places = {}
    for k in range(data.GetNumberOfPoints()):
        places.setdefault(int(wall.GetValue(k)), []).append(data.GetPoint(k))
    return places


folder, name = sys.argv[1:]
grains, walls = frames(folder, name), frames(folder, name + "_walls")
for data in grains:
    assert data.GetNumberOfVerts() == data.GetNumberOfPoints()
    diameter = data.GetPointData().GetArray("diameter_m")
    assert all(0.0 < diameter.GetValue(k) < 1.0 for k in range(data.GetNumberOfPoints()))
for data in walls:
    assert data.GetNumberOfPolys() > 0 and data.GetMaxCellSize() == 3
print(name, len(grains), grains[0].GetNumberOfPoints(), grains[-1].GetNumberOfPoints(), *arrays(grains[-1]))
first, last = corners(walls[0]), corners(walls[-1])
moved = [k for k in sorted(first) if first[k] != last.get(k)]
print(name + "_walls", len(walls), "walls", *sorted(first), "moved", *moved)
