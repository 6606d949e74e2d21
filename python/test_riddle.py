#!/usr/bin/env python3
"""Tests of the Python binding: python/test_riddle.py [--seconds N] [Class.test...]. Prints "N passed, N failed"."""
import ast
import contextlib
import copy
import gc
import inspect
import io
import json
import os
import pathlib
import pickle
import random
import re
import resource
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import unittest.mock
import warnings
import zlib

here = os.path.dirname(os.path.abspath(__file__))
root = os.path.dirname(here)
sys.path.insert(0, here)
import numpy as np

import riddle
from riddle import _core, blocking, bridge, calibrate, classifier, dem, filtration, granulation, screen

SECONDS = float(sys.argv[sys.argv.index("--seconds") + 1]) if "--seconds" in sys.argv else 5.0
LAW = dem.LINEAR | dem.FRICTION


def without_a_pair():
    """A floor of material 1; its pair with material 0 is not set."""
    definition = dem.default_def()
    for density in (2500.0, 7800.0):
        dem.add_material(definition, density, 1e7, 0.3)
    world = dem.World(definition)
    world.add_plane(1, (0, 0, 0), (0, 0, 1))
    return world


def bed(n=60, dt=1e-5):
    definition = dem.def_(dt=dt)
    glass = dem.add_material(definition, 2500.0, 5e10, 0.2)
    dem.pair(definition, glass, glass).stiffness = 1e4
    world = dem.World(definition)
    world.add_plane(glass, (0, 0, 0), (0, 0, 1))
    feed = dem.default_feed()
    feed.region = dem.box_region((0, 0, 0.01), (0.05, 0.05, 0.08))
    feed.sizes = dem.one_size(4e-3)
    world.fill(feed, n)
    return world


class Sources(unittest.TestCase):
    def test_one_source_of_several_classes(self):
        world, feeds = bed(0), []
        for k, diameter in enumerate((5e-3, 2e-3)):
            feeds.append(dem.default_feed())
            feeds[k].region = dem.box_region((0, 0, 0.01), (0.05, 0.05, 0.05))
            feeds[k].sizes, feeds[k].group = dem.one_size(diameter), k
        source = dem.source(feed=feeds, share=[3, 1])
        self.assertEqual(source.classes, 2)
        world.fill_source_mass(source, 0.01)
        world.feed_source_mass(source, 0.05, 0.1)
        placed = [feed.placed_mass for feed in source.feed]
        self.assertAlmostEqual(placed[0], 0.75 * sum(placed), delta=2e-4)
        self.assertAlmostEqual(sum(placed), 0.015, delta=2e-4)
        self.assertEqual(feeds[0].placed, 0)  # the source has copies
        self.assertEqual(world.count, sum(feed.placed for feed in source.feed))
        source.classes = 3
        with self.assertRaises(ValueError):
            world.feed_source(source, 1.0, 1.0)
        with self.assertRaises(TypeError):
            source.feed = [dem.one_size(1e-3)]
        with self.assertRaises((ValueError, dem.Error)):
            world.feed_source(dem.source(), 1.0, 1.0)


class Complete(unittest.TestCase):
    def test_every_public_function_is_there(self):
        declared = set()
        for header in _core.api["headers"].values():
            with open(os.path.join(root, header["file"]), encoding="utf-8") as file:
                text = file.read()
            upper = re.search(r"^#ifndef ([A-Z][A-Z_]*)_API$", text, re.M)[1]
            declared |= set(re.findall(rf"^{upper}_API [^(;]*[ *]({upper.lower()}_[a-z0-9_]+)\(", text, re.M))
        declared = {name for name in declared if "__" not in name}
        known = {name for header in _core.api["headers"].values() for name in header["functions"]}
        self.assertEqual(declared - known, set())
        self.assertGreater(len(known), 400)
        for lower, header in _core.api["headers"].items():
            module = getattr(riddle, lower)
            for name in header["functions"]:
                if _core.in_python(name):
                    self.assertIn(name, module._functions)
                else:
                    self.assertRegex(_core.api["shapes"][name], r"^C only \(.+\)$", name)

    def test_every_function_can_be_called(self):
        """Whatever a function takes or makes is something that the binding can give to C."""
        never = []
        for lower, header in _core.api["headers"].items():
            for name, about in header["functions"].items():
                if not _core.in_python(name) or about["hook"]:
                    continue
                for p in _core.Function(lower, name, about).parameters:
                    known = (p.hidden or p.opaque or p.structure or p.dtype is not None
                             and (not p.made or p.shape is not None))
                    if p.pointer and not p.callback and not known:
                        never.append(f"{name}: {p.name}")
        self.assertEqual(never, [])

    def test_the_description_is_that_of_the_headers(self):
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([sys.executable, os.path.join(here, "generate.py"), folder], check=True,
                           stdout=subprocess.DEVNULL)
            with open(os.path.join(folder, "api.json"), encoding="utf-8") as file:
                self.assertEqual(json.load(file), _core.api)

    def test_docstrings_have_units(self):
        self.assertIn("[m]", bridge.harmonic_radius.__doc__)
        self.assertIn("[N/m]", bridge.liquid.__doc__)
        self.assertIn("[s]", dem.World.run.__doc__)


class Comments(unittest.TestCase):
    """The default that a field's comment states is what the function without arguments sets that makes the
    structure."""

    NUMBER = r"-?(?:\d+(?:\.\d+)?(?:e-?\d+)?)(?:/\d+)?"
    WORDS = {"infinite": np.inf, "HUGE_VAL": np.inf, "NaN": np.nan, "NAN": np.nan, "true": 1, "false": 0}

    def flat(self, value):
        """The numbers of a field: none of a structure or a pointer."""
        if not isinstance(value, _core.ffi.CData):
            return [float(value)]
        return [x for item in value for x in self.flat(item)] if _core.ffi.typeof(value).kind == "array" else []

    def stated(self, comment, header):
        """The number that a comment states, or None."""
        value = rf"({self.NUMBER}|[A-Za-z]\w+)"
        found = re.search(rf"default {value}(?![\w%])(?!,? (?:\d|NaN))",
                          comment) or re.search(rf"(?:^|[ ;]){value} \(default\)", comment) or \
            re.search(rf"; ({self.NUMBER})(?=$|;| \()", comment)
        if not found:
            return None
        word = found[1]
        if re.fullmatch(self.NUMBER, word):
            over, _, under = word.partition("/")
            return float(over) / float(under or 1)
        names = [name for name in header["enumerators"] if name == word or name.endswith("_" + word)]
        return self.WORDS[word] if word in self.WORDS else getattr(_core.lib, names[0]) if len(names) == 1 else None

    def test_defaults_are_those_of_the_comments(self):
        checked, wrong = 0, []
        for header in _core.api["headers"].values():
            for name, function in header["functions"].items():
                if "default" not in name or function["parameters"] or function["returns"] not in header["types"]:
                    continue
                made = getattr(_core.lib, function["symbol"])()
                for field, about in header["types"][function["returns"]]["fields"].items():
                    number, values = self.stated(about["doc"], header), self.flat(getattr(made, field))
                    checked += number is not None and values != []
                    if number is not None and not np.allclose(values, number, 6e-4, 0.0, equal_nan=True):
                        wrong.append(f"{function['returns']}.{field}: {values}, but its comment says {number}")
        self.assertEqual(wrong, [])
        self.assertGreater(checked, 150)


class Values(unittest.TestCase):
    def test_laws(self):
        self.assertEqual(bridge.harmonic_radius(1.0, 2.0), 4.0 / 3.0)
        self.assertAlmostEqual(dem.restitution_of(dem.damping_ratio(0.7, dem.NAIVE), dem.NAIVE), 0.7, 12)

    def test_a_fit_finds_its_own_curve(self):
        t = np.array([0.0, 5.0, 10.0, 20.0, 40.0, 80.0])
        f = 0.7 + 0.3 * np.exp(-0.1 * t)
        result = blocking.fit(blocking.fit_def(), t, f)
        self.assertAlmostEqual(result.k, 0.1, 6)
        self.assertAlmostEqual(result.f_inf, 0.7, 6)

    def test_a_bridge(self):
        pair = bridge.pair_prepare(bridge.pair_def(radius_j=float("inf")))
        made = bridge.form(pair, 2.5e-3, float("inf"), 1e-10, 0.0, 0)
        self.assertGreater(bridge.evaluate(made, bridge.liquid(surface_tension=0.07, viscosity=1e-3, roughness=1e-3),
                                           0.0, 0.0).normal, 1e-3)

    def test_screen_curves_fall(self):
        definition = screen.def_(classes=2, diameters=[5e-3, 7e-3])
        parameters = screen.published(screen.SUBASINGHE)
        curves = screen.predict(definition, screen.SUBASINGHE, parameters,
                                screen.operation(amplitude=1e-3, frequency=50.0), [0.0, 5.0, 10.0]).retained
        self.assertEqual(curves.shape, (2, 3))
        self.assertTrue((np.diff(curves, axis=1) < 0.0).all())

    def test_classifier_and_granulation(self):
        model = classifier.Model(classifier.paper_def(classifier.LIMESTONE, 9000.0).value)
        x50 = model.quantile(0.5)
        self.assertAlmostEqual(model.tromp(x50).value, 0.5, 6)
        sim = granulation.Sim(granulation.def_(seed=3))
        sim.add(granulation.granule(s=0.52e-12, l=0.33e-12, a=0.15e-12), 50)
        sim.run(5)
        self.assertGreater(sim.mean(4, 3), 0.0)


    def test_polyhedra(self):
        brick = dem.make_brick((0.01, 0.02, 0.03), 0.03)
        self.assertAlmostEqual(brick.volume, 6e-6, 15)
        corners = [[0.0, 0.0, 0.0], [0.01, 0.0, 0.0], [0.0, 0.01, 0.0], [0.0, 0.0, 0.01]]
        self.assertAlmostEqual(dem.make_convex(corners, 0.03).volume, 1e-6 / 6.0, 15)
        faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]
        self.assertAlmostEqual(dem.make_convex_mesh(dem.mesh(vertices=4, triangles=4, vertex=corners, triangle=faces),
                                                    0.03).volume, 1e-6 / 6.0, 15)
        with self.assertRaises(riddle.Error) as raised:
            dem.make_convex([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]], 0.03)
        self.assertIn("plane", raised.exception.field)
        world = bed(0)
        world.add_convex(world.add_shape(brick), [[0.0, 0.0, 0.05]], None, 0, 0)
        self.assertAlmostEqual(world.masses().sum(), 2500.0 * 6e-6, 9)
        self.assertTrue((dem.shape_of_drag(0.8, 0.8, 0.8) > 0.0).all())
        self.assertTrue(np.isnan(dem.shape_of_drag(2.0, 0.8, 0.8)).all())
        face, circle = world.body_sphericities(0, (0.0, 0.0, -2.0)), np.pi / 4.0 * (36e-6 / np.pi) ** (2.0 / 3.0)
        np.testing.assert_allclose(face, [circle / 5.5e-4, circle / 2e-4, circle / (11e-4 - 18e-4 / np.pi)], rtol=1e-9)

    def test_compound(self):
        bar, leg = dem.make_brick((0.03, 0.01, 0.01), 0.03), dem.make_brick((0.01, 0.02, 0.01), 0.03)
        world = bed(0)
        ell = world.make_compound([bar, leg], [[0.015, 0.005, 0.005], [0.005, 0.02, 0.005]])
        self.assertAlmostEqual(ell.volume, 5e-6, 15)
        self.assertAlmostEqual(ell.origin.x, (3.0 * 0.015 + 2.0 * 0.005) / 5.0, 15)
        world.add_compounds(ell, [[0.0, 0.0, 0.05], [0.0, 0.0, 0.1]], None, 0, 0)
        self.assertEqual(world.positions().shape, (4, 3))
        self.assertAlmostEqual(world.masses()[3], 2500.0 * 5e-6, 12)
        self.assertEqual(world.get_body(3).first, 2)
        with self.assertRaises(riddle.Error) as raised:
            world.make_compound([bar, bar])
        self.assertIn("centroid", raised.exception.field)
        feed = dem.default_feed()
        feed.region, feed.compound = dem.box_region((0.0, 0.0, 0.2), (0.2, 0.2, 0.4)), ell
        world.fill(feed, 5)
        self.assertEqual((world.count, feed.placed), (14, 5))
        self.assertAlmostEqual(feed.placed_mass, 5 * 2500.0 * 5e-6, 12)

    def test_clump_of_a_mesh(self):
        outline = np.array([[0.0, 0.0], [0.03, 0.0], [0.03, 0.01], [0.01, 0.01], [0.01, 0.03], [0.0, 0.03]])
        corners = np.vstack([np.column_stack([outline, np.full(6, z)]) for z in (0.0, 0.01)])
        lid = [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]]
        faces = [[c, b, a] for a, b, c in lid]
        faces += [[a + 6, b + 6, c + 6] for a, b, c in lid]
        for k in range(6):
            n = (k + 1) % 6
            faces += [[k, n, n + 6], [k, n + 6, k + 6]]
        mesh = dem.mesh(vertices=12, triangles=len(faces), vertex=corners, triangle=faces)
        answer = dem.make_clump_from_mesh(mesh, 40)
        ell, fit = answer.clump, answer.fit
        self.assertAlmostEqual(ell.volume, 5e-6, 15)
        self.assertLessEqual(ell.spheres, 40)
        np.testing.assert_allclose([ell.origin.x, ell.origin.y, ell.origin.z], [0.011, 0.011, 0.005], rtol=1e-9)
        centres = [[c.x, c.y, c.z] for c in ell.centre[: ell.spheres]]
        spheres = dem.make_clump(centres, 2.0 * np.array(ell.radius)[: ell.spheres])
        self.assertAlmostEqual(spheres.volume / ell.volume - 1.0, fit.volume, 8)
        self.assertTrue(-0.4 < fit.volume < 0.0 and 0.0 < fit.moments < 0.5 and 0.0 < fit.centre < 0.1, fit)
        world = bed(0)
        world.add_clumps(ell, [[0.0, 0.0, 0.05]], None, None, 0, 0)
        self.assertAlmostEqual(world.get_body(0).mass, 2500.0 * 5e-6, 9)
        self.assertLess(world.body_sphericities(0, (0.0, 0.0, 1.0))[1], 1.0)
        with self.assertRaises(riddle.Error):  # a face is missing
            mesh = dem.mesh(vertices=12, triangles=len(faces) - 1, vertex=corners, triangle=faces[1:])
            dem.make_clump_from_mesh(mesh, 40)

    def test_vectors_of_granulation_and_classifier(self):
        sim, granule = granulation.Sim(granulation.def_(seed=1)), granulation.granule(s=0.52e-12,
                                                                                      l=0.33e-12, a=0.15e-12)
        sim.put(granule, (1e-4, 0.0, 0.0), (0.0, 0.0, 0.5))
        sim.put(granule, [2e-4, 3e-4, 1e-4], np.array([0.0, 0.1, 0.5]))
        totals = sim.totals()
        self.assertAlmostEqual(totals.volumes.s, 1.04e-12, 20)
        self.assertAlmostEqual(totals.momentum[2] / totals.momentum[1], 10.0, 9)
        self.assertEqual(totals.momentum[0], 0.0)
        self.assertAlmostEqual(totals.kinetic / totals.momentum[2], 0.51 / 2.0, 9)
        sim.impeller([0.0, 0.0, 3.0], [0.1, 0.1, 0.1], True)
        self.assertGreater(abs(sim.totals().momentum[2]), 2.0 * totals.momentum[2])
        with self.assertRaises(ValueError):
            sim.put(granule, (1e-4, 0.0), (0.0, 0.0, 0.5))
        definition = classifier.paper_def(classifier.LIMESTONE, 3000.0).value
        model = classifier.Model(definition)
        cases = model.tromp_cases(model.quantile(0.5))
        self.assertTrue(((cases >= 0.0) & (cases <= 1.0)).all() and cases.shape == (3,)
                        and cases.min() < 0.5 < cases.max(), cases)
        speed = 3000.0 / 60.0 * 2.0 * np.pi
        straight = classifier.approach(definition.wheel, speed, 0.1, 1.0, 1.0)
        heavy = classifier.approach_in_gas(definition, classifier.stokes(), 1.0, 0.1, 1.0, 1.0)
        self.assertTrue(straight.hit and heavy.hit)
        self.assertAlmostEqual(heavy.radius / straight.radius, 1.0, 3)

    def test_vectors_of_filtration(self):
        cloth = filtration.cloth_make(10e-6, 20e-6, filtration.PLAIN_WEAVE, 40e-6)
        above = (15e-6, 15e-6, 60e-6)  # a wire above the crossing
        self.assertAlmostEqual(filtration.cloth_distance(cloth, above), 10e-6, 10)
        self.assertAlmostEqual(filtration.solid_cut(filtration.cloth_solid(cloth), above, (15e-6, 15e-6, 45e-6)),
                               2.0 / 3.0, 6)
        bed_of_one = filtration.Bed([[40e-6, 40e-6, 40e-6]], None, [15e-6], [80e-6] * 3, [1, 1, 1], 20e-6)
        self.assertAlmostEqual(bed_of_one.distance((60e-6, 40e-6, 40e-6)), 5e-6, 12)
        voxels = np.zeros((8, 8, 8), np.uint8)
        voxels[:4] = 1
        image = filtration.image(n=[8, 8, 8], edge=1e-6, solid=voxels, reach=4)
        self.assertGreater(filtration.image_distance(image, (4.5e-6, 4.5e-6, 6e-6)), 0.5e-6)
        self.assertLess(filtration.image_distance(image, (4.5e-6, 4.5e-6, 2e-6)), -0.5e-6)
        for use in (lambda image: filtration.image_distance(image, (0, 0, 0)), filtration.image_solid):
            with self.assertRaises(riddle.Error):  # C would divide by 0
                use(filtration.image(n=[0, 0, 0], edge=1e-6, reach=4))
        definition = filtration.fluid_def(nodes=[16, 16, 16], voxel=5e-6, solid=bed_of_one.solid())
        fluid = filtration.Fluid(definition)
        fluid.set_body_force([0.0, 0.0, 1e3])
        fluid.run(400)
        velocity, force = fluid.mean_velocity(), fluid.solid_force()
        self.assertGreater(velocity[2], 1e-7)
        self.assertLess(np.abs(velocity[:2]).max(), 1e-6 * velocity[2])
        self.assertTrue(0.6 < force[2] / (1e3 * (80e-6) ** 3) < fluid.porosity())  # the rest still accelerates it
        sheared = filtration.Fluid(filtration.fluid_def(nodes=[8, 8, 8],
                                                        face=[0, 0, 0, 0, filtration.WALL, filtration.WALL]))
        sheared.set_face_velocity(filtration.HIGH_Z, [1e-3, 0.0, 0.0])
        sheared.run(400)
        self.assertAlmostEqual(sheared.mean_velocity()[0], 0.5e-3, 5)


class Worlds(unittest.TestCase):
    def test_runs_have_the_bits_of_one_call(self):
        in_pieces, whole = bed(), bed()
        in_pieces.run(0.05, LAW)
        whole._check(_core.lib.dem_run(whole._alive, 0.05, LAW))
        self.assertEqual(in_pieces.step, whole.step)
        self.assertEqual(in_pieces.hash(), whole.hash())

    def test_states_into_an_array_of_ones_own(self):
        world = bed()
        out = np.empty((world.count, 3))
        self.assertIs(world.positions(out), out)
        np.testing.assert_array_equal(out[3], list(world.position(3)))
        with self.assertRaises(ValueError):
            world.positions(np.empty((2, 3)))
        with self.assertRaises(ValueError):
            world.velocities(np.empty((world.count, 3), dtype=np.float32))

    def test_only_arrays_that_c_may_change(self):
        def spheres(**other):
            given = {name: np.zeros((1, 3)) for name in ("velocity", "spin", "force", "torque")}
            return filtration.spheres(**{"centre": np.full((1, 3), 64e-6), "radius": [30e-6], **given, **other})

        definition = filtration.fluid_default_def()
        definition.voxel, definition.nodes = 8e-6, [16, 16, 16]
        fluid, fixed = filtration.Fluid(definition), np.zeros((1, 3))
        fixed.flags.writeable = False
        for name in ("centre", "velocity", "spin", "force", "torque"):
            for wrong in (fixed, np.zeros((1, 3), np.float32), np.zeros((1, 6))[:, ::2], [[0.0, 0.0, 0.0]]):
                with self.assertRaisesRegex(TypeError, f"spheres.{name}: a writable contiguous numpy array of float64"):
                    spheres(**{name: wrong})
        force, velocity, radius = np.zeros((1, 3)), np.array([[1e-3, 0.0, 0.0]]), np.array([30e-6], np.float32)
        radius.flags.writeable = False
        taken = spheres(force=force, velocity=velocity, radius=radius)
        fluid.step(taken)
        self.assertLess(force[0, 0], 0.0)
        before = force.copy()
        force.flags.writeable = False  # after it was given
        with self.assertRaisesRegex(TypeError, "spheres.force: a writable"):
            fluid.step(taken)
        np.testing.assert_array_equal(force, before)

    def test_films_give_liquid(self):
        films = {"quantum": bridge.quantum(1e-9), "n_particles": 2, "n_patches": 0, "scratch": np.zeros(2)}
        for wrong in ([1e-12, 1e-12], np.full(2, 1e-12, np.float32)):
            with self.assertRaisesRegex(TypeError, "films.particle: a writable contiguous numpy array of float64"):
                bridge.films(particle=wrong, **films)
        liquid = np.full(2, 1e-12)
        new = bridge.contact(i=0, j=1, partner=bridge.SPHERE, radius_i=1e-3, radius_j=1e-3, volume_min=1e-15,
                             volume_max=1e-11)
        bridge.allocate(bridge.films(particle=liquid, **films), [new])
        self.assertGreater(new.given_i, 0.0)
        self.assertEqual(liquid[0], 1e-12 - new.given_i)

    def test_views_go_stale(self):
        world = bed()
        ids = world.ids()
        self.assertEqual(ids[5], 5)
        world.run(1e-4, LAW)
        for use in (lambda: ids[0], lambda: np.array(ids), lambda: len(ids)):
            with self.assertRaises(RuntimeError):
                use()
        fresh = world.ids()
        with self.assertRaises((ValueError, TypeError)):
            fresh[0] = 7

    def test_views_serve_as_arrays(self):
        world = bed(20)
        world.remove_region(dem.box_region((0, 0, 0), (0.025, 0.05, 0.1)))
        present = world.present()
        self.assertEqual(present.dtype, np.bool_)
        here_now = present.sum()
        self.assertTrue(0 < here_now < 20)
        np.testing.assert_array_equal(world.positions()[present], world.positions()[np.flatnonzero(present)])
        self.assertEqual(world.positions()[present & (world.groups() == 0)].shape, (here_now, 3))
        self.assertEqual(world.positions()[(world.positions()[:, 0] > -1.0) & present].shape, (here_now, 3))
        self.assertEqual((~present).sum(), 20 - here_now)
        self.assertEqual(len(world.ids()[present]), here_now)
        self.assertEqual(np.bincount(world.groups()[present])[0], here_now)
        self.assertEqual((world.ids() > 4).sum(), 15)
        self.assertEqual((world.ids() + world.ids()).max(), 38)
        ids = world.ids()
        for change in (lambda: ids.sort(), lambda: ids.__iadd__(1), lambda: np.add(ids, 1, out=ids),
                       lambda: ids.fill(0)):
            with self.assertRaises((ValueError, TypeError)):
                change()
        world.run(1e-4, LAW)
        for use in (lambda: present.sum(), lambda: present & present, lambda: world.positions()[present],
                    lambda: ids > 3, lambda: ids.dtype):
            with self.assertRaises((RuntimeError, IndexError)):
                use()

    def test_errors_travel(self):
        world = without_a_pair()
        world.add_spheres([[0, 0, 0.004]], 0.01, 0)
        with self.assertRaises(riddle.Error) as caught:
            world.run(0.1, dem.LINEAR)
        error = caught.exception
        for twin in (pickle.loads(pickle.dumps(error)), copy.copy(error), copy.deepcopy(error)):
            self.assertEqual((str(twin), twin.status, twin.name, twin.text, twin.field, twin.materials, twin.particle),
                             (str(error), error.status, "DEM_PAIR_NOT_SET", error.text, error.field, (0, 1), 0))
        with self.assertRaises(riddle.Error) as caught:
            dem.World(dem.def_(dt=-1.0))
        self.assertEqual((caught.exception.materials, caught.exception.particle), (None, None))

    def test_copies(self):
        class Named(dem.World):
            def __init__(self, definition, name):
                super().__init__(definition)
                self.name = name

        globals()["Named"] = Named
        Named.__qualname__ = "Named"
        definition = dem.def_(dt=1e-5)
        dem.add_material(definition, 2500.0, 5e10, 0.2)
        world = Named(definition, ["mine"])
        world.add_spheres([[0, 0, 1]], 1e-3, 0)
        for twin in (copy.copy(world), copy.deepcopy(world), pickle.loads(pickle.dumps(world))):
            self.assertIs(type(twin), Named)
            self.assertEqual((twin.name, twin.hash()), (["mine"], world.hash()))
            twin.run(1e-3, LAW)
        self.assertEqual(world.step, 0)
        sim = granulation.Sim(granulation.def_(seed=1))
        for use in (copy.copy, copy.deepcopy, pickle.dumps):
            with self.assertRaisesRegex(TypeError, "cannot be copied"):
                use(sim)

    def test_what_has_no_definition(self):
        for wrong in ((), (None,), (5,), (granulation.def_(),)):
            with self.assertRaisesRegex(TypeError, "a dem.def_ is needed"):
                dem.World(*wrong)
        with self.assertRaisesRegex(ValueError, "freed"):
            dem.World.__new__(dem.World).run(0.1, LAW)
        with self.assertRaisesRegex(TypeError, "granulation.Sim"):
            _core.Handle.__init__(granulation.Sim.__new__(granulation.Sim, granulation.def_()))
        for wrong in ((), (None,), (5,), (dem.def_(),)):
            with self.assertRaises(TypeError):
                classifier.Model(*wrong)

    def test_materials(self):
        definition = dem.def_()
        self.assertEqual([dem.add_material(definition, 2500.0, 5e10, 0.2) for _ in range(8)], list(range(8)))
        with self.assertRaises(riddle.Error) as caught:
            dem.add_material(definition, 2500.0, 5e10, 0.2)
        self.assertEqual(caught.exception.name, "DEM_TOO_MANY")
        definition = dem.def_()
        dem.add_material(definition, 2500.0, 5e10, 0.2)
        for wrong in ((0, 5), (-1, 0), (0, 1), (1, 0)):
            with self.assertRaises(IndexError):
                dem.pair(definition, *wrong)
        with self.assertRaises(TypeError):
            dem.pair(definition, "0", 0)

    def test_a_fill_that_places_nothing(self):
        world, feed = bed(0), dem.default_feed()
        feed.sizes = dem.one_size(0.5)
        with self.assertWarnsRegex(UserWarning, "none of 5"):
            world.fill(feed, 5)
        feed.sizes = dem.one_size(5e-3)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            world.fill(feed, 5)
        self.assertGreater(world.count, 0)

    def test_pickles_go_on_with_the_same_bits(self):
        world = bed()
        world.run(0.02, LAW)
        twin = pickle.loads(pickle.dumps(world))
        for w in (world, twin):
            w.run(0.02, LAW)
        self.assertEqual(world.hash(), twin.hash())
        with self.assertRaises(riddle.Error):
            dem.World.load(b"no world at all")

    def test_errors_name_the_field(self):
        with self.assertRaises(riddle.Error) as raised:
            dem.World(dem.def_(dt=-1.0))
        self.assertEqual(raised.exception.name, "DEM_BAD_DEFINITION")
        with self.assertRaises(riddle.Error) as raised:
            bridge.pair_check_def(bridge.pair_def(radius_i=-1.0))
        self.assertEqual(raised.exception.field, "radius_i")
        with self.assertRaises(AttributeError):
            dem.def_(gravty=(0, 0, 0))
        with self.assertRaises(riddle.Error):
            bed().add_cylinder(0, (0, 0, 0), (0, 0, 0), 1.0, 1)

    def test_a_pair_that_was_not_set(self):
        world = without_a_pair()
        world.add_spheres([[0, 0, 0.01]], [0.01], 0, 0)
        with self.assertRaises(riddle.Error) as caught:
            world.run(0.1, dem.LINEAR)
        self.assertEqual(caught.exception.materials, (0, 1))
        self.assertIn("materials 0 and 1", str(caught.exception))

    def test_lengths_are_checked(self):
        with self.assertRaises(ValueError):
            blocking.fit(blocking.fit_def(), [0.0, 1.0, 2.0], [1.0, 0.9])
        definition = screen.def_(classes=5, diameters=[5e-3, 7e-3])
        with self.assertRaises(ValueError):
            screen.predict(definition, screen.DONG, screen.published(screen.DONG),
                           screen.operation(amplitude=1e-3, frequency=50.0), [0.0, 1.0])
        with self.assertRaises(ValueError):
            bed().add_spheres([[0, 0, 1], [0, 0, 2]], [1e-3, 1e-3, 1e-3], 0)

    def test_integers_are_not_cut(self):
        definition = dem.def_()
        for wrong in ([-1, 0, 2**40], [0.5, 0, 0], [float("nan"), 0, 0], "xyz", [0, 0, 10**30]):
            with self.assertRaises((ValueError, TypeError)):
                definition.periodic = wrong
        definition.periodic = [True, False, 1.0]
        self.assertEqual(list(definition.periodic), [1, 0, 1])

    def test_shapes_are_those_of_the_comments(self):
        world, centres = bed(0), np.arange(18.0).reshape(6, 3)
        for wrong in (centres.T, centres.ravel(), centres[:, :2], centres[None], [0.0, 0.0], 5.0, [[0, 0, 1], [0, 0]]):
            with self.assertRaises((ValueError, TypeError)):
                world.add_spheres(wrong, 1e-3, 0)
        for wrong in ([1e-3], np.full((6, 1), 1e-3), np.full(5, 1e-3)):
            with self.assertRaises(ValueError):
                world.add_spheres(centres, wrong, 0)
        self.assertEqual(world.count, 0)
        world.add_spheres((0, 0, 1), 1e-3, 0)
        world.add_spheres([], [], 0)
        world.add_spheres(np.asfortranarray(centres), np.full(6, 1e-3), 0)
        np.testing.assert_array_equal(world.positions()[1:], centres)
        mesh = dem.mesh(vertices=4, triangles=1,
                        vertex=np.array([[0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]]),
                        triangle=[[0, 1, 2]])
        with self.assertRaises(ValueError):
            world.add_mesh(0, mesh)
        mesh.vertex = mesh.vertex.T
        world.add_mesh(0, mesh)
        definition, time = screen.def_(classes=2, diameters=[3e-3, 5e-3], shares=[0.5, 0.5]), [1.0, 2.0, 4.0, 8.0, 16.0]
        curves = screen.predict(definition, screen.DONG, screen.published(screen.DONG),
                                screen.operation(amplitude=1e-3, frequency=45.0), time).retained

        def fit(retained):
            cases = [screen.case(operation=screen.operation(amplitude=a, frequency=45.0), times=5, time=time,
                                 retained=retained) for a in (1e-3, 2e-3, 3e-3)]
            screen.check_cases(definition, cases, 0.0, screen.where())
        for right in (curves, curves.ravel(), np.asfortranarray(curves)):
            fit(right)
        for wrong in (curves.T, curves[None], curves[:, :4], curves.ravel()[:9]):
            with self.assertRaises(ValueError):
                fit(wrong)
        with self.assertRaises(TypeError):
            screen.fit_options(decks=definition)
        periodic = dem.def_()
        for wrong in ([1, 0], [[1, 0, 0]], [1]):
            with self.assertRaises(ValueError):
                periodic.periodic = wrong
        periodic.periodic = True
        self.assertEqual(list(periodic.periodic), [1, 1, 1])

    def test_vectors_have_as_many_numbers_as_fields(self):
        definition, world = dem.def_(), bed(0)
        for wrong in ((0, -9.81), (0, 0, 0, 0), "123", b"123", ("0", "0", "1"), {1, 2, 3}, {0: 1, 1: 2, 2: 3}, 5.0,
                      None, [[0, 0, 1]], np.zeros((3, 1)), (0, None, 1),
                      np.ma.masked_array([0, 0, 1.0], mask=[0, 0, 1]), np.array([0, 0, 1], "m8[ns]"), (0, 0, 1j)):
            with self.assertRaises(TypeError):
                definition.gravity = wrong
            with self.assertRaises(TypeError):
                world.add_plane(0, (0, 0, 0), wrong)
        definition.gravity = np.array([0, 1, -2], np.float32)
        self.assertEqual(list(definition.gravity), [0.0, 1.0, -2.0])
        with self.assertRaisesRegex(TypeError, "a dem_sizes is needed"):
            dem.default_feed().sizes = 5e-3
        clump = dem.make_clump([[0, 0, 0], [0.005, 0, 0]], [0.01, 0.01])
        clump.centre = [(0, 0, 1), dem.vec(x=2.0)]
        self.assertEqual([list(v) for v in clump.centre[:2]], [[0, 0, 1], [2, 0, 0]])
        for wrong in ([dem.vec()] * 99, [(0, 0)], [dem.cells()], 5, "abc", [dem.vec(), "abc"]):
            with self.assertRaises(TypeError):
                clump.centre = wrong
        self.assertEqual(list(clump.centre[0]), [0, 0, 1])

    def test_numbers_of_fields(self):
        definition = dem.def_()
        for wrong in (np.float32(2.7), np.array([2.7]), np.array([2]), 2.5, "2", None, float("nan"), float("inf"),
                      1 << 40, 2j, np.timedelta64(2, "ns"), np.ma.masked):
            with self.assertRaises(TypeError):
                definition.threads = wrong
            with self.assertRaises((TypeError, OverflowError)):
                bed(0).add_cylinder(wrong, (0, 0, 0), (0, 0, 1), 1.0, 1)
        for right in (2, 2.0, np.int64(2), np.float32(2), np.array(2)):
            definition.threads = right
            self.assertEqual(definition.threads, 2)
        for wrong in ("0.3", None, np.array([0.3]), np.timedelta64(1, "s"), 1j):
            with self.assertRaises(TypeError):
                definition.dt = wrong

    def test_masked_entries_and_times(self):
        t, f, definition = np.array([0.0, 5.0, 10.0, 30.0,
                                     60.0]), np.array([1.0, 0.9, 0.85, 0.76, 0.75]), blocking.fit_def()
        known = blocking.fit(definition, t, f).k
        with self.assertRaisesRegex(ValueError, "masked"):
            blocking.fit(definition, t, np.ma.masked_array(f, mask=t == 10))
        self.assertEqual(blocking.fit(definition, t, np.ma.masked_array(f, mask=False)).k, known)
        for wrong in (t.astype("m8[s]"), t.astype("M8[s]"), list(t.astype("m8[s]")), [str(v) for v in t],
                      t.astype(complex), np.array([str(v) for v in t], object)):
            with self.assertRaises(TypeError):
                blocking.fit(definition, wrong, f)
        self.assertEqual(blocking.fit(definition, (1000 * t).astype("m8[ms]") / np.timedelta64(1, "s"), f).k, known)
        for right in (np.repeat(t, 2)[::2], t.astype(">f8"), memoryview(t), t.astype(object)):
            self.assertEqual(blocking.fit(definition, right, f).k, known)

    def test_ctrl_c_stops_between_steps(self):
        world = bed(200)
        threading.Timer(0.5, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
        with self.assertRaises(KeyboardInterrupt):
            world.run(1e4, LAW)
        self.assertGreater(world.step, 0)
        world.run(1e-3, LAW)
        self.assertTrue(np.isfinite(world.positions()).all())

    def test_ctrl_c_stops_a_fill(self):
        world, feed = bed(50), dem.default_feed()
        feed.region = dem.box_region((0, 0, 0.1), (0.02, 0.02, 0.12))
        feed.sizes, feed.tries = dem.lognormal_sizes(3e-3, 0.2, 1e-3, 6e-3, 0), 1000000
        before = world.hash()
        threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
        with self.assertRaises(KeyboardInterrupt):
            world.fill(feed, 20000)
        self.assertEqual((world.hash(), feed.placed, feed.missed), (before, 0, 0))
        world.run(1e-3, LAW)
        self.assertIs(signal.getsignal(signal.SIGINT), signal.default_int_handler)

    def test_what_does_not_fit_into_memory(self):
        world, feed = bed(3), dem.default_feed()
        for count in (10**9, 1e9, 2 * 10**8):
            with self.assertRaisesRegex((MemoryError, riddle.Error), "GB|too many|counts"):
                world.fill(feed, count)
        for given in ((np.int64(10**9),), (np.float32(1e9),), (np.array(10**9),)):
            with self.assertRaises(MemoryError):
                world.fill(feed, *given)
        with self.assertRaises(MemoryError):
            world.fill(feed, count=10**9)
        with self.assertRaises(MemoryError):
            world.fill(count=10**9, feed=feed)
        with self.assertRaises(TypeError):
            world.fill(feed, 10, count=10)
        feed.sizes = dem.lognormal_sizes(1e-6, 0.5, 1e-7, 1e-5, 1)
        with self.assertRaisesRegex(MemoryError, "fill_mass: .* GB are free"):
            world.fill_mass(feed, 1e-2)
        for wrong in (float("nan"), float("inf"), -1, 0.5, None, "3", 10**30):
            with self.assertRaises((TypeError, ValueError, OverflowError, riddle.Error, MemoryError)):
                world.fill(feed, wrong)
        for wrong in (float("nan"), float("inf"), -1.0, None, "3"):
            with self.assertRaises((TypeError, ValueError, riddle.Error, MemoryError)):
                world.fill_mass(feed, wrong)
        self.assertEqual(world.count, 3)

    def test_a_function_of_the_definition_lives_as_long_as_the_world(self):
        definition, asked = dem.def_(), []
        dem.add_material(definition, 2500.0, 5e10, 0.2)
        definition.stop = lambda _: len(asked) > 2 or asked.append(1) or 0
        world, feed = dem.World(definition), dem.default_feed()
        del definition
        with self.assertRaisesRegex(riddle.Error, "DEM_STOPPED"):
            world.fill(feed, 20000)
        self.assertEqual((world.count, len(asked)), (0, 3))

    def test_a_wall_from_python(self):
        world = bed(10)
        world.prescribe(0, (0, 0, 0), lambda now: ((0.0, 0.0, 1e-3 * np.sin(100 * now)), (0.0, 0.0, 0.0)))
        world.run(0.01, LAW)
        self.assertTrue(np.isfinite(world.positions()).all())

    def test_a_law_from_c(self):
        with tempfile.TemporaryDirectory() as folder:
            library = os.path.join(folder, "magnets.so")
            subprocess.run([os.environ.get("CC", "cc"), "-O0", "-ffp-contract=off", "-fPIC", "-shared", "-I", root,
                            os.path.join(here, "laws", "magnets.c"),
                            "-lm", "-o", library], check=True)
            world, law = bed(20), dem.Law(library)
            world.run_law(0.05, law)
            self.assertGreater(world.step, 4000)
            for use in (lambda: law.set("pull", 1.0), lambda: law.get("pull"),
                        lambda: dem.Law(os.path.join(here, "laws", "magnets.c")),
                        lambda: dem.Law(_core.__file__ + "x")):
                with self.assertRaises((ValueError, ImportError)):
                    use()


class ContactLaws(unittest.TestCase):
    """dem.ContactLaw: each against a number that is known."""

    RADIUS = 5e-4

    def ball(self, name, dt, gravity=(0.0, 0.0, -9.81), overlap=0.0):
        """A ball on a plane."""
        definition = dem.def_(dt=dt, gravity=gravity)
        stuff = dem.add_material(definition, 2500.0, 1e8, 0.25)
        contact = dem.pair(definition, stuff, stuff)
        contact.restitution, contact.friction, contact.stiffness = 0.5, 0.5, 1e4
        world, law = dem.World(definition), dem.ContactLaw(name)
        world.add_plane(stuff, (0, 0, 0), (0, 0, 1))
        world.add_spheres((0, 0, self.RADIUS - overlap), 2.0 * self.RADIUS, stuff)
        return world, law

    def pull_off(self, world, law, expected):
        """The greatest pull that the ball stands, over the expected, as its weight grows away from the plane."""
        held = 0.0
        for pull in [*np.linspace(0.0, 0.97, 300, endpoint=False), *np.linspace(0.97, 1.03, 61)]:
            world.set_gravity((0, 0, pull * expected / world.masses()[0]))
            world.run_law(3e-3 if pull > 0.96 else 3e-4, law)
            if world.positions()[0, 2] > 1.01 * self.RADIUS:
                return held
            held = pull
        self.fail("the ball does not leave")

    def test_pull_off(self):
        for name, factor in (("jkr", 1.5), ("dmt", 2.0)):
            world, law = self.ball(name, 2e-6, overlap=1e-7)
            law.pair(0, 0).surface_energy = 0.1
            world.run_law(0.02, law)
            self.assertAlmostEqual(self.pull_off(world, law, factor * np.pi * 0.1 * self.RADIUS), 1.0,
                                   delta=0.005, msg=name)

    def test_a_bond_breaks(self):
        world, law = self.ball("bonds", 1e-6, overlap=1e-7)
        pair = law.pair(0, 0)
        pair.bond_modulus, pair.tensile, pair.shear = 1e7, 400.0, 400.0
        world.run_law(0.01, law)
        self.assertEqual(law.bonds(world), 0)
        law.bond(world)
        self.assertEqual(law.bonds(world), 1)
        copied = copy.copy(world)
        self.assertAlmostEqual(self.pull_off(world, law, 400.0 * np.pi * self.RADIUS**2), 1.0, delta=0.005)
        self.assertEqual(law.bonds(world), 0)
        copied.run_law(0.01, law)
        self.assertEqual(law.bonds(copied), 1)

    def test_a_ball_rests_on_a_slope(self):
        slope = np.arctan(0.19)
        gravity = 9.81 * np.array([np.sin(slope), 0.0, -np.cos(slope)])
        for name in ("epsd", "epsd_hertz"):
            for rolling in (0.2, 0.15):
                world, law = self.ball(name, 2e-6, gravity)
                law.pair(0, 0).rolling = rolling
                world.run_law(0.1, law)
                before = world.positions()[0, 0]
                world.run_law(0.1, law)
                moved = world.positions()[0, 0] - before
                self.assertAlmostEqual(moved, 0.0 if rolling > 0.19
                                       else 1.5e-2 * 5 / 7 * 9.81 * (np.sin(slope) - rolling * np.cos(slope)),
                                       delta=1e-11 if rolling > 0.19 else 4e-5)

    def test_refused(self):
        law = dem.ContactLaw("epsd")
        pair = law.pair(1, 0)
        for name, value in (("rolling", -1.0), ("rolling", np.nan), ("tensile", 0.0), ("bond_radius", 0.0)):
            before = getattr(pair, name)
            with self.assertRaises(ValueError):
                setattr(pair, name, value)
            self.assertEqual(getattr(pair, name), before)
        pair.rolling = 0.1
        self.assertEqual(law.pair(0, 1).rolling, 0.1)
        world = bed(3)
        for use, error in ((lambda: dem.ContactLaw("jkrs"), ValueError), (lambda: law.pair(0, 99), IndexError),
                           (lambda: law.pair(-1, 0), IndexError),
                           (lambda: pair.rollings, AttributeError),
                           (lambda: setattr(pair, "rollings", 1), AttributeError),
                           (lambda: law.bond(world), ValueError),
                           (lambda: law(None, 1.0), TypeError), (lambda: setattr(pair, "rolling", "x"), TypeError)):
            with self.assertRaises(error):
                use()

    def test_all_fields(self):
        with open(os.path.join(root, "dem_laws.h"), encoding="utf-8") as file:
            fields = re.search(r"typedef struct contact_pair_def \{(.*?)\} contact_pair_def;", file.read(), re.S)[1]
        fields = re.sub(r"/\*.*?\*/", "", fields, flags=re.S)
        self.assertEqual(tuple(re.findall(r"\w+", fields.replace("double", ""))), dem.ContactPair._FIELDS)


class Wet(unittest.TestCase):
    """python/laws/wet.c."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.library = pathlib.Path(cls.folder.name) / "wet.so"
        subprocess.run([os.environ.get("CC", "cc"), "-O0", "-ffp-contract=off", "-fPIC", "-shared", "-I", root,
                        os.path.join(here, "laws", "wet.c"), "-lm", "-o", cls.library], check=True)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def scene(self, law, moisture):
        definition = dem.def_(dt=2e-5)
        glass, steel = dem.add_material(definition, 2534.1, 5e10, 0.2), dem.add_material(definition, 7850.0, 2e11, 0.3)
        for other in (glass, steel):
            contact = dem.pair(definition, glass, other)
            contact.stiffness, contact.restitution, contact.friction = 5e3, 0.7, 0.3
        world, feed = dem.World(definition), dem.default_feed()
        deck = world.add_screen(steel,
                                dem.screen(aperture=8e-3, wire=2e-3, half_x=0.02, half_y=0.02, circular=1,
                                           normal=(0, 0, 1), direction=(1, 0, 0)))
        world.add_cylinder(steel, (0, 0, 0), (0, 0, 1), 0.02, 1)
        feed.region = dem.cylinder_region((0, 0, 0.006), (0, 0, 1), 0.02, 0.018)
        for group, (diameter, number) in enumerate([(5e-3, 20), (7e-3, 6), (10e-3, 4)]):
            feed.sizes, feed.group = dem.one_size(diameter), group
            world.fill(feed, number)
        law.set("moisture", moisture)
        law.set("deck", deck)
        return world

    def test_worlds_have_their_own_books(self):
        law, alone = dem.Law(self.library), []
        for moisture in (0.0, 0.05, 0.02):
            world = self.scene(law, moisture)
            world.run_law(0.04, law)
            world.run_law(0.04, law)
            alone.append((world.hash(), law.get("bridges"), law.get("liquid")))
            world.free()
            self.assertEqual(law.get("bridges"), alone[-1][1])
        self.assertEqual(alone[0][1:], (0.0, 0.0))
        self.assertGreater(alone[1][1], 5)
        self.assertAlmostEqual(alone[1][2] / alone[2][2], 2.5, 6)
        worlds = []
        for moisture in (0.0, 0.05, 0.02):
            worlds.append(self.scene(law, moisture))
            worlds[-1].run_law(0.04, law)
        for world, (bits, bridges, liquid) in zip(worlds, alone):
            world.run_law(0.04, law)
            self.assertEqual((world.hash(), law.get("bridges"), law.get("liquid")), (bits, bridges, liquid))
        feed = dem.default_feed()
        feed.region, feed.sizes = dem.cylinder_region((0, 0, 0.1), (0, 0, 1), 0.05, 0.015), dem.one_size(5e-3)
        worlds[0].fill(feed, 2)
        with self.assertRaises(riddle.Error):  # they have no films
            worlds[0].run_law(0.01, law)
        with self.assertRaises(riddle.Error):  # its films are not saved
            pickle.loads(pickle.dumps(worlds[1])).run_law(0.01, law)
        law.set("deck", 7)
        with self.assertRaises(riddle.Error):
            bed(3).run_law(0.01, law)

    def test_names_and_numbers(self):
        law, here_now = dem.Law(self.library), os.getcwd()
        for name, value in (("moistur", 0.05), ("moisture", -0.05), ("moisture", 1.5), ("moisture", float("nan")),
                            ("deck", -1), ("deck", 0.5), ("deck", 32)):
            with self.assertRaises(ValueError):
                law.set(name, value)
        for value in ("2 %", None, [0.1], np.timedelta64(1, "ns")):
            with self.assertRaises(TypeError):
                law.set("moisture", value)
        for name in ("moistur", "", "m\u00f6isture"):
            with self.assertRaises(ValueError):
                law.get(name)
        law.set("moisture", 0.03)
        self.assertEqual(law.get("moisture"), 0.03)
        os.chdir(self.folder.name)
        try:
            self.assertEqual(dem.Law("wet.so").get("moisture"), 0.03)
        finally:
            os.chdir(here_now)


class Kept(unittest.TestCase):
    """What C points to lives as long as what points to it."""

    def fresh(self):
        """Memory that was freed is used again."""
        gc.collect()
        return [dem.mesh(vertices=1, triangles=1)
                for _ in range(300)], [np.random.rand(24)
                                       for _ in range(300)], [filtration.cloth(wire=1.0, opening=1.0)
                                                              for _ in range(300)]

    def test_solids_and_regions(self):
        definition = filtration.fluid_def(nodes=[24, 24, 32],
                                          solid=filtration.cloth_solid(filtration.cloth_make(10e-6, 20e-6, 0,
                                                                                             16 * 2.5e-6)))
        taken = self.fresh()
        self.assertAlmostEqual(filtration.Fluid(definition).porosity(), 0.9288194444, 9)
        corners = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], float) * 0.05
        faces = [(0, 2, 1), (1, 2, 3), (4, 5, 6), (5, 7, 6), (0, 1, 4), (1, 5, 4), (2, 6, 3), (3, 6, 7), (0, 4, 2),
                 (2, 4, 6), (1, 3, 5), (3, 7, 5)]
        world, feed, mesh = bed(0), dem.default_feed(), dem.mesh(vertices=8, triangles=12, vertex=corners,
                                                                 triangle=faces)
        feed.sizes = dem.one_size(4e-3)
        feed.region = dem.mesh_region(mesh)
        other = dem.default_feed()
        other.region, other.sizes = copy.copy(feed).region, feed.sizes
        mesh.vertices = 10**6
        with self.assertRaises(ValueError):
            world.fill(feed, 5)
        mesh.vertices = 8
        del mesh, feed
        taken += self.fresh()
        world.fill(other, 50)
        self.assertEqual(world.count, 50)
        self.assertTrue((world.positions() < 0.05).all())
        del taken

    def test_functions_of_parts(self):
        definition = filtration.fluid_def(nodes=[16, 16, 16], voxel=1e-5)
        definition.solid.distance = lambda _, point: point[2] - 40e-6
        taken = self.fresh()
        self.assertAlmostEqual(filtration.Fluid(definition).porosity(), 0.75, 1)
        del taken

    def test_arrays_of_fields(self):
        periodic, pair = dem.def_(periodic=[1, 0, 1]).periodic, dem.def_().pair[1][2]
        taken = [dem.def_() for _ in range(50)], self.fresh()
        self.assertEqual(list(periodic), [1, 0, 1])
        self.assertEqual(pair.restitution, 0.8)
        self.assertLess(len(repr(dem.def_())), 3000)
        del taken

    def test_a_definition_that_changes(self):
        definition, granule, counts, sims = granulation.def_(seed=1), granulation.granule(s=0.52e-12, l=0.33e-12,
                                                                                          a=0.15e-12), [], []
        for _ in range(2):
            count = [0]
            counts.append(count)
            definition.on_collision = lambda user, event, count=count: count.__setitem__(0, count[0] + 1)
            sims.append(granulation.Sim(definition))
            sims[-1].add(granule, 100)
        definition.on_collision = None
        taken = self.fresh()
        for sim in sims:
            sim.run(4)
        self.assertEqual(counts[0], counts[1])
        self.assertGreater(counts[0][0], 0)
        balance = granulation.balance_def(selection=lambda g, user: counts[0].append(1) or 0.1,
                                          kernel=granulation.collision_kernel,
                                          kernel_user=granulation.kernel_data(laws=granulation.def_().laws,
                                                                              speed=0.3, rate=1e-9))
        state = granulation.Balance(balance, np.geomspace(1e-13, 1e-11, 11), None)
        state.add(granule, 100.0)
        balance.selection = balance.kernel = balance.kernel_user = None
        taken += self.fresh()
        state.run(1e-3)
        self.assertGreater(len(counts[0]), 1)
        parts = dem.def_(parallel=lambda user, tasks, task, context: [task(context, k) for k in range(tasks)] and None,
                         threads=2, dt=1e-5)
        dem.add_material(parts, 2500.0, 5e10, 0.2)
        world = dem.World(parts)
        parts.parallel = None
        taken += self.fresh()
        world.add_spheres(np.mgrid[0:10, 0:10, 0:10].reshape(3, -1).T * 5e-3, 6e-3, 0)
        world.run(1e-4, LAW)
        self.assertTrue(np.isfinite(world.positions()).all())
        del taken


class Mistake(Exception):
    pass


class Functions(unittest.TestCase):
    """An exception in a function that C calls is raised by the call, which ends early."""

    def failing(self, answer, at):
        """A function that fails in its call of this number."""
        calls = []

        def function(*arguments):
            calls.append(arguments)
            if len(calls) >= at:
                raise Mistake(len(calls))
            return answer
        return function, calls

    def raises(self, use):
        with contextlib.redirect_stderr(io.StringIO()) as printed:
            with self.assertRaises(Mistake) as raised:
                use()
        self.assertEqual(printed.getvalue(), "")
        return raised.exception.args[0]

    def test_a_motion(self):
        world = bed(5)
        motion, calls = self.failing(((0, 0, 0), (0, 0, 0)), 40)
        world.prescribe(0, (0, 0, 0), motion)
        self.assertEqual(self.raises(lambda: world.run(1.0, LAW)), len(calls))
        self.assertLess(world.step, 40)
        self.assertEqual(world.positions().shape, (5, 3))
        for wrong in ((0, 0, 0), None, ((0, 0, 1),), ((0, 0), (0, 0, 0)), ((0, 0, float("nan")), (0, 0, 0)),
                      ((0, 0, "x"), (0, 0, 0)), ("123", "001"), 5.0, np.zeros((3, 2))):
            world = bed(2)
            with self.assertRaises(ValueError):
                world.prescribe(0, (0, 0, 0), lambda now: wrong)
            world.prescribe(0, (0, 0, 0), lambda now: wrong if now > 5e-5 else np.zeros((2, 3)))
            with self.assertRaisesRegex(ValueError, "motion must return"):
                world.run(1e-2, LAW)
        world = bed(2)
        world.prescribe(0, (0, 0, 0), lambda now: ((0, 0, 0), (0, 0, 0)))
        with self.assertRaises(riddle.Error):
            world.prescribe(7, (0, 0, 0), lambda now: ((0, 0, 0), (0, 0, 0)))
        with self.assertRaises(TypeError):
            world.prescribe(0, (0, 0), lambda now: ((0, 0, 0), (0, 0, 0)))
        gc.collect()
        world.run(1e-3, LAW)
        world.prescribe(0, (0, 0, 0), lambda now: world.free() if now > 2e-3 else ((0, 0, 0), (0, 0, 0)))
        with self.assertRaisesRegex(RuntimeError, "while it runs"):
            world.run(1e-2, LAW)

    def test_collisions(self):
        definition, granule = granulation.def_(seed=1), granulation.granule(s=0.52e-12, l=0.33e-12, a=0.15e-12)
        definition.on_collision, calls = self.failing(None, 3)
        sim = granulation.Sim(definition)
        sim.add(granule, 200)
        self.assertEqual(self.raises(lambda: sim.run(10**6)), 3)
        self.assertEqual(len(calls), 3)
        whole, pieces = (granulation.Sim(granulation.def_(seed=1)) for _ in range(2))
        for sim in (whole, pieces):
            sim.add(granule, 200)
        _core.lib.granulation_sim_run(whole._c, 40)
        pieces.run(40)
        self.assertEqual(whole.mean(4, 3), pieces.mean(4, 3))
        with self.assertRaises(riddle.Error):
            pieces.run(-1)
        threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
        begun = time.monotonic()
        with self.assertRaises(KeyboardInterrupt):
            pieces.run(10**6)
        self.assertLess(time.monotonic() - begun, 30.0)

    def test_stop_and_parallel(self):
        definition = dem.def_(dt=1e-5)
        dem.add_material(definition, 2500.0, 5e10, 0.2)
        definition.stop, calls = self.failing(0, 2)
        world, feed = dem.World(definition), dem.default_feed()
        self.assertEqual(self.raises(lambda: world.fill(feed, 20000)), 2)
        self.assertEqual((world.count, len(calls)), (0, 2))
        hashes = []
        for parallel in (None, self.failing(None, 1)[0], lambda user, tasks, task, context: None,
                         lambda user, tasks, task, context: [task(context, k) for k in range(tasks)]):
            definition = dem.def_(dt=1e-5, threads=2, parallel=parallel)
            dem.add_material(definition, 2500.0, 5e10, 0.2)
            world = dem.World(definition)
            world.add_spheres(np.mgrid[0:10, 0:10, 0:10].reshape(3, -1).T * 5e-3, 6e-3, 0)
            try:
                world.run(2e-5, LAW)
            except (Mistake, RuntimeError) as error:
                self.assertIn(len(hashes), (1, 2), error)
            else:
                self.assertIn(len(hashes), (0, 3))
            hashes.append(world.hash())
        self.assertEqual(len(set(hashes)), 1)  # what failed has been run all the same

    def test_laws(self):
        granule, edges = granulation.granule(s=0.52e-12, l=0.33e-12, a=0.15e-12), np.geomspace(1e-13, 1e-11, 11)
        for name, answer in (("selection", 0.1), ("kernel", 1e-9)):
            function, calls = self.failing(answer, 5)
            balance = granulation.Balance(granulation.balance_def(**{name: function}), edges, None)
            balance.add(granule, 100.0)
            self.assertEqual(self.raises(lambda: balance.run(1.0)), 5)
            self.assertEqual(len(calls), 5)

        def rates(user, now, k1, k2):
            k1[0], k2[0] = 0.1, 0.2
            if now > 2.0:
                raise Mistake(now)
        self.raises(lambda: blocking.integrate(blocking.ode_def(rates=rates), [0.0, 1.0, 5.0]))
        definition = filtration.fluid_def(nodes=[8, 8, 8])
        definition.solid.distance, calls = self.failing(1e-5, 3)
        self.raises(lambda: filtration.Fluid(definition))
        definition.solid.distance = lambda self, point: "far"
        with self.assertRaises(TypeError):
            filtration.Fluid(definition)

    def test_own_breakage(self):
        """Two uniform daughters by a function in Python are those that are built in."""
        edges, moments = np.geomspace(1e-3, 50.0, 41), []
        for words in ({"daughters": granulation.UNIFORM},
                      {"daughters": granulation.OWN, "breakage": lambda z, mother, user: z * z}):
            balance = granulation.Balance(granulation.balance_def(kernel=None, selection=lambda g, user: g.s, **words),
                                          edges, None)
            balance.add(granulation.granule(s=20.0), 1.0)
            balance.run(0.3)
            moments.append([balance.moment(p, 0.0) for p in (0.0, 1.0, 2.0)])
        np.testing.assert_allclose(moments[1], moments[0], rtol=1e-3)
        self.assertGreater(moments[0][0], 3.0)

    def test_two_threads(self):
        """Each call raises what its own function raised."""
        def use(number, raised):
            def motion(now):
                if now > 1e-3:
                    raise Mistake(number)
                return (0, 0, 0), (0, 0, 0)
            world = bed(5)
            world.prescribe(0, (0, 0, 0), motion)
            try:
                world.run(1.0, LAW)
            except Mistake as error:
                raised[number] = error.args[0]
        raised = {}
        threads = [threading.Thread(target=use, args=(number, raised)) for number in range(3)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(raised, {0: 0, 1: 1, 2: 2})


class Shown(unittest.TestCase):
    """What a user sees: signatures, stubs, errors, pictures, files."""

    def test_signatures_and_names(self):
        self.assertEqual(str(inspect.signature(dem.World.add_plane)), "(self, material, point, normal)")
        self.assertEqual(str(inspect.signature(blocking.fit)), "(definition, t, f, sigma=None)")
        self.assertIn("gravity", inspect.signature(dem.def_).parameters)
        with open(os.path.join(root, "VERSION"), encoding="utf-8") as file:
            self.assertEqual(riddle.__version__, file.read().strip())
        for module in (riddle, dem, screen, granulation):
            self.assertFalse([name for name in dir(module) if name in ("np", "os", "sys", "json", "fill", "lib", "ffi")
                              or name.startswith("_") and name != "__version__"])
        for shown in (bed(), dem.def_(), granulation.Sim(granulation.def_(seed=1)), bed().wall(0), dem.default_feed()):
            self.assertLess(len(repr(shown)), 1500, repr(shown))

    def test_stubs_have_all_names(self):
        def names(body):
            return {n for node in body
                    for n in ([node.name] if isinstance(node, (ast.FunctionDef, ast.ClassDef)) else [node.target.id]
                              if isinstance(node, ast.AnnAssign) else [])
                    if not n.startswith("_")}

        for lower in _core.api["headers"]:
            module = getattr(riddle, lower)
            with open(os.path.join(here, "riddle", f"{lower}.pyi"), encoding="utf-8") as file:
                tree = ast.parse(file.read())
            self.assertEqual(names(tree.body), set(dir(module)), lower)
            for node in tree.body:
                cls = getattr(module, node.name, None) if isinstance(node, ast.ClassDef) else None
                if isinstance(cls, type) and issubclass(cls, _core.Handle):
                    own = {n for n in dir(cls) if not n.startswith("_") and n != "free"}
                    self.assertEqual(names(node.body), own, node.name)

    def test_mypy(self):
        """The examples pass; what is wrong does not."""
        if not shutil.which("mypy"):
            self.skipTest("mypy is missing (Debian: mypy)")
        with tempfile.TemporaryDirectory() as folder:
            wrong = os.path.join(folder, "wrong.py")
            with open(wrong, "w", encoding="utf-8") as file:
                file.write("from riddle import dem\nd = dem.def_(dt='1e-5')\nd.gravty = 3.0\nw = "
                           "dem.World(d)\nw.runn(1.0)\nw.add_plane(0, (0, 0, 0))\nw.count.x\n")
            programs = [os.path.join(here, "examples", name)
                        for name in sorted(os.listdir(os.path.join(here, "examples"))) if name.endswith(".py")]
            done = subprocess.run(["mypy", "--ignore-missing-imports", "--no-error-summary", "--cache-dir", folder,
                                   *programs, wrong], capture_output=True, text=True,
                                  env={**os.environ, "MYPYPATH": here})
            lines = [line.split(":")[1] for line in done.stdout.split("\n") if ": error:" in line
                     and line.startswith(wrong)]
            self.assertEqual(lines, ["2", "3", "5", "6", "7"], done.stdout)
            self.assertEqual([line for line in done.stdout.split("\n") if ": error:" in line
                              and not line.startswith(wrong)], [])

    def test_errors_name_argument_and_value(self):
        world = bed(3)
        screen_def = dem.default_screen()
        screen_def.aperture = -8e-3
        heavy_and_bad = dem.def_(dt=1e-5)
        for density in (7800.0, -1.0):
            dem.add_material(heavy_and_bad, density, 5e10, 0.2)
        for use, said in ((lambda: world.add_plane(7, (0, 0, 0), (0, 0, 1)),
                           "material = 7: the world has no such material"),
                          (lambda: world.add_plane(0, (0, 0, 0), (0, 0, 0)), r"normal = .*: a direction of length 0"),
                          (lambda: world.add_cylinder(0, (0, 0, 0), (0, 0, 1), -1.0, 1),
                           "radius = -1: must be above 0"),
                          (lambda: world.move(5, (0, 0, 1)), "wall = 5: the world has 1 walls"),
                          (lambda: world.set_motion(99, (0, 0, 0), (0, 0, 0)),
                           "i = 99: there is no such particle: there are 3"),
                          (lambda: world.add_screen(0, screen_def), "screen.aperture = -0.008"),
                          (lambda: world.add_spheres([[0, 0, 1]], [-1e-3], 0), "diameters = .*: must be above 0"),
                          (lambda: world.add_spheres([[0, 0, np.nan]], [1e-3], 0), "centres = .*: not finite"),
                          (lambda: world.run(-1.0, dem.LINEAR), "duration = -1: must not be below 0"),
                          (lambda: world.run(1e-3, 0), "features: no shipped law .*; duration = 0.001, features = 0"),
                          (lambda: world.prescribe(9, (0, 0, 0), lambda now: ((0, 0, 0), (0, 0, 0))),
                           "wall = 9: the world has 1 walls"),
                          (lambda: dem.World(dem.def_(dt=-1.0)), "materials: is 0"),
                          (lambda: dem.World(heavy_and_bad), r"material.density: is .*7800.*-1")):
            with self.assertRaisesRegex(riddle.Error, said) as raised:
                use()
            again = pickle.loads(pickle.dumps(raised.exception))
            self.assertEqual((str(again), again.hint), (str(raised.exception), raised.exception.hint))

    def test_nan_that_means_something_is_no_mistake(self):
        shares = {name: [0.1, 0.5, 0.3] for name in ("feed", "coarse", "fine", "feed_sd", "coarse_sd", "fine_sd")}
        with self.assertRaises(riddle.Error) as raised:
            classifier.reconcile(classifier.balance_data(coarse_share=np.nan, coarse_share_sd=np.nan, **shares))
        self.assertNotIn("not a number", str(raised.exception))
        with self.assertRaisesRegex(riddle.Error, "K = nan: not a number"):
            blocking.average_free(blocking.SPHERICAL, blocking.conditions(x_h=0.3))

    def test_millimetres_are_refused(self):
        world, feed = bed(0), dem.default_feed()
        with self.assertRaisesRegex(ValueError, "3 m is above 1 m: are lengths in metres"):
            world.add_spheres([[0, 0, 5]], [3.0], 0)
        for sizes in (dem.one_size(3.0), dem.uniform_sizes(1.0, 3.0, 0), dem.size_list([1e-3, 3.0], [1.0, 1.0], 0)):
            feed.sizes = sizes
            with self.assertRaisesRegex(ValueError, "are lengths in metres"):
                world.fill(feed, 1)
        world.largest_diameter = 5.0
        world.add_spheres([[0, 0, 5]], [3.0], 0)
        self.assertEqual(world.count, 1)

    def test_lengths_come_from_arrays(self):
        case = screen.case(time=[0.0, 1.0, 2.0], retained=[[1.0, 0.5, 0.2]])
        self.assertEqual(case.times, 3)
        self.assertEqual(screen.def_(diameters=[1e-3, 2e-3]).classes, 2)
        data = classifier.balance_data(**{name: [0.1, 0.5, 0.4]
                                          for name in ("feed", "coarse", "fine", "feed_sd", "coarse_sd", "fine_sd")})
        self.assertEqual(data.classes, 3)
        self.assertEqual(dem.mesh(vertex=np.zeros((5, 3)), triangle=np.zeros((2, 3), dtype=int)).triangles, 2)
        # a length that is given stays
        for wrong in (dict(times=4, time=[0.0, 1.0, 2.0]), dict(time=[0.0, 1.0, 2.0], times=4)):
            self.assertEqual(screen.case(**wrong).times, 4)

    def test_a_wall_tells_its_force(self):
        world = bed(40)
        world.run(1.5, LAW)
        wall, before, begun = world.wall(0), world.wall(0).impulse, world.time
        world.run(0.1, LAW)
        weight = 9.81 * world.masses().sum()
        self.assertAlmostEqual(-(wall.impulse - before)[2] / (world.time - begun) / weight, 1.0, 2)
        self.assertAlmostEqual(-wall.force[2] / weight, 1.0, 1)
        self.assertEqual((wall.kind, wall.enabled, wall.torque.shape), ("plane", True, (3,)))
        with self.assertRaises(IndexError):
            world.wall(1)
        with self.assertRaises(AttributeError):
            wall.fource

    def test_a_wall_tells_its_work(self):
        """A belt gives what lies on it the momentum force x time at its own speed; torque about any point from two
        integrals."""
        world = bed(40)
        world.run(0.5, LAW)
        world.set_belt(0, (0.2, 0.0, 0.0))
        wall = world.wall(0)
        before, done = wall.impulse, wall.work
        world.run(0.2, LAW)
        self.assertAlmostEqual((wall.work - done) / (-0.2 * (wall.impulse - before)[0]), 1.0, 6)
        point = (0.3, -0.2, 0.1)
        np.testing.assert_allclose(wall.angular_impulse_about(point),
                                   wall.angular_impulse - np.cross(point, wall.impulse))
        np.testing.assert_array_equal(wall.angular_impulse_about((0, 0, 0)), wall.angular_impulse)
        with self.assertRaises((TypeError, ValueError)):
            wall.angular_impulse_about((0, 0))

    def test_a_driven_wall_tells_torque_and_coordinate(self):
        definition = dem.def_(dt=1e-5)
        glass = dem.add_material(definition, 2500.0, 5e10, 0.2)
        dem.pair(definition, glass, glass).stiffness = 1e4
        world = dem.World(definition)
        drum = world.add_cylinder(glass, (0, 0, 0), (0, 1, 0), 0.05, 1)
        # beside the axis: its weight turns the drum, by friction only
        world.add_spheres([[0.045, 0, 0]], [0.01], glass)
        world.control_torque(drum, (0, 0, 0), (0, 1, 0), 1e-4, 1e-3, 0.0)
        world.run(0.01, LAW)
        self.assertAlmostEqual(world.wall(drum).rate, 1e-3 / 1e-4 * 0.01, 3)
        self.assertGreater(world.wall(drum).coordinate, 0.0)

    def test_pictures_and_sections(self):
        world = bed(40)
        picture = world.picture(size=(200, 100), names=["beads"], speed=0.0)
        self.assertEqual(picture.pixels.shape, (100, 200, 3))
        self.assertGreater(len(np.unique(picture.pixels.reshape(-1, 3), axis=0)), 50)
        data = picture._repr_png_()
        self.assertEqual((data[:8], struct.unpack(">II", data[16:24])), (b"\x89PNG\r\n\x1a\n", (200, 100)))
        size = struct.unpack(">I", data[33:37])[0]
        rows = np.frombuffer(zlib.decompress(data[41:41 + size]), dtype=np.uint8).reshape(100, 601)
        self.assertTrue(np.array_equal(rows[:, 1:].reshape(100, 200, 3), picture.pixels))
        drawing = world.section(title="Beads & <more>", names=["beads"])
        self.assertTrue(drawing.svg.startswith("<svg") and "beads" in drawing.svg
                        and drawing.svg.rstrip().endswith("</svg>"))
        with tempfile.TemporaryDirectory() as folder:
            picture.save(os.path.join(folder, "a.png")), drawing.save(os.path.join(folder, "a.svg"))
            with dem.Series(os.path.join(folder, "new"), "beads") as frames:
                for _ in range(2):
                    world.run(1e-3, LAW)
                    frames.add(world)
            with open(os.path.join(folder, "new", "beads.pvd"), encoding="utf-8") as file:
                self.assertEqual(file.read().count("<DataSet"), 2)
            with self.assertRaisesRegex(ValueError, "closed"):
                frames.add(world)
            with self.assertRaises(OSError):
                dem.Series(os.path.join(folder, "a.png"), "beads")
        for wrong in (dict(size=(10, 10)), dict(size=(99999, 100)), dict(size="ab"), dict(direction=(0, 0)),
                      dict(names="beads"), dict(names=[1])):
            with self.assertRaises((ValueError, TypeError)):
                world.picture(**wrong)
        for wrong in (dict(normal=(1, 0, 0)), dict(normal=(0, 0, 0)), dict(point=(0, 0, np.nan)), dict(names="beads")):
            with self.assertRaises((ValueError, TypeError)):
                world.section(**wrong)
        self.assertIsNone(bed(0)._repr_png_())

    def test_fits_say_what_is_open(self):
        free = blocking.fit(blocking.fit_def(), [0, 5, 10, 20, 30, 60, 90],
                            [1.0, 0.93, 0.885, 0.83, 0.80, 0.762, 0.753])
        self.assertEqual([row["note"] for row in free.rows()], ["", "", ""])
        self.assertRegex(str(free), r"k \[1/s\] +0.05947 +0.05157 \.\. 0.06832\n")
        definition = screen.def_(diameters=[5e-3])
        times = np.linspace(0.0, 10.0, 11)
        case = screen.case(operation=screen.operation(amplitude=1e-3, frequency=50.0), time=times,
                           retained=[np.exp(-0.3 * times)])
        fit = screen.fit(definition, screen.DONG, [case], screen.default_fit_options(screen.DONG))
        notes = [row["note"] for row in fit.rows()]
        self.assertIn("without influence on these data", notes)
        self.assertNotIn("1000", str(fit))
        self.assertIn("<table>", fit._repr_html_())

    def test_the_readme(self):
        with open(os.path.join(root, "README.md"), encoding="utf-8") as file:
            programs = re.findall(r"```python\n(.*?)```", file.read(), re.S)
        self.assertTrue(programs)
        with tempfile.TemporaryDirectory() as folder:
            for program in programs:
                subprocess.run([sys.executable, "-c", program], cwd=folder, check=True,
                               env={**os.environ, "PYTHONPATH": here})
            self.assertTrue(os.path.exists(os.path.join(folder, "bed.png")))

    def test_a_monte_carlo(self):
        """A constant kernel: the number halves in the time 2 / (number per volume x kernel)."""
        sample = [granulation.granule(s=1e-15) for _ in range(400)]
        box = granulation.Montecarlo(sample, 4e-7, lambda i, j, user: 1e-9, 7)
        self.assertTrue([name for name in dir(box) if not name.startswith("_")])

    def test_a_notebook(self):
        try:
            import ipykernel  # noqa: F401
            import nbclient
            import nbformat
            import pandas  # noqa: F401
        except ImportError as error:
            self.skipTest(f"{error.name} is missing (Debian: python3-nbclient, python3-ipykernel, python3-pandas)")
        notebook = nbformat.read(os.path.join(here, "examples", "heap.ipynb"), 4)
        self.assertFalse([cell for cell in notebook.cells if cell.get("outputs")])
        with tempfile.TemporaryDirectory() as folder, unittest.mock.patch.dict(os.environ,
                                                                               {"PYTHONPATH": here,
                                                                                "PYDEVD_DISABLE_FILE_VALIDATION": "1",
                                                                                "IPYTHONDIR": folder}):
            nbclient.NotebookClient(notebook, timeout=120, kernel_name="python3").execute()
        kinds = {kind for cell in notebook.cells for output in cell.get("outputs", [])
                 for kind in output.get("data", {})}
        self.assertTrue({"image/png", "image/svg+xml", "text/html"} <= kinds, kinds)
        printed = "".join(o.get("text", "") for cell in notebook.cells for o in cell.get("outputs", [])
                          if o.get("name") == "stdout")
        on_floor, weight = (float(number) for number in re.findall(r"([\d.]+) N", printed))
        self.assertAlmostEqual(on_floor / weight, 1.0, 2)


class Hostile(unittest.TestCase):
    """Wrong arguments raise; nothing crashes the interpreter."""

    # legal numbers that mean hours
    LONG = re.compile(r"_run$|^dem_fill|^dem_feed|_montecarlo|_sim_add$|_calibrate$|_for$")

    def test_random_arguments(self):
        rng = random.Random(7)
        odd = [0, -1, 1, 7, 10**12, 1e308, -1e308, 5e-324, float("nan"), float("inf"), None, "text", b"bytes", [],
               [1.0], [[1.0]], [1.0, 2.0, 3.0], np.zeros(3), np.zeros((2, 3)),
               (0, 0, 1), {}, object(), True, np.float32(2), np.arange(4), lambda *a: 0.0]
        functions = [f for lower in _core.api["headers"] for f in getattr(riddle, lower)._functions.values()
                     if not self.LONG.search(f.c_name)]
        structures = [c for c in _core._classes.values() if issubclass(c, _core.Structure)]
        kinds = {c._name: c for c in structures}
        end, calls = time.monotonic() + SECONDS, 0
        while time.monotonic() < end:
            function = rng.choice(functions)
            lower = function.c_name.split("_")[0]
            about = _core.api["headers"][lower]["functions"][function.c_name]
            visible = _core.Function(lower, function.c_name, about).visible
            arguments = []
            for p in visible:
                if p.type in kinds and rng.random() < 0.8:
                    made = kinds[p.type]()
                    if p.type == "classifier_def":
                        # the default's 8192 trajectories of a far too small particle take minutes
                        made.points, made.shifts = 16, 2
                    for name in rng.sample(made._fields(), min(2, len(made._fields()))) if rng.random() < 0.5 else []:
                        try:
                            setattr(made, name, rng.choice(odd))
                        except (TypeError, ValueError, AttributeError, OverflowError, IndexError):
                            pass
                    arguments.append(made)
                elif p.opaque and p.type == "dem_world" and rng.random() < 0.8:
                    arguments.append(bed(5))
                elif p.pointer and rng.random() < 0.7:
                    arguments.append([rng.uniform(0.0, 1.0) for _ in range(rng.choice((0, 1, 2, 3, 8)))])
                else:
                    arguments.append(rng.choice(odd[:10]) if rng.random() < 0.7 else rng.choice(odd))
            if "--trace" in sys.argv:
                print(calls, function.c_name, arguments, file=sys.stderr, flush=True)
            try:
                function(*arguments)
            except (TypeError, ValueError, OverflowError, riddle.Error, MemoryError, IndexError, AttributeError):
                pass
            calls += 1
        self.assertGreater(calls, 100)

    def test_a_freed_handle(self):
        world = bed(3)
        world.free()
        for use in (world.positions, world.hash, lambda: world.run(1e-3, LAW)):
            with self.assertRaises(ValueError):
                use()


class Programs(unittest.TestCase):
    def test_examples(self):
        try:
            import matplotlib  # noqa: F401
        except ImportError:
            self.skipTest("python3-matplotlib is missing")
        with tempfile.TemporaryDirectory() as folder:
            for name in sorted(name for name in os.listdir(os.path.join(here, "examples")) if name.endswith(".py")):
                done = subprocess.run([sys.executable, os.path.join(here, "examples", name), "--quick"], cwd=folder,
                                      capture_output=True, text=True,
                                      env={**os.environ, "PYTHONPATH": here})
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertTrue(os.path.exists(os.path.join(folder, name.replace(".py", ".png"))), name)

    def test_what_examples_refuse(self):
        """In one line, with status 2, and nothing written; so does whatever takes its options by riddle.script."""
        with tempfile.TemporaryDirectory() as folder:
            program = os.path.join(folder, "mine.py")
            with open(program, "w", encoding="utf-8") as file:
                file.write("from riddle import dem, script\nOPTIONS = script.options('Mine.')\nprint('ran')\n"
                           "class Figure:\n    def savefig(self, path, format):\n        open(path, 'wb').write(b'x' * "
                           "(1 << 20))\n"
                           "        if OPTIONS.quick:\n            raise KeyboardInterrupt\n"
                           "script.save(Figure(), OPTIONS, 'mine.png')\n")

            def run(*words, out=subprocess.PIPE, limit=None):
                return subprocess.run([sys.executable, program, *words], cwd=folder, stdout=out, stderr=subprocess.PIPE,
                                      text=True, env={**os.environ, "PYTHONPATH": here},
                                      preexec_fn=limit)

            for words in (["--no-such-thing"], ["--quick=1"], ["stray"], ["--out"], ["--out", ""],
                          ["--out", "/dev/null/x"], ["--qui"], ["--out", program], ["\x1b[31m"]):
                done = run(*words)
                self.assertEqual((done.returncode, done.stdout, done.stderr.count("\n")), (2, "", 1), done.stderr)
                self.assertTrue(done.stderr.startswith("mine.py: "), done.stderr)
            self.assertIn("--quick", run("--help").stdout)
            done = run("--quick")
            self.assertEqual((done.returncode, done.stderr), (130, "mine.py: interrupted\n"))
            with open("/dev/full", "w") as full:
                done = run(out=full)
            self.assertEqual((done.returncode, done.stderr.count("\n")), (1, 1), done.stderr)
            reader, writer = os.pipe()
            os.close(reader)
            done = run(out=writer)  # as in "| head -1"
            os.close(writer)
            self.assertEqual((done.returncode, done.stderr), (141, ""))
            self.assertFalse([name for name in os.listdir(folder) if name.endswith(".part")])
            self.assertEqual(run().returncode, 0)

            def small_files():
                signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
                resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))

            os.remove(os.path.join(folder, "mine.png"))
            done = run(limit=small_files)
            self.assertEqual((done.returncode, done.stderr.count("\n")), (1, 1), done.stderr)
            self.assertEqual(os.listdir(folder), ["mine.py"])


class Calibrating(unittest.TestCase):
    ANGLE = calibrate.Target("angle", 28.0, 0.5)

    @staticmethod
    def heap(values, seed):
        noise = np.random.default_rng(seed).normal()
        return {"angle": 12.0 + 22.0 * values["mu"] / (values["mu"] + 0.25) + 0.3 * noise}

    def test_finds_what_was_put_in(self):
        found = calibrate.calibrate(self.heap, [("mu", 0.1, 0.9)], [self.ANGLE], runs=14)
        self.assertLess(found.low["mu"], 2.0 / 3.0)  # where the angle is 28
        self.assertGreater(found.high["mu"], 2.0 / 3.0)
        self.assertLess(found.high["mu"] - found.low["mu"], 0.4)
        self.assertFalse(found.remarks)
        self.assertIn("mu", str(found))

    def test_units_and_order_do_not_matter(self):
        one, two = calibrate.Parameter("mu", 0.1, 0.9), calibrate.Parameter("idle", 1.0, 100.0, True)
        found = calibrate.calibrate(self.heap, [one, two], [self.ANGLE], runs=20)
        other = calibrate.calibrate(lambda v, seed: {"angle": 1024.0 * self.heap(v, seed)["angle"]}, [one, two],
                                    [calibrate.Target("angle", 1024.0 * 28.0, 512.0)], runs=20)
        np.testing.assert_allclose(list(other.low.values()), list(found.low.values()), rtol=1e-9)
        self.assertIn("idle: the targets leave it open", found.remarks)
        turned = calibrate.calibrate(self.heap, [two, one], [self.ANGLE], runs=20)
        self.assertLess(abs(turned.values["mu"] - found.values["mu"]), 0.3 * (found.high["mu"] - found.low["mu"]))

    def test_what_cannot_be_told(self):
        both = [("mu", 0.1, 0.9), ("roll", 0.1, 0.9)]
        found = calibrate.calibrate(lambda v, seed: {"angle": 10.0 + 20.0 * (v["mu"] + v["roll"])}, both,
                                    [calibrate.Target("angle", 30.0, 0.2)], runs=20)
        self.assertTrue(any("only together; one rises where the other falls" in text for text in found.remarks),
                        found.remarks)
        found = calibrate.calibrate(self.heap, [("mu", 0.1, 0.9)], [calibrate.Target("angle", 60.0, 0.5)], runs=14)
        self.assertIn("angle: no parameters within the bounds give the measured value", found.remarks)

    def test_stops_and_goes_on(self):
        with tempfile.TemporaryDirectory() as folder:
            store, calls = os.path.join(folder, "runs"), []

            def run(values, seed):
                calls.append(seed)
                if len(calls) == 6:
                    raise KeyboardInterrupt
                return self.heap(values, seed)

            with self.assertRaises(KeyboardInterrupt):
                calibrate.calibrate(run, [("mu", 0.1, 0.9)], [self.ANGLE], runs=14, store=store)
            with open(store, "a", encoding="utf-8") as file:
                file.write('{"at": [0.')  # cut off
            found = calibrate.calibrate(run, [("mu", 0.1, 0.9)], [self.ANGLE], runs=14, store=store)
            self.assertEqual((len(calls), found.runs), (15, 14))
            with self.assertRaisesRegex(ValueError, "other parameters"):
                calibrate.calibrate(run, [("mu", 0.1, 0.8)], [self.ANGLE], runs=14, store=store)
            with self.assertRaisesRegex(ValueError, "another simulation"):
                calibrate.calibrate(run, [("mu", 0.1, 0.9)], [self.ANGLE], runs=14, store=store,
                                    of="a scene that has changed")

    def test_a_mean_that_climbs(self):
        """It is no result: a run gives it with steady false."""
        target = {"command": sys.executable + """ -c 'open("{json}", "w").write("STATE")'""",
                  "result": "means_of_second_half.power.mean"}
        for steady, wanted in ((True, 3.5), (False, None)):
            with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stderr(io.StringIO()) as said:
                state = json.dumps({"means_of_second_half": {"power": {"mean": 3.5, "steady": steady}}})
                state = state.replace('"', '\\"').replace("{", "{{").replace("}", "}}")
                programs = calibrate._Programs(os.path.join(folder, "a.yaml"), folder, {},
                                               [{**target, "command": target["command"].replace("STATE", state)}])
                self.assertEqual(programs({}, 1), {target["result"]: wanted})
            self.assertEqual("is not steady" in said.getvalue(), not steady)

    def test_runs_of_another_scene(self):
        """The runs of a command that has changed are not mixed with new ones; other measured values may use them."""
        text = """runs: 14
parameters: {mu: {low: 0.1, high: 0.9}}
targets: [{command: "PYTHON -c 'open(\\"{json}\\", \\"w\\").write(str(dict(a=FACTOR*{mu})).replace(chr(39), chr(34)))'",
           result: a, value: VALUE, error: 0.01}]
""".replace("PYTHON", sys.executable)
        with tempfile.TemporaryDirectory() as folder:
            path, out = os.path.join(folder, "one.yaml"), os.path.join(folder, "out")
            for factor, value, told in (("1.0", "0.5", 0), ("1.0", "0.6", 0), ("2.0", "0.6", 1)):
                with open(path, "w", encoding="utf-8") as file:
                    file.write(text.replace("FACTOR", factor).replace("VALUE", value))
                with contextlib.redirect_stderr(io.StringIO()) as said, contextlib.redirect_stdout(io.StringIO()):
                    self.assertEqual(calibrate.main([path, "--out", out]), told, said.getvalue())
            self.assertIn("another simulation", said.getvalue())
            for comma, said in (("'0,6'", "a: value: '0,6' is no number .a decimal point is wanted."),
                                ("0,6", "6: not known here; .* .a decimal point is wanted.")):
                with open(path, "w", encoding="utf-8") as file:
                    file.write(text.replace("FACTOR", "1.0").replace("VALUE", comma))
                with self.assertRaisesRegex(SystemExit, said):
                    calibrate.main([path, "--out", out])

    def test_bad_arguments(self):
        nan, mu = float("nan"), ("mu", 0.1, 0.9)
        for parameters, targets, runs in (([("mu", 0.9, 0.1)], [self.ANGLE], 14),
                                          ([("mu", 0.0, 1.0, True)], [self.ANGLE], 14),
                                          ([mu], [("angle", nan, 1.0)], 14),
                                          ([mu], [("angle", 1.0, 0.0)], 14), ([mu, mu], [self.ANGLE], 14),
                                          ([], [self.ANGLE], 14), ([mu], [], 14), ([mu], [self.ANGLE], 5)):
            with self.assertRaises(ValueError):
                calibrate.calibrate(self.heap, parameters, targets, runs=runs)
        with self.assertRaisesRegex(ValueError, "0 of 8 runs gave a number"):
            calibrate.calibrate(lambda v, seed: None, [mu], [self.ANGLE], runs=14)
        with self.assertRaisesRegex(ValueError, "0 of 8 runs gave a number"):
            calibrate.calibrate(lambda v, seed: {"angle": nan}, [mu], [self.ANGLE], runs=14)

    def test_command(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "powder.yaml")
            write = ("import json, sys; json.dump({'heap': {'angle_deg': [10 + 30 * float(sys.argv[1])]}}, "
                     "open(sys.argv[2], 'w'))")
            pathlib.Path(os.path.join(folder, "heap.py")).write_text(write, encoding="utf-8")
            scene = f"""runs: 14
parallel: 2
parameters:
  mu: {{key: contacts.friction, low: 0.1, high: 0.9}}
targets:
  - {{command: "{sys.executable} {folder}/heap.py {{mu}} {{json}}", result: heap.angle_deg.0, value: 25, error: 0.3}}
"""

            def run(text):
                pathlib.Path(path).write_text(text, encoding="utf-8")
                return subprocess.run([sys.executable, "-m", "riddle.calibrate", path, "--out", folder],
                                      capture_output=True, text=True, check=False, cwd=here)

            done = run(scene)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertRegex(done.stdout, r"with: --set contacts.friction=0\.(5[01]|4[89])")
            self.assertIn("with: --set contacts.friction="
                          + pathlib.Path(folder, "found.set").read_text(encoding="utf-8").split("friction=")[1][:3],
                          done.stdout)
            twice = scene.replace("targets:\n", f"""targets:
  - {{command: "{sys.executable} {folder}/heap.py 0.5 {{json}}", result: heap.angle_deg.0, value: 25, error: 0.3}}
""")  # another program with a result of this name
            done = run(twice.replace("runs: 14", "runs: 12"))
            self.assertIn("other parameters or targets", done.stderr)
            os.remove(os.path.join(folder, "runs.jsonl"))
            done = run(twice.replace("runs: 14", "runs: 12"))
            self.assertEqual((done.returncode, done.stdout.count("heap.angle_deg.0")), (0, 2), done.stderr)
            os.remove(os.path.join(folder, "runs.jsonl"))
            with open(os.path.join(folder, "result.json"), encoding="utf-8") as file:
                self.assertLess(abs(json.load(file)["parameters"]["mu"]["value"] - 0.5), 0.02)
            for text, said in ((scene.replace("low: 0.1, ", ""), "low is missing"),
                               (scene.replace("error: 0.3", "error: -1"), "error above 0"),
                               (scene.replace("runs: 14", "run: 14"), "run: not known"), ("- 1\n", ""), (": :", "")):
                done = run(text)
                self.assertEqual((done.returncode, done.stdout, done.stderr.count("\n")), (1, "", 1), done.stderr)
                self.assertIn(said, done.stderr)


class Made(unittest.TestCase):
    def test_shapes_twice(self):
        """A row of shapes.txt that stands there twice is refused."""
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "shapes.txt")
            call = [sys.executable, "-B", "-c",
                    "import sys, generate; print(len(generate.read_shapes(sys.argv[1])))", path]
            for rows, status in (("a.b: [n]\n# a\na.c: [n]\n", 0), ("a.b: [n]\na.c: [n]\na.b : [n] # again\n", 1)):
                pathlib.Path(path).write_text(rows, encoding="utf-8")
                done = subprocess.run(call, capture_output=True, text=True, check=False, cwd=here)
                self.assertEqual(done.returncode, status, done.stderr)
            self.assertIn("a.b stands there twice", done.stderr)


if __name__ == "__main__":
    only = [word for word in sys.argv[1:] if word[0].isupper()]  # Shown.test_mypy
    pattern = os.environ.get("RIDDLE_TEST_PATTERN")
    result = unittest.main(argv=[sys.argv[0], *only, *(["-k", pattern] if pattern else [])], exit=False,
                           verbosity=1).result
    bad = len(result.failures) + len(result.errors)
    print(f"{result.testsRun - bad - len(result.skipped)} passed, {bad} failed, {len(result.skipped)} skipped")
    sys.exit(bad > 0)
