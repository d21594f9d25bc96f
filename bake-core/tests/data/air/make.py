"""Writes the OpenVDB files of this folder and what OpenVDB itself reads from them (values.csv).

Needs Debian's python3-openvdb. The files' UUIDs differ from run to run, their content does not.
"""
import math

import pyopenvdb as vdb


def fog(name, half, shift=0):
    """Shifted by `shift` voxels along each axis: a slanted ramp in a ball with a hole, one constant tile of 8 voxels, and single voxels far apart."""
    grid = vdb.FloatGrid()
    grid.name = name
    grid.gridClass = vdb.GridClass.FOG_VOLUME
    grid.saveFloatAsHalf = half
    access = grid.getAccessor()
    for x in range(-6, 7):
        for y in range(-6, 7):
            for z in range(-6, 7):
                radius = math.sqrt(x * x + y * y + z * z)
                if 2.5 < radius < 6.0:
                    access.setValueOn((x + shift, y + shift, z + shift), 0.25 + 0.0625 * (x + 6) + 0.015625 * (z + 6))
    grid.fill((8 + shift, 8 + shift, 8 + shift), (15 + shift, 15 + shift, 15 + shift), 0.75)
    access.setValueOn((20 + shift, shift - 9, shift + 1), 2.0)
    access.setValueOff((3 + shift, shift, shift), 5.0)
    return grid


def main():
    affine = [[0.0, 0.5, 0.0, 0.0], [-0.5, 0.0, 0.0, 0.0], [0.0, 0.0, 0.25, 0.0], [1.0, 2.0, 3.0, 1.0]]
    plain, turned, half = fog("density", False), fog("turned", False, 16), fog("half", True, 16)
    plain.transform = vdb.createLinearTransform(0.1)
    turned.transform = vdb.createLinearTransform(affine)
    half.transform = vdb.createLinearTransform(0.2)
    half.transform.translate((1.0, 0.0, -1.0))
    level_set = vdb.createLevelSetSphere(radius=1.5, center=(5.0, 5.0, 5.0), voxelSize=0.5)
    level_set.name = "surface"
    velocity = vdb.Vec3SGrid()
    velocity.name = "velocity"
    velocity.getAccessor().setValueOn((0, 0, 0), (1.0, 2.0, 3.0))
    empty = vdb.FloatGrid()
    empty.name = "empty"
    endless = vdb.FloatGrid(0.5)
    endless.name = "endless"
    endless.getAccessor().setValueOn((0, 0, 0), 1.0)
    vdb.write("fog.vdb", grids=[plain])
    vdb.write("several.vdb", grids=[half, turned, level_set, velocity, empty, endless])
    vdb.write("surface.vdb", grids=[level_set])

    with open("values.csv", "w") as out:
        out.write("file,grid,x,y,z,active,value,world_x,world_y,world_z\n")
        for file in ["fog.vdb", "several.vdb"]:
            for name in {"fog.vdb": ["density"], "several.vdb": ["half", "turned"]}[file]:
                grid = vdb.read(file, name)
                access = grid.getConstAccessor()
                points = [(x, y, z) for x in (-6, -3, 0, 3, 5) for y in (-5, -1, 0, 4) for z in (-4, 0, 3, 5)]
                points += [(8, 8, 8), (15, 15, 15), (11, 9, 14), (16, 15, 15), (20, -9, 1), (19, -9, 1)]
                shift = 16 if file == "several.vdb" else 0
                for point in points:
                    ijk = tuple(axis + shift for axis in point)
                    value, active = access.probeValue(ijk)
                    world = grid.transform.indexToWorld(ijk)
                    row = [file, name, *ijk, int(active), repr(value), *(repr(w) for w in world)]
                    out.write(",".join(str(field) for field in row) + "\n")


main()
