#!/usr/bin/env python3
"""Writes a C program that calls every public function of a header with hostile numbers and null pointers: in each
argument, and in each field of each structure that it takes, one at a time. Everything is read off the declarations
(python/generate.py), so that a new function or field is tried without being named.

    tests/hostile.py HEADER >FILE.c        the program prints how many calls it made; a sanitizer and an alarm are the
                                           judges
"""
import os
import re
import sys

root = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
sys.path.insert(0, os.path.join(root, "python"))
import generate  # noqa: E402
from pycparser import c_ast  # noqa: E402

# Structures that a header fills itself: how to make one, and to take it away again. {p}: a pointer to zeros.
MAKERS = {
    "dem_world": ("make_world({p});", "use_world({p}); dem_free({p});"),
    "granulation_sim": ("make_sim({p});", "granulation_sim_free({p});"),
    "granulation_balance": ("make_balance({p});", "granulation_balance_free({p});"),
    "granulation_montecarlo": ("make_monte_carlo({p});", "granulation_montecarlo_free({p});"),
    "classifier_model": ("make_model({p});", "classifier_free({p});"),
    "filtration_fluid": ("make_fluid({p});", "filtration_fluid_free({p});"),
}
HELPERS = {
    "dem_": """
static void make_world(dem_world *w) {
    dem_def def = dem_default_def();
    double at[9] = {0, 0, 0.001, 0, 0, 0.0028, 0.001, 0, 0.0048}, d[3] = {2e-3, 2e-3, 2e-3};
    dem_screen screen = dem_default_screen();
    dem_add_material(&def, 2500.0, 1e7, 0.2), dem_add_material(&def, 2500.0, 1e7, 0.2);
    def.dt = 1e-5, dem_pair(&def, 0, 0)->stiffness = 100.0;
    dem_init(w, &def, NULL);
    dem_add_plane(w, 0, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1));
    dem_add_box(w, 0, dem_vec3(-1, -1, -1), dem_vec3(1, 1, 1)), dem_add_screen(w, 0, &screen);
    dem_add_spheres(w, 3, at, d, 0, 0);
    dem_run(w, 1e-4, DEM_LINEAR);
}
static void use_world(dem_world *w) { /* what a call has accepted must not harm later */
    double at[3] = {4e-3, 0, 4e-3};
    dem_measure measure;
    dem_region all = dem_sphere_region(dem_vec3(0, 0, 0), 1.0);
    dem_add_convex(w, 0, 1, at, NULL, 0, 0);
    dem_run(w, 3.0 * w->def.dt, DEM_LINEAR | DEM_FRICTION | DEM_ENERGY);
    for (ptrdiff_t i = 0; i < w->count; i++) dem_get_body(w, i);
    dem_measure_region(w, &all, &measure), dem_energy(w), dem_hash(w), dem_core_overlaps(w);
    dem_save(w, numbers, sizeof numbers), reset();
}
""",
    "granulation_": """
static void make_sim(granulation_sim *s) {
    granulation_def def = granulation_default_def();
    granulation_granule g = {5e-13, 3e-13, 2e-13};
    granulation_sim_init(s, &def), granulation_sim_add(s, &g, 5);
}
static void make_balance(granulation_balance *b) {
    granulation_balance_def def = granulation_balance_default_def();
    double edges[6] = {1e-13, 2e-13, 4e-13, 8e-13, 1.6e-12, 3.2e-12};
    granulation_granule g = {5e-13, 1e-13, 2e-13};
    def.most_steps = 100;
    if (granulation_balance_init(b, &def, 5, edges, NULL, 0, NULL, NULL) == GRANULATION_OK)
        granulation_balance_add(b, &g, 1e3);
}
static void make_monte_carlo(granulation_montecarlo *m) {
    granulation_granule g[4] = {{5e-13, 1e-13, 0}, {5e-13, 1e-13, 0}, {5e-13, 1e-13, 0}, {5e-13, 1e-13, 0}};
    granulation_montecarlo_init(m, g, 4, 1e-9, granulation_constant_kernel, NULL, 1, NULL);
}
""",
    "classifier_": """
static void make_model(classifier_model *m) {
    classifier_def def = classifier_default_def();
    def.points = 64;
    classifier_init(m, &def, NULL);
}
""",
    "filtration_": """
static void make_fluid(filtration_fluid *f) {
    filtration_fluid_def def = filtration_fluid_default_def();
    for (int a = 0; a < 3; a++) def.nodes[a] = 8;
    filtration_fluid_init(f, &def);
}
""",
}
# Defaults that take long, made short.
SHORTER = {
    "classifier_def": "{a}.points = 64;",
    "filtration_fluid_def": "for (int q = 0; q < 3; q++) {a}.nodes[q] = 8;",
    "dem_feed": "{a}.region = dem_box_region(dem_vec3(0, 0, 0), dem_vec3(8e-3, 8e-3, 8e-3)), {a}.sizes = "
                "dem_one_size(4e-3), {a}.tries = 20;",
}
# Called with null pointers only: they own what others made, want a hook that is always there, or read bytes.
NULL_ONLY = re.compile(r"_free$|_load$|_save$|^dem_read_stl$|^dem_run_law$|^dem_set_links$|^dem_free_mesh$|"
                       r"^filtration_solid_cut$|^filtration_image_(?!check)")
# Not called: what a kernel calls with what it has made, and an accessor.
SKIPPED = re.compile(r"^dem_force_|^dem_prepare_|^dem_axis_of$")
REALS, WHOLES = {"double", "float"}, {"int", "int32_t", "int64_t", "uint32_t", "uint64_t", "size_t", "ptrdiff_t",
                                      "unsigned int", "uint8_t", "unsigned char", "int16_t", "long"}


class Caller:
    def __init__(self, file):
        self.h = generate.Header(file)
        self.shapes = generate.read_shapes()
        self.structs, self.enums = {}, set()
        for node in self.h.tree.ext:
            if isinstance(node, c_ast.Typedef) and isinstance(node.type, c_ast.TypeDecl):
                inner = node.type.type
                if isinstance(inner, c_ast.Struct) and inner.decls and node.name not in MAKERS:
                    self.structs[node.name] = inner.decls
                elif isinstance(inner, c_ast.Enum):
                    self.enums.add(node.name)
        self.defaults = {}
        for name, f in self.h.functions.items():
            if not f["parameters"] and f["returns"] in self.structs:
                self.defaults.setdefault(f["returns"], name)

    @staticmethod
    def name_of(kind):
        """double, dem_vec, ... of a declaration that is no pointer."""
        inner = kind.type if isinstance(kind, c_ast.TypeDecl) else None
        return " ".join(inner.names) if isinstance(inner, c_ast.IdentifierType) else None

    def lengths(self, struct):
        """Fields of a structure, or parameters of a function, that tell how long arrays are."""
        text = " ".join(v for k, v in self.shapes.items() if k.split(".")[0] == struct)
        return set(re.findall(r"\w+", text))

    def leaves(self, name, path=""):
        """(path, kind of number, is it a length) of every number in a structure."""
        lengths = self.lengths(name)
        for d in self.structs[name]:
            kind, at = d.type, path + d.name
            while isinstance(kind, c_ast.ArrayDecl):
                kind, at = kind.type, at + "[0]"
            inner = self.name_of(kind)
            if inner in self.structs:
                yield from self.leaves(inner, at + ".")
            elif inner in REALS:
                yield at, "real", False
            elif inner in WHOLES or inner in self.enums:
                yield at, "whole", d.name in lengths or d.name in ("count", "n")

    def pointers(self, name, path=""):
        """Every pointer in a structure, functions too."""
        for d in self.structs[name]:
            if isinstance(d.type, c_ast.PtrDecl):
                yield path + d.name
            elif self.name_of(d.type) in self.structs:
                yield from self.pointers(self.name_of(d.type), path + d.name + ".")

    def fill(self, name, variable, lines):
        """Assigns something to the numbers and arrays of a structure that has no default function."""
        for path, kind, _ in self.leaves(name):
            lines.append(f"{variable}.{path} = {'0.5' if kind == 'real' else '1'};")
        self.point(name, variable, lines)

    def point(self, name, variable, lines):
        for d in self.structs[name]:
            if isinstance(d.type, c_ast.PtrDecl) and self.name_of(d.type.type) in REALS:
                lines.append(f"if (!{variable}.{d.name}) {variable}.{d.name} = numbers;")
            elif isinstance(d.type, c_ast.PtrDecl) and self.name_of(d.type.type) in ("int", "int32_t"):
                lines.append(f"if (!{variable}.{d.name}) {variable}.{d.name} = indices;")

    def argument(self, p, k, lines, after):
        """Declares argument k; returns what is passed, and the targets (path, kind, length?) within it; None: cannot be
        called."""
        kind = p.type
        inner = self.name_of(kind)
        if inner in REALS:
            lines.append(f"{inner} a{k} = 1e-3;")
            return f"a{k}", [("", "real", False)]
        if inner in WHOLES or inner in self.enums or inner == "_Bool":
            lines.append(f"{inner} a{k} = ({inner})1;")
            return f"a{k}", [] if inner == "_Bool" else [("", "whole", None)]
        if inner in self.structs:
            return self.structure(inner, k, lines), list(self.leaves(inner))
        if not isinstance(kind, (c_ast.PtrDecl, c_ast.ArrayDecl)):
            return None, []
        if isinstance(kind.type, c_ast.FuncDecl):
            return "NULL", []
        inner = self.name_of(kind.type)
        if inner in self.structs:
            return self.several(inner, k, lines), list(self.leaves(inner))
        if inner in MAKERS:
            make, free = MAKERS[inner]
            lines += [f"static {inner} a{k};", f"memset(&a{k}, 0, sizeof a{k});"]
            lines += [] if self.naming.endswith(("_init", "_load")) else [make.format(p=f"&a{k}")]
            after.append(free.format(p=f"&a{k}"))
            return f"&a{k}", []
        if inner == "double":
            return "numbers", []
        if inner in WHOLES:
            return f"({inner} *)(void *)indices", []
        if inner == "char":
            return '"text"', []
        return "NULL", []

    def several(self, name, k, lines):
        """An array of structures, for what may want one."""
        if name in self.defaults:
            return "&" + self.structure(name, k, lines)
        lines += [f"static {name} b{k}[64];", f"memset(b{k}, 0, sizeof b{k});", f"{name} a{k};",
                  f"memset(&a{k}, 0, sizeof a{k});"]
        self.fill(name, f"a{k}", lines)
        lines.append(f"/* */ for (int q = 0; q < 64; q++) b{k}[q] = a{k};")
        return f"b{k}"

    def structure(self, name, k, lines):
        if name in self.defaults:
            lines.append(f"{name} a{k} = {self.defaults[name]}(); {SHORTER.get(name, '').format(a=f'a{k}')}")
            self.point(name, f"a{k}", lines)
        else:
            lines += [f"{name} a{k};", f"memset(&a{k}, 0, sizeof a{k});"]
            self.fill(name, f"a{k}", lines)
        return f"a{k}"

    def function(self, name, declaration):
        lines, after, passed, targets, null_only = [], [], [], [], NULL_ONLY.search(name)
        # trusts its pointers
        is_law = "static" in declaration.storage and not self.h.functions[name]["returns"].endswith("_status")
        self.naming = name
        lengths = self.lengths(name) | {"n", "count", "bins", "capacity", "rows", "columns", "classes", "cells",
                                        "l_cells", "steps", "max_steps", "threads"}
        for k, p in enumerate(declaration.type.args.params if declaration.type.args else []):
            if isinstance(p, c_ast.Typename):
                continue
            text, within = self.argument(p, k, lines, after)
            if text is None:
                return None
            is_pointer = isinstance(p.type, (c_ast.PtrDecl, c_ast.ArrayDecl)) and text != "NULL" and not is_law
            passed.append(f"(nulled == {k} ? NULL : {text})" if is_pointer else text)
            if is_pointer:
                targets.append((f"nulled = {k}", "null", False, p.name))
            inner = self.name_of(p.type.type if isinstance(p.type, (c_ast.PtrDecl, c_ast.ArrayDecl)) else p.type)
            for path in self.pointers(inner) if inner in self.structs and not is_law else []:
                targets.append((f"a{k}.{path} = NULL", "null", False, f"{p.name}.{path}"))
            for path, kind, is_length in within if not null_only else []:
                short = p.name in lengths if is_length is None else is_length
                at = f"a{k}.{path}" if path else f"a{k}"
                targets.append((at, kind, short, f"{p.name}.{path}" if path else p.name))
        void = self.h.functions[name]["returns"] == "void"
        code = [f"static int call_{name}(int target, int value) {{"]
        code += ["    reset();"] + ["    " + line for line in lines] + [f'    where = "{name}";']
        if null_only:
            code.append("    if (target < 0) { %s }" % " ".join(after + ["return 1;"]))
        code.append("    switch (target) {")
        for t, (at, kind, short, told) in enumerate(targets):
            if kind == "null":
                code.append(f'    case {t}: if (value > 0) {{ {" ".join(after + ["return 1;"])} }} field = "{told} '
                            f'(null)"; {at}; break;')
                continue
            put = ("hostile[value]" if kind == "real"
                   else "lengths[value] > 0 ? lengths[value] : -(lengths[value] < 0 && (typeof(%s))-1 < 0)" % at
                   if short else "wholes[value]")
            leave = " ".join(after + ["return 1;"])
            code.append(f'    case {t}: if (value >= '
                        f'{"REALS" if kind == "real" else "LENGTHS" if short else "WHOLES"}) '
                        f'{{ {leave} }} field = "{told}"; {at} = {put}; break;')
        code += ["    default: break;", "    }"]
        code += [f"    b{k}[0] = a{k};" for k, text in enumerate(passed) if text.endswith(f" b{k})")]
        code += [f"    {'' if void else '(void)'}{name}({', '.join(passed)});"]
        code += ["    " + line for line in after] + ["    return 0;", "}"]
        return code, len(targets)

    def program(self):
        functions, code = [], []
        for node in self.h.tree.ext:
            declaration = node.decl if isinstance(node, c_ast.FuncDef) else node
            name = declaration.name
            if (not isinstance(declaration, c_ast.Decl) or name not in self.h.functions or SKIPPED.search(name)
                or name in [f for f, _ in functions]):
                continue
            made = self.function(name, declaration)
            if made:
                code += made[0] + [""]
                functions.append((name, made[1]))
        helpers = next((v for k, v in HELPERS.items() if k == self.h.lower + "_"), "")
        rows = "\n".join(f'    {{"{n}", call_{n}, {t}}},' for n, t in functions)
        return PROGRAM.replace("HEADER",
                               self.h.file).replace("HELPERS",
                                                    helpers).replace("CALLS", "\n".join(code)).replace("ROWS", rows)


PROGRAM = r"""/* Generated by tests/hostile.py. */
#include <float.h>
#include <limits.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/time.h>
#include <unistd.h>

#include "HEADER"

static const double hostile[] = {NAN,    INFINITY, -INFINITY, 1e308, -1e308, 1e200, 1e30,
                                 5e-324, 1e-300,   1e-200,    -1.0,  0.0,    -0.0,  1.0};
static const int wholes[] = {INT_MAX, INT_MIN, 1000000000, -1, 0, 1, 99}, lengths[] = {INT_MIN, -1, 0, 1, 2};
enum { REALS = sizeof hostile / sizeof *hostile, WHOLES = sizeof wholes / sizeof *wholes };
enum { LENGTHS = sizeof lengths / sizeof *lengths };

static double numbers[1 << 16];
static int32_t indices[1 << 12];
static const char *where = "", *volatile field = "";
static int nulled; /* the argument that is a null pointer, or -1 */
static void reset(void) {
    nulled = -1;
    for (int k = 0; k < (1 << 10); k++) numbers[k] = 1e-3 * (k + 1), indices[k] = 0;
}
static void too_long(int signal) {
    char text[400];
    const int n = snprintf(text, sizeof text, "%s, %s: no end within the time\n", where, field);
    (void)signal;
    if (write(2, text, (size_t)n) < 0) _exit(3);
    _exit(2);
}
static void limit_time(void) { /* a minute of processor time */
    const struct itimerval minute = {{0, 0}, {60, 0}};
    setitimer(ITIMER_VIRTUAL, &minute, NULL);
}
HELPERS
CALLS
static const struct { const char *name; int (*call)(int, int); int targets; } table[] = {
ROWS
};
int main(int argc, char **argv) {
    long calls = 0;
    signal(SIGVTALRM, too_long);
    for (size_t k = 0; k < sizeof table / sizeof *table; k++) {
        if (argc > 1 && strcmp(argv[1], table[k].name) != 0) continue;
        if (argc > 2) fprintf(stderr, "%s\n", table[k].name);
        field = "as it is";
        limit_time();
        table[k].call(-1, 0), calls++;
        for (int t = 0; t < table[k].targets; t++) {
            for (int v = 0;; v++) {
                limit_time();
                if (argc > 2) fprintf(stderr, "    %d %d %s\n", t, v, field);
                if (table[k].call(t, v)) break;
                calls++;
                if (v > 20) break;
            }
        }
    }
    printf("%ld hostile calls of %d functions of HEADER\n", calls, (int)(sizeof table / sizeof *table));
    return 0;
}
"""

if __name__ == "__main__":
    print(Caller(sys.argv[1]).program())
