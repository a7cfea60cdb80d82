#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes one small mesh in many formats with independent programs (meshio, gmsh, tetgen) into a folder.

Usage: make_files.py FOLDER. Each line of FOLDER/list.txt names a file and what a reader must find in it:
NAME TETS VOLUME6 (six times the volume; - where it depends on the mesher). Programs that are not installed
are left out, with a message. tests/formats/test_independent.c runs this and reads what it made."""
import os
import subprocess
import sys

folder = sys.argv[1]
made = []

# Two cubes side by side as hexahedra, and as wedges, and two tets; a scalar on points, another on cells.
POINTS = [(x, y, z) for z in (0.0, 1.0) for y in (0.0, 1.0) for x in (0.0, 1.0, 2.0)]
HEXAHEDRA = [[0, 1, 4, 3, 6, 7, 10, 9], [1, 2, 5, 4, 7, 8, 11, 10]]
TETS = [[0, 1, 3, 6], [2, 5, 4, 11], [1, 4, 3, 10]]


def note(name, tets, volume6):
    made.append("%s %s %s" % (name, tets, volume6))


def with_meshio():
    import meshio
    import numpy

    points = numpy.array(POINTS)
    scalar = points[:, 0] + 10 * points[:, 1]

    def mesh(cells):
        return meshio.Mesh(points, cells, point_data={"s": scalar},
                           cell_data={"c": [numpy.arange(len(c), dtype=float) for _, c in cells]})

    tets = mesh([("tetra", numpy.array(TETS))])
    hexahedra = mesh([("hexahedron", numpy.array(HEXAHEDRA)), ("quad", numpy.array([[0, 1, 4, 3]]))])

    def write(name, what, count, volume6, **options):
        try:
            what.write(os.path.join(folder, name), **options)
            note(name, count, volume6)
        except Exception as error:  # a writer that this version of meshio lacks
            print("meshio could not write %s: %s" % (name, error))

    for kind, what, count, volume6 in (("tet", tets, 3, 3), ("hex", hexahedra, 12, 12)):
        write(kind + "_ascii.vtu", what, count, volume6, binary=False)
        write(kind + "_zlib.vtu", what, count, volume6, compression="zlib")
        write(kind + "_lzma.vtu", what, count, volume6, compression="lzma")
        write(kind + "_plain.vtu", what, count, volume6, compression=None)
        write(kind + "_ascii.vtk", what, count, volume6, file_format="vtk", binary=False)
        write(kind + "_binary.vtk", what, count, volume6, file_format="vtk", binary=True)
        write(kind + "_42_ascii.vtk", what, count, volume6, file_format="vtk42", binary=False)
        write(kind + "_42_binary.vtk", what, count, volume6, file_format="vtk42", binary=True)
        write(kind + "_22_ascii.msh", what, count, volume6, file_format="gmsh22", binary=False)
        write(kind + "_22_binary.msh", what, count, volume6, file_format="gmsh22", binary=True)
        write(kind + "_41_ascii.msh", what, count, volume6, file_format="gmsh", binary=False)
        write(kind + "_41_binary.msh", what, count, volume6, file_format="gmsh", binary=True)
        plain = meshio.Mesh(points, what.cells)
        write(kind + ".mesh", plain, count, volume6, file_format="medit")
    write("tet.node", meshio.Mesh(points, tets.cells), 3, 3, file_format="tetgen")


GEOMETRY = """SetFactory("Built-in");
Point(1) = {0, 0, 0, 0.5}; Point(2) = {1, 0, 0, 0.5}; Point(3) = {1, 1, 0, 0.5}; Point(4) = {0, 1, 0, 0.5};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4}; Plane Surface(1) = {1};
Extrude {0, 0, 1} { Surface{1}; %s }
"""


def with_gmsh():
    for kind, extra in (("tet", ""), ("wedge", "Layers{2}; Recombine;")):
        geometry = os.path.join(folder, kind + ".geo")
        with open(geometry, "w") as file:
            file.write(GEOMETRY % extra)
        for order in (1, 2):
            for version, name in (("msh22", "22"), ("msh41", "41")):
                for binary in (0, 1):
                    out = "gmsh_%s_%d_%s_%d.msh" % (kind, order, name, binary)
                    command = ["gmsh", "-3", "-order", str(order), "-format", version, "-v", "0", "-nt", "1",
                               "-o", os.path.join(folder, out), geometry] + (["-bin"] if binary else [])
                    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, timeout=100)
                    note(out, "-", 6)
        for ending in ("mesh", "vtk") if kind == "tet" else ("vtk",):  # gmsh leaves wedges out of MEDIT files
            out = "gmsh_%s.%s" % (kind, ending)
            subprocess.run(["gmsh", "-3", "-v", "0", "-nt", "1", "-o", os.path.join(folder, out), geometry],
                           check=True, stdout=subprocess.DEVNULL, timeout=100)
            note(out, "-", 6)


def with_tetgen():
    with open(os.path.join(folder, "box.poly"), "w") as file:
        file.write("8 3 1 0\n")
        for i in range(8):
            file.write("%d %d %d %d %d\n" % (i + 1, i & 1, i >> 1 & 1, i >> 2, i))
        file.write("6 0\n")
        for face in ((1, 2, 4, 3), (5, 6, 8, 7), (1, 2, 6, 5), (3, 4, 8, 7), (1, 3, 7, 5), (2, 4, 8, 6)):
            file.write("1\n4 %d %d %d %d\n" % face)
        file.write("0\n0\n")
    subprocess.run(["tetgen", "-pqa0.05QA", os.path.join(folder, "box.poly")], check=True,
                   stdout=subprocess.DEVNULL, timeout=100)
    for ending in ("node", "ele", "face"):
        note("box.1." + ending, "-", 6)


for program, write_all in (("meshio", with_meshio), ("gmsh", with_gmsh), ("tetgen", with_tetgen)):
    try:
        write_all()
    except (ImportError, FileNotFoundError) as error:
        print("%s is not installed: %s" % (program, error))
with open(os.path.join(folder, "list.txt"), "w") as file:
    file.write("\n".join(made) + "\n")
