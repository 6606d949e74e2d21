"""dem.h in Python: worlds of particles.

    import numpy as np, riddle
    from riddle import dem

    definition = dem.def_(dt=4e-6)                            # the fields, defaults and checks of dem_def
    glass = dem.add_material(definition, 2534.1, 50e9, 0.2)
    dem.pair(definition, glass, glass).restitution = 0.78
    world = dem.World(definition)
    world.add_plane(glass, (0, 0, 0), (0, 0, 1))
    world.add_spheres([[0, 0, 0.1]], [0.005], glass)
    world.run(0.5, dem.LINEAR | dem.FRICTION)
    print(world.positions())
    world.picture().save("balls.png")

Functions that take a world are methods of World. Ctrl-C stops a run between steps, and a fill before anything is added;
the world stays usable. A world can be pickled.
"""
import contextlib
import copy
import numbers
import os
import signal
import struct
import sys
import tempfile
import threading
import time as _time
import warnings
import zlib

import numpy as np

from . import _core
from ._core import Error, Structure, api, ffi, lib

_STATES = {"positions": (0, 3), "velocities": (1, 3), "spins": (2, 3), "radii": (3, 0), "masses": (4, 0)}
_RECORDS = {"ids": 0, "groups": 1, "materials": 2, "present": 3}

BYTES_OF_A_SPHERE = 1400.0  # with lists and history: scripts/verify long_and_large


def _number_in(path, key=""):
    """The number after key at the beginning of a line of a file; infinite where there is none."""
    try:
        with open(path, encoding="ascii") as file:
            return next((float(line[len(key):].split()[0]) for line in file if line.startswith(key)), np.inf)
    except (OSError, ValueError, IndexError):
        return np.inf


def _need_memory(what, spheres):
    """Raises MemoryError where so many spheres more do not fit into what the system has free."""
    limit, used = _number_in("/sys/fs/cgroup/memory.max"), _number_in("/sys/fs/cgroup/memory.current")
    free = min(1024.0 * _number_in("/proc/meminfo", "MemAvailable:"), max(limit - used, 0.0) if limit < np.inf
               else np.inf)
    if spheres * BYTES_OF_A_SPHERE > free:
        raise MemoryError(f"{what}: {spheres:.3g} particles take about {1e-9 * spheres * BYTES_OF_A_SPHERE:.3g} GB of "
                          f"memory, of which {1e-9 * free:.3g} GB are free")


class View(np.lib.mixins.NDArrayOperatorsMixin):
    """What a world stores, as it is read: it serves as a read-only array of numpy, and raises once the world has
    changed. Copy it with numpy.array()."""

    def __init__(self, world, values):
        self._world, self._values, self._version = world, values, world._version

    def _now(self):
        if self._version != self._world._version or self._world._c is None:
            raise RuntimeError("the world has changed since this view was taken; take it again")
        return self._values

    def __array__(self, dtype=None, copy=None):
        return np.array(self._now(), dtype=dtype)

    def __array_ufunc__(self, ufunc, method, *inputs, **keywords):
        if any(isinstance(out, View) for out in keywords.get("out", ())):
            raise TypeError("what a world stores cannot be changed through a view")
        return getattr(ufunc,
                       method)(*[value._now() if isinstance(value, View) else value for value in inputs], **keywords)

    def __getattr__(self, name):
        if name.startswith("_"):
            raise AttributeError(name)
        return getattr(self._now(), name)

    def __len__(self):
        return len(self._now())

    def __getitem__(self, index):
        return self._now()[index._now() if isinstance(index, View) else index]

    def __iter__(self):
        return iter(self._now())

    def __repr__(self):
        return f"View({self._now()!r})"


def _pose(motion, now):
    """Where a prescribed motion puts a wall."""
    returned = motion(now)
    try:
        shift, turn = returned
        return _core.vector(3, shift, "shift"), _core.vector(3, turn, "turn")
    except (TypeError, ValueError):
        raise ValueError(f"prescribe: the motion must return ((x, y, z) [m], (rx, ry, rz) [rad]), finite numbers, not "
                         f"{returned!r}") from None


class World(_core.Handle):
    """Particles, walls and links of one scene: dem_world. definition: dem.def_, checked by dem_init; the bad field is
    in the error."""

    _name = "dem_world"
    _free = "dem_free"
    # [m] larger particles are refused: mostly they are millimetres; set it on a world for boulders
    largest_diameter = 1.0
    # what a subclass adds is kept in copies
    _OWN = ("_memory", "_c", "_keep", "_users", "_version", "_callbacks", "_laws")

    def __init__(self, definition=None):
        if not isinstance(definition, Structure) or definition._name != "dem_def":
            raise TypeError(f"World: a dem.def_ is needed, not {type(definition).__name__}")
        self._begin()
        self._hold([definition])  # its functions
        field = ffi.new("const char **")
        status = lib.dem_init(self._c, definition._c, field)
        if status != 0:
            self._c = None
            field = ffi.string(field[0]).decode() if field[0] != ffi.NULL else None
            raise _core.status_error("dem", status, field, _core.of_field(field, {"definition": definition}))

    def _begin(self):
        super()._begin()
        self._version, self._callbacks, self._laws = 0, {}, {}

    def _before_free(self):
        for law in self._laws.values():
            law._forget(self)

    def _do(self, function, *arguments, given=None):
        """Calls a function of C that changes the world and returns a status. given: the arguments by their names in
        Python."""
        try:
            with _core.Call([self]):
                status = function(*arguments)
        finally:
            self._version += 1
        self._check(status, given)

    def _check(self, status, given=None):
        self._version += 1
        if status != 0:
            pair = None
            if status == lib.DEM_PAIR_NOT_SET:
                pair = tuple(lib.riddle_failed_material(self._alive, which) for which in (0, 1))
            error = _core.status_error("dem", status, f"materials {pair[0]} and {pair[1]}" if pair else None,
                                       _core.wrong_arguments(given, changes=True)
                                       if given and status == lib.DEM_BAD_ARGUMENT else None)
            error.materials = pair
            if status in (lib.DEM_NOT_FINITE, lib.DEM_TOO_FAST, lib.DEM_PAIR_NOT_SET):
                error.particle = lib.riddle_failed_id(self._alive)
            raise error

    # ---- reading ----

    count = property(lambda self: lib.riddle_count(self._alive),
                     doc="places of particles; one that has been removed keeps its place for a while: see present()")
    time = property(lambda self: lib.riddle_time(self._alive), doc="[s]")
    step = property(lambda self: lib.riddle_step(self._alive), doc="steps done")
    dt = property(lambda self: lib.riddle_dt(self._alive), doc="time step [s]")
    walls = property(lambda self: lib.riddle_walls(self._alive), doc="number of walls")
    passed_count = property(lambda self: lib.riddle_passed_count(self._alive),
                            doc="particles that have left by an exit and are recorded")
    particle_steps = property(lambda self: lib.riddle_particle_steps(self._alive),
                              doc="sum over steps of the particles present")

    def __len__(self):
        return self.count

    def _state(self, name, out):
        what, width = _STATES[name]
        shape = (self.count, width) if width else (self.count,)
        if out is None:
            out = np.empty(shape)
        elif not (isinstance(out, np.ndarray) and out.dtype == np.float64 and out.shape == shape
                  and out.flags.c_contiguous and out.flags.writeable):
            raise ValueError(f"{name}: out must be a writable contiguous numpy array of float64 with shape {shape}")
        if out.size:
            lib.riddle_states(self._alive, what, ffi.cast("double *", ffi.from_buffer(out)))
        return out

    def _record(self, name):
        values = np.empty(self.count, dtype=np.int64)
        if values.size:
            lib.riddle_records(self._alive, _RECORDS[name], ffi.cast("int64_t *", ffi.from_buffer(values)))
        if name == "present":
            values = values != 0
        values.flags.writeable = False
        return View(self, values)

    def __repr__(self):
        return ("<dem.World, freed>" if self._c is None
                else f"<dem.World of {self.count} particles and {self.walls} walls at {self.time:.6g} s>")

    def wall(self, index):
        """A wall as it is now: wall.force, torque, impulse, position, velocity, ... See dem.Wall."""
        return Wall(self, index)

    # ---- pictures and files ----

    def picture(self, size=(960, 640), direction=(0.3, 1.0, -0.4), speed=0.0, names=()):
        """The world as a picture in perspective, which a notebook shows: picture.save("a.png"), picture.pixels
        [height][width][3]. size: pixels; direction: from the eye to the world; names: of the groups, for the legend;
        speed [m/s] above 0: coloured by speed up to it instead."""
        width, height = (_core.number("int", v, "picture: size") for v in _core._parts(2, size, "picture: size"))
        if not (64 <= width <= 4096 and 64 <= height <= 4096):
            raise ValueError(f"picture: size: 64 to 4096 pixels a side, not {width} x {height}")
        pixels = np.zeros((height, width, 3), dtype=np.uint8)
        texts, pointers = _texts(names, 8)
        if lib.riddle_picture(self._alive, pointers, len(texts), _core.number("double", speed, "picture: speed"),
                              list(_core.vector(3, direction, "picture: direction")),
                              width, height, ffi.cast("unsigned char *", ffi.from_buffer(pixels))) != 0:
            raise MemoryError("picture: out of memory")
        return Picture(pixels)

    def _repr_png_(self):
        return self.picture()._repr_png_() if self.count else None

    def section(self, point=None, normal=(0.0, -1.0, 0.0), right=(1.0, 0.0, 0.0), names=(), title=""):
        """A section to scale, which a notebook shows: the plane through point (default: the particles' centre), seen
        against normal with right to the right. drawing.save("a.svg"), drawing.svg. names: of the groups, for the
        legend."""
        point = point if point is not None else np.mean(self.positions(), axis=0) if self.count else (0.0, 0.0, 0.0)
        vectors = [[float(v) for v in _core.vector(3, v, f"section: {n}")]
                   for n, v in (("point", point), ("normal", normal), ("right", right))]
        texts, pointers = _texts(names, 8)
        with tempfile.TemporaryDirectory() as folder:
            _written("section",
                     lib.riddle_section(self._alive, title.encode(), *vectors, pointers, len(texts), folder.encode(),
                                        b"section.svg"))
            with open(os.path.join(folder, "section.svg"), encoding="utf-8") as file:
                return Drawing(file.read())

    def draw(self, axes, right=0, up=2, unit=1e-3, colours=None):
        """Draws the particles to scale into axes of matplotlib, the nearer ones over the farther, seen along the third
        axis. right, up: the axes that are shown, 0 .. 2; unit: [m] of the axes' numbers; colours: one a particle, by
        default that of its group."""
        from matplotlib.collections import PatchCollection
        from matplotlib.patches import Circle
        x, radii = self.positions() / unit, self.radii() / unit
        depth = 3 - right - up
        order = np.argsort(x[:, depth] * (1.0 if (right, up) in ((0, 1), (1, 2), (2, 0)) else -1.0), kind="stable")
        order = order[np.asarray(self.present())[order]]
        colours = [f"C{int(g) % 10}" for g in self.groups()] if colours is None else colours
        axes.add_collection(PatchCollection([Circle((x[i, right], x[i, up]), radii[i]) for i in order],
                                            facecolors=[colours[i] for i in order],
                                            edgecolors="black", linewidths=0.3))
        axes.set_aspect("equal")
        axes.autoscale_view()

    # ---- changing ----

    def add_spheres(self, centres, diameters, material, group=0):
        """Adds spheres at rest. centres: [n][3] [m], or [3] for one; diameters: [n] [m] or one number. Returns the
        index of the first."""
        centres, diameters = _core._array(centres, np.float64,
                                          "centres"), _core._array(diameters, np.float64, "diameters")
        centres = centres.reshape(1, 3) if centres.shape == (3,) else centres if centres.size else np.empty((0, 3))
        if centres.ndim != 2 or centres.shape[1] != 3:
            raise ValueError(f"add_spheres: centres: shape {centres.shape} given, (n, 3) needed"
                             + ("; transpose it" if centres.shape[:1] == (3,) else ""))
        if diameters.shape not in ((), (len(centres),)):
            raise ValueError(f"add_spheres: diameters: shape {diameters.shape} given, ({len(centres)},) or one "
                             "number needed")
        diameters = np.ascontiguousarray(np.broadcast_to(diameters, (len(centres),)))
        material, group = _core.number("int", material,
                                       "add_spheres: material"), _core.number("int", group, "add_spheres: group")
        first = self.count
        if len(centres):
            _refuse_large(self, diameters.max(initial=0.0, where=np.isfinite(diameters)), "add_spheres")
            given = {"world": self, "centres": centres, "diameters": diameters, "material": material, "group": group}
            self._do(lib.dem_add_spheres, self._alive, len(centres),
                     ffi.cast("double *", ffi.from_buffer(np.ascontiguousarray(centres))),
                     ffi.cast("double *", ffi.from_buffer(diameters)), material, group, given=given)
        return first

    @contextlib.contextmanager
    def _stoppable(self):
        """Around a call that looks for places: Ctrl-C ends it, nothing is added, and KeyboardInterrupt is raised."""
        stopped, before = [], None
        asked = ffi.callback("int(void *)", lambda _: len(stopped))
        if threading.current_thread() is threading.main_thread() and lib.riddle_set_stop(self._alive, asked):
            before = signal.signal(signal.SIGINT, lambda *_: stopped.append(True))
        try:
            yield
        except Error:
            if not stopped:
                raise
        finally:
            if before is not None:
                signal.signal(signal.SIGINT, before)
                lib.riddle_set_stop(self._c, ffi.NULL)
        if stopped:
            raise KeyboardInterrupt

    def run(self, duration, features, progress=None):
        """Advances by duration [s]. features: dem.LINEAR | dem.FRICTION | ... Ctrl-C stops between steps: the world is
        whole, and KeyboardInterrupt is raised. progress: called with the world now and then."""
        self._advance(duration, lambda span: lib.dem_run(self._alive, span, features), progress, features=features)

    def _advance(self, duration, run, progress, **given):
        given = {"world": self, "duration": duration, **given}
        dt = self.dt
        end = self.step + round(min(duration / dt, 2.0**62)) if duration > 0.0 and np.isfinite(duration) else None
        if end is None:
            self._do(run, duration, given=given)
            return
        steps, stopped = 64, []
        before = None
        try:
            before = signal.signal(signal.SIGINT, lambda *_: stopped.append(True))
        except ValueError:
            pass  # not the main thread: the interpreter's own handler does it
        try:
            owed = duration
            while owed > 0.0:
                span = min(owed, steps * dt) if owed > 1.5 * steps * dt else owed
                begun = _time.monotonic()
                self._do(run, span, given=given)
                owed = owed - span if span < owed else 0.0
                if progress is not None:
                    progress(self)
                if stopped:
                    raise KeyboardInterrupt
                took = _time.monotonic() - begun
                steps = int(min(max(steps * (0.1 / max(took, 1e-4)), steps / 4, 16), steps * 4))
        finally:
            if before is not None:
                signal.signal(signal.SIGINT, before)

    def run_law(self, duration, law, progress=None):
        """The same with another law: dem.ContactLaw, one that comes with Riddle; dem.Law, one of your own, made from a
        C file."""
        self._advance(duration, lambda span: law(self, span), progress)

    def prescribe(self, wall, centre, motion):
        """The wall goes where motion(time) says: ((x, y, z) [m], (rx, ry, rz) [rad]). Called here, and in every step:
        slow from Python. An exception in it ends the run in that step and is raised; the world can be read then, but
        not run on."""
        def pose(_, now, out):
            out.shift, out.turn = _pose(motion, now)
        _pose(motion, self.time)
        made = _core._callback(ffi.typeof("dem_motion_fn"), pose, "motion")
        self._do(lib.dem_prescribe, self._alive, _core.number("int", wall, "prescribe: wall"),
                 _core.vector(3, centre, "prescribe: centre"), made, ffi.NULL,
                 given={"world": self, "wall": wall, "centre": centre})
        self._callbacks[wall] = made

    def add_stl(self, material, source, scale=1e-3, weld=1e-6):
        """A wall from an STL file (its path or its bytes). scale [m per unit of the file]. Returns its index and the
        report."""
        if not isinstance(source, (bytes, bytearray)):
            with open(source, "rb") as file:
                source = file.read()
        mesh, report = ffi.new("dem_mesh *"), ffi.new("dem_stl_report *")
        self._check(lib.dem_read_stl(bytes(source), len(source), scale, weld, ffi.NULL, mesh, report),
                    {"scale": scale, "weld": weld})
        wall = lib.dem_add_mesh(self._alive, material, mesh)
        lib.dem_free_mesh(mesh)
        if wall < 0:
            self._check(-wall, {"world": self, "material": material})
        return wall, _core._classes["dem_stl_report"]._of(report[0])

    def coarse_grain(self, cells):
        """Fields of dem_coarse_grain: a dict of numpy arrays [nz][ny][nx], vectors [..][3], tensors [..][3][3]."""
        if not isinstance(cells, Structure) or cells._name != "dem_cells":
            raise TypeError("coarse_grain: a dem.cells is needed")
        nx, ny, nz = (int(v) for v in cells.n)
        if not (0 < nx <= 100000 and 0 < ny <= 100000 and 0 < nz <= 100000 and nx * ny * nz < 1 << 26):
            raise ValueError("coarse_grain: cells.n must be 1 .. 100000 by axis, below 2^26 in all")
        fields = ffi.new("dem_field[]", nx * ny * nz)
        self._check(lib.dem_coarse_grain(self._alive, cells._c, fields))
        table = np.frombuffer(ffi.buffer(fields), dtype=np.float64).reshape(nz, ny, nx, -1).copy()
        return {"density": table[..., 0], "momentum": table[..., 1:4],
                "contact_stress": table[..., 4:13].reshape(nz, ny, nx, 3, 3),
                "kinetic_stress": table[..., 13:22].reshape(nz, ny, nx, 3, 3)}

    # ---- saving ----

    def save(self):
        """The world as bytes: everything that its future depends on."""
        size = lib.dem_save(self._alive, ffi.NULL, 0)
        buffer = ffi.new("unsigned char[]", max(size, 1))
        if size == 0 or lib.dem_save(self._alive, buffer, size) != size:
            raise Error(lib.DEM_OUT_OF_MEMORY, "DEM_OUT_OF_MEMORY", "the world cannot be saved")
        return bytes(ffi.buffer(buffer, size))

    @classmethod
    def load(cls, data):
        """A world from save(). Prescribed motions (Python functions) must be set again."""
        world = cls._new()
        status = lib.dem_load(world._c, bytes(data), len(data), ffi.NULL)
        if status != 0:
            world._c = None
            raise _core.status_error("dem", status)
        return world

    def _more(self):
        return {name: value for name, value in self.__dict__.items() if name not in self._OWN}

    def __reduce__(self):
        return type(self).load, (self.save(),), self._more() or None

    def __copy__(self):
        made = type(self).load(self.save())
        made.__dict__.update(self._more())
        return made

    def __deepcopy__(self, memo):
        made = type(self).load(self.save())
        made.__dict__.update(copy.deepcopy(self._more(), memo))
        return made


def _texts(names, most):
    """Names for C; what keeps them comes first."""
    if isinstance(names, str) or len(names) > most or not all(isinstance(name, str) for name in names):
        raise TypeError(f"names: a list of at most {most} texts is needed, not {names!r}")
    texts = [ffi.new("char[]", name.encode()) for name in names]
    return texts, ffi.new("char *[]", texts or [ffi.NULL])


def _written(what, status):
    """Raises the line that riddle_io.h has told of a file that could not be written."""
    line = ffi.string(lib.riddle_last_line()).decode(errors="replace")
    if status != 0:
        raise OSError(line) if line else ValueError(f"{what}: normal and right must not be parallel or zero")


class Picture:
    """pixels: [height][width][3], red, green, blue. A notebook shows it."""

    def __init__(self, pixels):
        self.pixels = pixels

    def _repr_png_(self):
        height, width, _ = self.pixels.shape
        rows = np.zeros((height, 3 * width + 1), dtype=np.uint8)  # each begins with its filter: none
        rows[:, 1:] = self.pixels.reshape(height, -1)

        def chunk(kind, data):
            return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

        return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0))
                + chunk(b"IDAT", zlib.compress(rows.tobytes(), 6)) + chunk(b"IEND", b""))

    def save(self, path):
        """Writes a PNG."""
        with open(path, "wb") as file:
            file.write(self._repr_png_())

    def __repr__(self):
        return f"<dem.Picture of {self.pixels.shape[1]} x {self.pixels.shape[0]} pixels>"


class Drawing:
    """svg: the text of the file. A notebook shows it."""

    def __init__(self, svg):
        self.svg = svg

    def _repr_svg_(self):
        return self.svg

    def save(self, path):
        """Writes an SVG."""
        with open(path, "w", encoding="utf-8") as file:
            file.write(self.svg)

    def __repr__(self):
        return f"<dem.Drawing of {len(self.svg)} characters>"


class Series:
    """Frames for ParaView: NAME.pvd (particles), NAME_walls.pvd (walls where they are at each time),
    NAME_polyhedra.pvd.

        with dem.Series("out", "drum") as frames:
            for _ in range(50):
                world.run(0.02, LAW)
                frames.add(world)
    """

    def __init__(self, folder, name):
        os.makedirs(folder, exist_ok=True)
        self._series = lib.riddle_series_open(os.fsencode(folder), os.fsencode(name))
        if self._series == ffi.NULL:
            raise OSError(ffi.string(lib.riddle_last_line()).decode(errors="replace")
                          or f"series: {name!r} cannot be opened")

    def add(self, world):
        """Writes a frame of the world as it is now."""
        if not isinstance(world, World):
            raise TypeError(f"series: a World is needed, not {type(world).__name__}")
        if self._series is None:
            raise ValueError("this series has been closed")
        _written("series", lib.riddle_series_add(self._series, world._alive))

    def close(self):
        series, self._series = self._series, None
        if series is not None:
            _written("series", lib.riddle_series_close(series))

    def __enter__(self):
        return self

    def __exit__(self, *error):
        self.close()

    def __del__(self):
        if getattr(self, "_series", None) is not None and self._series != ffi.NULL:
            lib.riddle_series_close(self._series)


class Wall:
    """A wall of a world, read when asked. position [m], velocity [m/s] and normal (the axis of what is round) of its
    own frame; force [N] on it, and torque [N m] about its origin, in the last step; impulse [N s] and angular_impulse
    [N m s]: the time integrals of the force and of the torque about the world's origin (angular_impulse_about: about
    another point), work [J]: done on the particles by its motion and its belt; for means: their differences over the
    time between; spin [rad/s]; coordinate and rate of a wall that is pushed [m or rad, m/s or rad/s]."""

    _VECTORS = ("position", "velocity", "normal", "force", "torque", "impulse", "angular_impulse")
    _NUMBERS = ("kind", "material", "enabled", "spin", "coordinate", "rate", "work")
    _KINDS = {value: name for name, value in _core._constants["dem"].items() if name in
              ("PLANE", "CYLINDER", "SCREEN", "SPHERE", "CONE", "MESH", "EXIT", "DISC")}

    def __init__(self, world, index):
        self._world, self.index = world, _core.number("int", index, "wall")
        self._read()

    def _read(self):
        out = ffi.new("double[28]")
        if lib.riddle_wall(self._world._alive, self.index, out) != 0:
            raise IndexError(f"wall {self.index}: the world has {self._world.walls}")
        return out

    def __getattr__(self, name):
        if name in self._VECTORS:
            at = len(self._NUMBERS) + 3 * self._VECTORS.index(name)
            return np.array([self._read()[at + k] for k in range(3)])
        if name in self._NUMBERS:
            value = self._read()[self._NUMBERS.index(name)]
            return (self._KINDS.get(int(value), str(int(value))).lower() if name == "kind" else bool(value)
                    if name == "enabled" else int(value) if name == "material" else value)
        raise AttributeError(f"a wall has no {name}; it has index, {', '.join(self._NUMBERS + self._VECTORS)}")

    def angular_impulse_about(self, point):
        """The time integral of the torque about a point at rest [N m s]: its difference over the time between is the
        mean torque."""
        return self.angular_impulse - np.cross(_core.vector(3, point, "angular_impulse_about: point"), self.impulse)

    def __dir__(self):
        return ["index", "angular_impulse_about", *self._NUMBERS, *self._VECTORS]

    def __repr__(self):
        return f"<dem.Wall {self.index}, {self.kind}, force {_core.short(self.force)} N>"


for _name in _STATES:
    def _read(self, out=None, _name=_name):
        return self._state(_name, out)
    _read.__doc__ = f"{_name} now, in one numpy array that may be given as out and used again."
    setattr(World, _name, _read)
for _name in _RECORDS:
    def _view(self, _name=_name):
        return self._record(_name)
    _view.__doc__ = f"{_name} of the particles, read-only; raises once the world has changed."
    setattr(World, _name, _view)

_module = sys.modules[__name__]
__all__ = ["World", "Law", "ContactLaw", "ContactPair", "View", "Wall", "Picture", "Drawing", "Series", "pair"]
_core.fill(_module, "dem", {"dem_world": World})


def pair(definition, a, b):
    """The parameters of a pair of materials in a definition, to be edited."""
    if not isinstance(definition, Structure) or definition._name != "dem_def":
        raise TypeError("pair: a dem.def_ is needed")
    a, b = _core.number("int", a, "pair: a"), _core.number("int", b, "pair: b")
    found = lib.dem_pair(definition._c, a, b) if 0 <= min(a, b) <= max(a, b) < definition.materials else ffi.NULL
    if found == ffi.NULL:
        raise IndexError(f"pair: no materials {a}, {b}: the definition has {definition.materials}")
    return _core._classes["dem_pair_def"]._of(found, definition)


class Law:
    """A contact law of your own, compiled from C (python/laws/magnets.c is an example):

        cc -O3 -ffp-contract=off -fno-math-errno -fno-trapping-math -fPIC -shared -I. python/laws/magnets.c -lm -o
        magnets.so

    The file includes dem.h, defines the law and its kernel, and two functions: size_t law_world_size(void), which
    returns sizeof(dem_world), and dem_status law_run(dem_world *world, double duration). It must be of the same version
    of dem.h as the binding. It may have three more, which wet.c shows: law_set and law_get for its numbers, law_forget
    for what it keeps of a world."""

    def __init__(self, path):
        self._path = os.path.abspath(os.fspath(path))
        self._ffi = _core.ffi_of_law()
        try:
            self._lib = self._ffi.dlopen(self._path)
            size = self._lib.law_world_size()
        except (OSError, AttributeError) as error:
            raise ImportError(f"{self._path}: no law in a shared library ({error})") from None
        if size != lib.size_of_dem_world():
            raise ImportError(f"{self._path}: made with another version of dem.h")

    def _function(self, name):
        try:
            return getattr(self._lib, name)
        except AttributeError:
            return None

    def set(self, name, value):
        """Sets a number of the law, if its file has int law_set(const char *name, double value), which returns 0; 1:
        there is no such number; 2: the value is outside its range."""
        function, number = self._function("law_set"), _core.number("double", value, f"law: {name}")
        refused = function(name.encode(), number) if function else 1
        if refused:
            raise ValueError(f"{self._path}: "
                             + (f"{name} cannot be {number}" if refused == 2
                                else f"the law has no number {name!r} to be set"))

    def get(self, name):
        """A number of the law, if its file has double law_get(const char *name), which returns NaN where there is no
        such number."""
        function = self._function("law_get")
        value = function(name.encode()) if function else np.nan
        if np.isnan(value):
            raise ValueError(f"{self._path}: the law has no number {name!r}")
        return value

    def _address(self, world):
        return self._ffi.cast("void *", int(ffi.cast("uintptr_t", world._alive)))

    def _forget(self, world):
        function = self._function("law_forget")
        if function:
            function(self._address(world))

    def __call__(self, world, duration):
        if not isinstance(world, World):
            raise TypeError(f"law: a World is needed, not {type(world).__name__}")
        world._laws[self._path] = self
        return self._lib.law_run(self._address(world), duration)


class ContactPair:
    """What a ContactLaw wants of a pair of materials beside dem.pair. rolling: coefficient mu_r [-] of "epsd", the
    tangent of the slope on which a ball begins to roll; rolling_damping [-], 0.3; twisting [-]; surface_energy: work of
    adhesion of both surfaces together [J/m2]; bond_modulus [Pa]: 0, the pair does not bond; bond_shear [-], 0.4;
    bond_radius: over the smaller sphere's [-], 1; bond_damping [-], 0.1; tensile, shear: strengths [Pa], infinite. All
    others are 0 to begin with."""

    __slots__ = ("_law", "_numbers")
    _FIELDS = ("rolling", "rolling_damping", "twisting", "surface_energy", "bond_modulus", "bond_shear", "bond_radius",
               "bond_damping", "tensile", "shear")

    def __init__(self, law, numbers):
        object.__setattr__(self, "_law", law)
        object.__setattr__(self, "_numbers", numbers)

    def _at(self, name):
        if name not in self._FIELDS:
            raise AttributeError(f"a pair of a ContactLaw has no {name}; it has {', '.join(self._FIELDS)}")
        return self._FIELDS.index(name)

    def __getattr__(self, name):
        return self._numbers[self._at(name)]

    def __setattr__(self, name, value):
        at, before = self._at(name), self._numbers[self._at(name)]
        self._numbers[at] = _core.number("double", value, f"ContactLaw: {name}")
        if lib.riddle_contact_bad_field(self._law._laws) != ffi.NULL:
            self._numbers[at] = before
            raise ValueError(f"ContactLaw: {name} cannot be {value}")

    def __dir__(self):
        return list(self._FIELDS)

    def __repr__(self):
        return "<dem.ContactPair " + ", ".join(f"{name} = {self._numbers[k]:g}"
                                               for k, name in enumerate(self._FIELDS)) + ">"


class ContactLaw:
    """A contact law that comes with Riddle (dem_laws.h), by its name: "epsd" and "epsd_hertz", linear springs and Hertz
    with rolling that rests; "dmt" and "jkr", Hertz with adhesion; "bonds", linear with bonds that break.

        law = dem.ContactLaw("jkr")
        law.pair(powder, powder).surface_energy = 0.05
        world.run_law(1e-3, law)

    Stiffness, restitution and friction come from dem.pair. The numbers are not saved with a world."""

    def __init__(self, name):
        self._model = lib.riddle_contact_model(name.encode()) if isinstance(name, str) else -1
        if self._model < 0:
            raise ValueError(f"ContactLaw: {name!r}: there are epsd, epsd_hertz, dmt, jkr, bonds")
        self.name, self._laws = name, ffi.gc(lib.riddle_contact_laws(), lib.riddle_contact_free)
        if self._laws == ffi.NULL:
            raise MemoryError("ContactLaw")

    def pair(self, a, b):
        """The numbers of a pair of materials, in either order, to be edited: dem.ContactPair."""
        numbers = lib.riddle_contact_pair(self._laws, _core.number("int", a, "ContactLaw: a"),
                                          _core.number("int", b, "ContactLaw: b"))
        if numbers == ffi.NULL:
            raise IndexError(f"ContactLaw: no materials {a}, {b}")
        return ContactPair(self, numbers)

    def bond(self, world):
        """Makes bonds of what touches now, where the pair has a bond_modulus. Only of "bonds"."""
        if self.name != "bonds":
            raise ValueError(f"bond: of ContactLaw('bonds') only, not of {self.name!r}")
        world._do(lib.riddle_contact_bond, world._alive, self._laws, self._model)

    def bonds(self, world):
        """How many bonds of a world are whole, which this law has run."""
        return lib.riddle_contact_bonds(world._alive) if self.name == "bonds" else 0

    def __call__(self, world, duration):
        if not isinstance(world, World):
            raise TypeError(f"law: a World is needed, not {type(world).__name__}")
        return lib.riddle_contact_run(world._alive, self._laws, self._model, duration)

    def __repr__(self):
        return f"dem.ContactLaw({self.name!r})"


def _method(function):
    changes = not any(p["name"] == "world" and "const" in p["type"]
                      for p in api["headers"]["dem"]["functions"][function.c_name]["parameters"])

    def call(self, *args, **keywords):
        try:
            return function(self, *args, **keywords)
        finally:
            if changes:
                self._version += 1

    call.__name__, call.__doc__, call.c_name = function.__name__, function.__doc__, function.c_name
    call.__signature__ = function.method_signature
    return call


def _in_metres(world, sizes, what):
    """Raises where sizes look like millimetres."""
    # noqa: F821
    largest = (sizes.diameter[:max(min(sizes.count, len(sizes.diameter)), 0)].max(initial=0.0)
               if sizes.kind == SIZES_LIST else sizes.largest)
    _refuse_large(world, largest, what)


def _refuse_large(world, diameter, what):
    if diameter > world.largest_diameter:
        raise ValueError(f"{what}: a diameter of {diameter:.6g} m is above {world.largest_diameter:.6g} m: are lengths "
                         "in metres? "
                         "Set world.largest_diameter for larger particles")


def _number_of(world, feed, mass):
    """About how many bodies of a feed have a mass [kg]; 0 where that cannot be told."""
    random = np.array([1], dtype=np.uint64)
    # noqa: F821 (made by fill)
    volume = np.pi / 6.0 * np.mean([draw_size(feed.sizes, random) ** 3 for _ in range(200)])
    number = mass / (lib.riddle_density(world._alive, feed.material) * volume)
    return number if number > 0.0 and feed.polyhedron == 0 and feed.compound is None else 0.0


def _placing(method, name):
    """A method that looks for places: told at once where memory does not suffice, and stopped by Ctrl-C."""
    def call(self, *args, **keywords):
        given = dict(zip(("feed", "count" if name == "dem_fill" else "mass"), args), **keywords)
        feed, amount = given.get("feed"), given.get("count", given.get("mass"))
        fills = (name.startswith("dem_fill") and isinstance(feed, Structure) and feed._name == "dem_feed"
                 and isinstance(amount, (numbers.Real, np.ndarray)))
        if fills:
            amount = _core.number("double", amount, f"{method.__name__}: {'count' if name == 'dem_fill' else 'mass'}")
            number = amount if name == "dem_fill" else _number_of(self, feed, amount)
            _in_metres(self, feed.sizes, method.__name__)
            pieces = (feed.clump.spheres if feed.clump is not None else
                      feed.compound.parts if feed.compound is not None else 1)
            _need_memory(method.__name__, number * pieces)
            before = feed.placed, feed.missed
        with self._stoppable():
            answer = method(self, *args, **keywords)
        if fills and feed.placed == before[0] and feed.missed > before[1]:
            warnings.warn(f"{method.__name__}: none of {feed.missed - before[1]} bodies found a place in the region: "
                          "are all lengths in metres?", stacklevel=2)
        return answer

    call.__name__, call.c_name = method.__name__, method.c_name
    call.__doc__ = method.__doc__ + "\n\nCtrl-C ends it; nothing has changed then."
    call.__signature__ = method.__signature__
    return call


for _name, _function in _functions.items():  # noqa: F821 (made by fill)
    if _core.handle_of(api["headers"]["dem"]["functions"][_name]) and not hasattr(World, _function.__name__):
        _made = _method(_function)
        setattr(World, _function.__name__, _placing(_made, _name)
                if _name.startswith(("dem_fill", "dem_feed_")) else _made)
