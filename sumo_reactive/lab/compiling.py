"""The first compile of the kernels, by two processes at a time: what one of them makes, every later one loads."""

from __future__ import annotations

import gc
import subprocess
import sys
from typing import Any

from sumo_reactive.driver.kernel_folder import CACHE_FOLDER, is_cached

COMPILERS = 2
"""Processes, which take about as long as each other."""


def compile_ahead() -> None:
    """Have the kernels compiled and kept, unless they are. Whatever this cannot do, their first call does."""
    if CACHE_FOLDER is None or is_cached():
        return
    processes: list[subprocess.Popen[bytes]] = []
    try:
        for part in range(COMPILERS):
            command = [sys.executable, "-m", __name__, str(part)]
            quiet = subprocess.DEVNULL
            processes.append(subprocess.Popen(command, stdin=quiet, stdout=quiet, stderr=quiet))
        for process in processes:
            process.wait()
    except OSError:
        pass  # no process to be had
    finally:
        for process in processes:
            process.kill()
            process.wait()


def kernels_of(part: int) -> dict[Any, str]:
    """Return the kernels that a run calls, of a part, with the kinds of their arguments: F a float, R the lattice's
    rounds, V and N rows of floats and ints, M and T tables of floats in two and three dimensions, O and W a place on C and
    the manner of driving."""
    from sumo_reactive.driver.field import command_grid, demands, desired_speed, field, velocity
    from sumo_reactive.driver.geometry import curve, polyline, swept
    from sumo_reactive.driver.path import aside
    from sumo_reactive.driver.pilot import assessment
    from sumo_reactive.driver.vehicle import safe_speed
    from sumo_reactive.driver.view import corridor, foresee
    from sumo_reactive.lab.metrics import moment, way

    if part == 0:
        return {
            field.choose_command: "VVVRFFFFVVVFFMTFFFMFFV", field.potentials_over: "VVVFFFFVVVFFMTMFFV",
            way.along_way: "MNM",
        }  # fmt: skip
    return {
        desired_speed.wished: "OWFMMMMVVVVVF", command_grid.lattice_axes: "FFFFFF",
        corridor.related: "MFFFFFVVVFFFVVF", corridor.blocking_ones: "MVVVFFFVVF",
        swept.swept_sides: "VVVFFFFFF", demands.bend_window: "F",
        assessment.drive_ahead: "FFFVVVVFFMFFFFFFFFFFM", assessment.first_contact: "MFFMNNMVVFF",
        assessment.speeds_ahead: "MNMFFFF", assessment.time_of: "MFF",
        aside._clear_of_body: "VVVMF", polyline._at: "VVVF", polyline._heading_at: "VVVF",
        polyline._sampled: "MVF", polyline._place: "VVVFFF", polyline._places: "VVVMF", polyline.wrapped: "F",
        curve.project_each: "MVVFVF", curve.project_on_curve: "FFVVFFF", curve.located: "FFFFVVFF",
        foresee.turned: "MFFFF", foresee.point_at: "MF",
        velocity.carried_out: "VFFFFFFF", safe_speed.stopping_speed: "FFF", safe_speed.following_speed: "FFFF",
        moment.contacts: "VM", moment.nearer: "MFFF",
    }  # fmt: skip


def compile_part(part: int) -> None:
    """Compile a part of the kernels for arguments of the kinds that a run gives them."""
    from numba import float64, int64, types

    from sumo_reactive.driver.field.command_grid import ROUNDS
    from sumo_reactive.driver.field.demands import Manner
    from sumo_reactive.driver.field.desired_speed import OnCurve

    kinds = {
        "F": float64, "R": types.literal(ROUNDS),
        "V": float64[::1], "N": int64[::1], "M": float64[:, ::1], "T": float64[:, :, ::1],
        "O": types.NamedUniTuple(float64, len(OnCurve._fields), OnCurve),
        "W": types.NamedUniTuple(float64, len(Manner._fields), Manner),
    }  # fmt: skip
    for kernel, letters in kernels_of(part).items():
        kernel.compile(tuple(kinds[letter] for letter in letters))


if __name__ == "__main__":
    gc.disable()  # a short life, in which little is thrown away
    compile_part(int(sys.argv[1]))
