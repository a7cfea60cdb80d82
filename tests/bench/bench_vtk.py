#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""VTK's projected tetrahedra on the meshes of bench_soft, as lines of the same CSV (python3-vtk9, through software
OpenGL; run under xvfb-run where there is no display). Seconds are medians of five frames, render and read back, from
different places, half a degree apart, so that each is sorted; VTK does not tell its sort from its drawing.

  xvfb-run -a python3 bench_vtk.py DATA_FOLDER [MESH...]   # post.vtu, or DATA_FOLDER/plot3d
"""
import math
import statistics
import sys
import time

import vtk

ROUNDS = 5
MESHES = ["spx.vtu", "can.vtu", "gears_t.vtu", "torus_vt.vtu", "fire.vtu", "disk_out_ref.vtu", "impeller.vtu",
          "sci_torso.vtu", "bucky.vtu", "bluntfin.vtu", "post.vtu"]


def load(path):
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(path)
    split = vtk.vtkDataSetTriangleFilter()
    split.SetInputConnection(reader.GetOutputPort())
    split.TetrahedraOnlyOn()
    split.Update()
    grid = split.GetOutput()
    points = grid.GetPointData()
    if points.GetNumberOfArrays() > 0:
        points.SetActiveScalars(points.GetArrayName(0))
    return grid


def transfer(low, high):
    colour, opacity = vtk.vtkColorTransferFunction(), vtk.vtkPiecewiseFunction()
    for at, rgb in ((0, (0, 0, 1)), (.25, (0, 1, 1)), (.5, (0, 1, 0)), (.75, (1, 1, 0)), (1, (1, 0, 0))):
        colour.AddRGBPoint(low + at * (high - low), *rgb)
    opacity.AddPoint(low, 0)
    opacity.AddPoint(high, .4)
    return colour, opacity


def measure(folder, name, size):
    grid = load(folder + "/" + name)
    array = grid.GetPointData().GetScalars()
    if array is None:
        return
    low, high = array.GetRange(0)
    bounds = grid.GetBounds()
    diagonal = math.dist(bounds[0::2], bounds[1::2])
    colour, opacity = transfer(low, high)
    volume, mapper = vtk.vtkVolume(), vtk.vtkProjectedTetrahedraMapper()
    mapper.SetInputData(grid)
    volume.SetMapper(mapper)
    volume.GetProperty().SetColor(colour)
    volume.GetProperty().SetScalarOpacity(opacity)
    volume.GetProperty().SetScalarOpacityUnitDistance(diagonal / 50)
    renderer, window = vtk.vtkRenderer(), vtk.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    window.SetSize(size, size)
    window.AddRenderer(renderer)
    renderer.AddVolume(volume)
    camera = renderer.GetActiveCamera()
    centre = [(bounds[2 * k] + bounds[2 * k + 1]) / 2 for k in range(3)]
    distance = .5 * diagonal / math.sin(math.radians(15))
    seconds, processor = [], []
    for i in range(ROUNDS + 1):
        a, e = math.radians(30.96 + 0.5 * i), math.radians(34.45)
        way = (math.cos(e) * math.cos(a), math.cos(e) * math.sin(a), math.sin(e))
        camera.SetFocalPoint(centre)
        camera.SetPosition([centre[k] + distance * way[k] for k in range(3)])
        camera.SetViewUp(0, 0, 1)
        camera.SetViewAngle(30)
        renderer.ResetCameraClippingRange()
        begin, used = time.perf_counter(), time.process_time()
        window.Render()
        pixels = vtk.vtkFloatArray()
        window.GetRGBAPixelData(0, 0, size - 1, size - 1, 0, pixels)
        seconds.append(time.perf_counter() - begin)
        processor.append(time.process_time() - used)
    print("%s,%d,2,vtk,%d,0,0,%.5f,%.5f,0," % (name, size, grid.GetNumberOfCells(), statistics.median(seconds[1:]),
                                              min(processor[1:])), flush=True)


for mesh in sys.argv[2:] or MESHES:
    for pixels_high in (512, 1024):
        measure(sys.argv[1], mesh, pixels_high)
